#include "core/accel/leaf_blocks.h"

#include <algorithm>

namespace rayuela {
namespace {

/// Room for another block: its header, `values` floats, then its names.
float* append_block(std::uint32_t header, std::size_t values, std::span<const std::uint32_t> names,
                    UnsetVector<float>& data) {
    const std::size_t at = data.size(), end = at + LeafBlock::kHeader + values + names.size();
    data.resize(LeafBlock::whole_units(end));
    float* const out = data.data();
    out[at] = std::bit_cast<float>(header);
    std::ranges::transform(names, out + end - names.size(),
                           [](std::uint32_t name) { return std::bit_cast<float>(name); });
    std::fill(out + end, out + data.size(), 0.0f);
    return out + at + LeafBlock::kHeader;
}

/// Triangles over shared vertices.
class SharedBlock {
public:
    explicit SharedBlock(const TriangleMesh& mesh) : mesh_(mesh) {}

    /// False where there is no room for the triangle.
    bool add(std::uint32_t triangle) {
        if (triangles_ == LeafBlock::kMaxTriangles) return false;
        const std::uint32_t before = vertices_;
        std::uint32_t numbers = 0;
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t number = number_of(mesh_.triangles[triangle][i]);
            if (number == LeafBlock::kMaxVertices) {
                vertices_ = before;
                return false;
            }
            numbers |= number << 8 * i;
        }
        words_[triangles_++] = numbers;
        return true;
    }
    std::uint32_t triangles() const { return triangles_; }

    /// `names` are the triangles that were added.
    void append(std::span<const std::uint32_t> names, UnsetVector<float>& data) const {
        const std::size_t n = vertices_;
        float* const values = append_block(triangles_ | vertices_ << 8, 3 * n + triangles_, names, data);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                values[axis * n + i] = mesh_.positions[vertex_[i]][static_cast<int>(axis)];
        }
        for (std::size_t i = 0; i < triangles_; ++i)
            values[3 * n + i] = std::bit_cast<float>(words_[i] | LeafBlock::extent_bits(extent(words_[i])));
    }

private:
    /// kMaxVertices where there is no room.
    std::uint32_t number_of(std::uint32_t vertex) {
        std::uint16_t& alike = alike_[vertex * kGoldenRatio >> (32 - kHashBits)];
        for (std::uint32_t rest = alike; rest != 0; rest &= rest - 1) {
            const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
            if (vertex_[i] == vertex) return i;
        }
        if (vertices_ == LeafBlock::kMaxVertices) return vertices_;
        alike = static_cast<std::uint16_t>(alike | 1u << vertices_);
        vertex_[vertices_] = vertex;
        __builtin_prefetch(&mesh_.positions[vertex]);
        return vertices_++;
    }
    float extent(std::uint32_t word) const {
        Bounds3 bounds;
        for (int i = 0; i < 3; ++i) bounds.extend(mesh_.positions[vertex_[word >> 8 * i & 0xff]]);
        return max_component(bounds.extent());
    }

    static constexpr std::uint32_t kGoldenRatio = 0x9e3779b1, kHashBits = 5;  ///< Knuth's multiplicative hashing.

    const TriangleMesh& mesh_;
    std::array<std::uint16_t, 1 << kHashBits>
        alike_{};  ///< Of each hash the numbers of the vertices that have it, as bits.
    std::uint32_t triangles_ = 0, vertices_ = 0;
    std::array<std::uint32_t, LeafBlock::kMaxVertices> vertex_;  ///< In the mesh.
    std::array<std::uint32_t, LeafBlock::kMaxTriangles> words_;  ///< As in the block, without extents.
};

void append_runs(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, UnsetVector<float>& data) {
    const std::size_t n = triangles.size();
    float* const runs = append_block(static_cast<std::uint32_t>(n), kTriangleRuns * n, triangles, data);
    for (std::size_t i = 0; i < n; ++i) {
        const glm::uvec3& t = mesh.triangles[triangles[i]];
        write_triangle({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, i, n, runs);
    }
}

}  // namespace

void append_leaf_blocks(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, UnsetVector<float>& data) {
    // A block that is less full than this costs more tests than it saves memory.
    constexpr std::size_t kFull = 12;
    while (!triangles.empty()) {
        SharedBlock block(mesh);
        while (block.triangles() < triangles.size() && block.add(triangles[block.triangles()])) {
        }
        std::size_t n = block.triangles();
        if (n == triangles.size() || n >= kFull) {
            block.append(triangles.first(n), data);
        } else {
            n = std::min<std::size_t>(triangles.size(), LeafBlock::kMaxTriangles);
            append_runs(mesh, triangles.first(n), data);
        }
        triangles = triangles.subspan(n);
    }
}

}  // namespace rayuela
