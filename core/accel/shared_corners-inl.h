// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_SHARED_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_SHARED_CORNERS_INL_H_
#undef RAYUELA_CORE_ACCEL_SHARED_CORNERS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_SHARED_CORNERS_INL_H_
#endif

#include "core/accel/leaf_blocks.h"

#include "core/accel/triangle_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// A value for each vertex of a block, in one part or two.
template <std::size_t kParts>
struct VertexTable {
    Floats part[kParts];

    /// Those with these numbers.
    HWY_INLINE Floats at(Words number) const {
        const FloatTag d;
        const WordTag dw;
        const auto index = hn::IndicesFromVec(d, hn::And(number, hn::Set(dw, kLanes - 1)));
        const Floats first = hn::TableLookupLanes(part[0], index);
        if constexpr (kParts == 1) return first;
        const auto in_second = hn::RebindMask(d, hn::TestBit(number, hn::Set(dw, kLanes)));
        return hn::IfThenElse(in_second, hn::TableLookupLanes(part[kParts - 1], index), first);
    }
};

/// Triangles as rays see them that go along z from the origin.
struct ShearedTriangles {
    ShearedVertices a, b, c;
    Floats extent;
};

/// Triangles i to i + kLanes of a block of vertices. What lies past the last is arbitrary.
HWY_INLINE ShearedTriangles shear_corners(const FilterRays& ray, const Turn& turn, const LeafBlock& block,
                                          std::size_t i) {
    const FloatTag d;
    const WordTag dw;
    const std::size_t n = block.vertices();
    const float *const x = block.values() + turn.x * n, *const y = block.values() + turn.y * n,
                       *const z = block.values() + turn.z * n;
    const Words words = hn::BitCast(dw, hn::LoadU(d, block.corners() + i));
    const auto number = [&](Words shifted)
                            HWY_ATTR { return hn::And(shifted, hn::Set(dw, LeafBlock::kMaxVertices - 1)); };
    const Words a = number(words), b = number(hn::ShiftRight<8>(words)), c = number(hn::ShiftRight<16>(words));
    const Floats extent = hn::BitCast(d, hn::ShiftLeft<23>(hn::ShiftRight<24>(words)));
    constexpr std::size_t kParts = LeafBlock::kMaxVertices / kLanes;
    if constexpr (kParts <= 2) {
        VertexTable<kParts> xs, ys, zs;
        for (std::size_t k = 0; k < kParts; ++k) {
            // What follows the vertices are no floats, and could be slow ones.
            const std::size_t first = k * kLanes;
            const FloatMask there = hn::FirstN(d, std::max(n, first) - first);
            const ShearedVertices sheared =
                shear(ray, hn::LoadU(d, x + first), hn::LoadU(d, y + first), hn::MaskedLoad(there, d, z + first));
            xs.part[k] = sheared.x;
            ys.part[k] = sheared.y;
            zs.part[k] = sheared.z;
        }
        const auto vertex = [&](Words k) HWY_ATTR { return ShearedVertices{xs.at(k), ys.at(k), zs.at(k)}; };
        return {vertex(a), vertex(b), vertex(c), extent};
    } else {
        const auto vertex = [&](Words k) HWY_ATTR {
            const auto at = hn::BitCast(hn::RebindToSigned<WordTag>(), k);
            return shear(ray, hn::GatherIndex(d, x, at), hn::GatherIndex(d, y, at), hn::GatherIndex(d, z, at));
        };
        return {vertex(a), vertex(b), vertex(c), extent};
    }
}

/// The same for a block of runs.
HWY_INLINE ShearedTriangles shear_runs(const FilterRays& ray, const Turn& turn, const LeafBlock& block, std::size_t i) {
    const std::size_t n = block.triangles();
    const auto load = [&](std::size_t run) HWY_ATTR { return hn::LoadU(FloatTag(), block.values() + i + run * n); };
    const auto vertex = [&](std::size_t k) HWY_ATTR {
        return shear(ray, load(3 * k + turn.x), load(3 * k + turn.y), load(3 * k + turn.z));
    };
    return {vertex(0), vertex(1), vertex(2), load(9)};
}

/// Triangles i to i + kLanes of a block of vertices, along one ray or many. What lies past the last is arbitrary.
HWY_INLINE FloatMask may_hit(const FilterRays& ray, const Turn& turn, const LeafBlock& block, std::size_t i) {
    const ShearedTriangles triangles = shear_corners(ray, turn, block, i);
    return may_hit(ray, triangles.a, triangles.b, triangles.c, triangles.extent);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
