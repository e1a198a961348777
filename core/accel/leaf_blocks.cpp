#include "core/accel/leaf_blocks.h"

#include <algorithm>

namespace rayuela {
namespace {

using Corners = std::array<Vec3, 3>;

Corners corners_of(const TriangleMesh& mesh, std::uint32_t triangle) {
    const glm::uvec3& t = mesh.triangles[triangle];
    return {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
}

/// Triangles over shared vertices.
class SharedBlock {
public:
    /// False where there is no room for the triangle.
    bool add(const Corners& corners) {
        if (triangles_ == LeafBlock::kMaxTriangles) return false;
        const std::uint32_t before = vertices_;
        std::uint32_t numbers = 0;
        Bounds3 bounds;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const std::uint32_t number = number_of(corners[i]);
            if (number == LeafBlock::kMaxVertices) {
                vertices_ = before;
                return false;
            }
            numbers |= number << 8 * i;
            bounds.extend(corners[i]);
        }
        words_[triangles_++] = numbers | LeafBlock::extent_bits(max_component(bounds.extent()));
        return true;
    }
    std::uint32_t triangles() const { return triangles_; }

    void append(std::uint32_t first_name, std::vector<float>& data) const {
        data.push_back(std::bit_cast<float>(triangles_ | vertices_ << 8));
        data.push_back(std::bit_cast<float>(first_name));
        for (const auto& axis : position_) {
            for (std::uint32_t i = 0; i < vertices_; ++i) data.push_back(std::bit_cast<float>(axis[i]));
        }
        for (std::uint32_t i = 0; i < triangles_; ++i) data.push_back(std::bit_cast<float>(words_[i]));
    }

private:
    /// By their bits: 0 and -0 are two. kMaxVertices where there is no room.
    std::uint32_t number_of(const Vec3& vertex) {
        const auto bits = std::bit_cast<std::array<std::uint32_t, 3>>(vertex);
        for (std::uint32_t i = 0; i < vertices_; ++i) {
            if (position_[0][i] == bits[0] && position_[1][i] == bits[1] && position_[2][i] == bits[2]) return i;
        }
        if (vertices_ == LeafBlock::kMaxVertices) return vertices_;
        for (std::size_t axis = 0; axis < 3; ++axis) position_[axis][vertices_] = bits[axis];
        return vertices_++;
    }

    std::uint32_t triangles_ = 0, vertices_ = 0;
    std::array<std::array<std::uint32_t, LeafBlock::kMaxVertices>, 3> position_;
    std::array<std::uint32_t, LeafBlock::kMaxTriangles> words_;
};

void append_runs(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, std::uint32_t first_name,
                 std::vector<float>& data) {
    const std::size_t n = triangles.size(), at = data.size() + LeafBlock::kHeader;
    data.resize(at + kTriangleRuns * n);
    data[at - 2] = std::bit_cast<float>(static_cast<std::uint32_t>(n));
    data[at - 1] = std::bit_cast<float>(first_name);
    for (std::size_t i = 0; i < n; ++i) write_triangle(corners_of(mesh, triangles[i]), i, n, data.data() + at);
}

}  // namespace

void append_leaf_blocks(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, std::uint32_t first_name,
                        std::vector<float>& data) {
    // A block that is less full than this costs more tests than it saves memory.
    constexpr std::size_t kFull = 12;
    while (!triangles.empty()) {
        SharedBlock block;
        while (block.triangles() < triangles.size() && block.add(corners_of(mesh, triangles[block.triangles()]))) {
        }
        std::size_t n = block.triangles();
        if (n == triangles.size() || n >= kFull) {
            block.append(first_name, data);
        } else {
            n = std::min<std::size_t>(triangles.size(), LeafBlock::kMaxTriangles);
            append_runs(mesh, triangles.first(n), first_name, data);
        }
        triangles = triangles.subspan(n);
        first_name += static_cast<std::uint32_t>(n);
    }
}

}  // namespace rayuela
