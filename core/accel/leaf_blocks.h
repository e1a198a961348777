#pragma once

#include "core/accel/triangle_runs.h"
#include "core/accel/unset_vector.h"
#include "core/shapes/mesh.h"

#include <bit>
#include <cstdint>
#include <span>

namespace rayuela {

/// Triangles of a leaf of a mesh's tree, as many as the widest kernels test at once. Most leaves are one block, in which each
/// vertex stands once; where triangles share too few vertices, a block holds runs (triangle_runs.h) instead. In floats; words
/// are stored by their bits:
///     a word: number of triangles (8 bits), number of vertices or 0 for runs (8 bits)
///     x of the vertices, y, z; then a word a triangle: the numbers of its corners (8 bits each), its extent (8 bits)
///     or: the runs
///     a word a triangle: its name
///     zeros, up to whole units
class LeafBlock {
public:
    static constexpr std::uint32_t kMaxTriangles = 16, kMaxVertices = 16;
    static constexpr std::size_t kHeader = 1;
    /// Blocks begin at multiples of this many floats, so that 32 bits address as many times more.
    static constexpr std::size_t kUnit = 4;
    static constexpr std::size_t whole_units(std::size_t floats) { return (floats + kUnit - 1) / kUnit * kUnit; }

    explicit LeafBlock(const float* data) : data_(data) {}

    std::uint32_t triangles() const { return word(0) & 0xff; }
    /// 0 for runs.
    std::uint32_t vertices() const { return word(0) >> 8; }
    const float* values() const { return data_ + kHeader; }
    const float* corners() const { return values() + 3 * vertices(); }
    const float* names() const { return data_ + first_name(); }
    /// The number in the mesh of the i-th triangle.
    std::uint32_t name(std::size_t i) const { return word(first_name() + i); }
    /// In floats.
    std::size_t size() const { return whole_units(first_name() + triangles()); }

    /// Of a triangle's word: the number of its i-th corner.
    static std::uint32_t corner(float word, std::size_t i) {
        return std::bit_cast<std::uint32_t>(word) >> (8 * i) & 0xff;
    }
    /// Of a triangle's word: its largest extent along an axis, rounded up to a power of two.
    static float extent(float word) { return std::bit_cast<float>(std::bit_cast<std::uint32_t>(word) >> 24 << 23); }
    /// What a word holds of it: the exponent.
    static std::uint32_t extent_bits(float extent) {
        return (std::bit_cast<std::uint32_t>(extent) + 0x7fffffu) >> 23 << 24;
    }

private:
    std::size_t first_name() const {
        return kHeader + (vertices() > 0 ? 3 * vertices() + triangles() : kTriangleRuns * triangles());
    }
    std::uint32_t word(std::size_t i) const { return std::bit_cast<std::uint32_t>(data_[i]); }

    const float* data_;
};

/// Where the corners of triangles stand: of a block of vertices, or in runs.
struct CornerView {
    const float* values;
    std::size_t stride;              ///< Vertices of the block, or triangles of the runs.
    const float* corners = nullptr;  ///< As LeafBlock has them; null for runs.

    static CornerView of(const LeafBlock& block) {
        if (block.vertices() == 0) return {block.values(), block.triangles()};
        return {block.values(), block.vertices(), block.corners()};
    }
    /// The same without the first triangles.
    CornerView from(std::size_t first) const {
        return corners ? CornerView{values, stride, corners + first} : CornerView{values + first, stride};
    }
    /// The x of a corner; y and z follow, each `stride` on.
    const float* corner(std::size_t triangle, std::size_t i) const {
        return values + (corners ? LeafBlock::corner(corners[triangle], i) : 3 * i * stride + triangle);
    }
    float coordinate(std::size_t triangle, std::size_t i, std::size_t axis) const {
        return corner(triangle, i)[axis * stride];
    }
};

/// Appends the blocks of a leaf with these triangles.
void append_leaf_blocks(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, UnsetVector<float>& data);

}  // namespace rayuela
