// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_LIGHTS_LIGHT_BLOCK_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_LIGHTS_LIGHT_BLOCK_LANES_INL_H_
#undef RAYUELA_CORE_LIGHTS_LIGHT_BLOCK_LANES_INL_H_
#else
#define RAYUELA_CORE_LIGHTS_LIGHT_BLOCK_LANES_INL_H_
#endif

#include "core/lights/light_block.h"
#include "core/math/vec_lanes-inl.h"

// The rows of a LightBlock, and of blocks that have such rows too, from element i on.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE Floats load(const LightBlock::Row& row, std::size_t i) {
    return hn::Load(FloatTag(), row + i);
}
HWY_INLINE Vec3Lanes load(const LightBlock::Rows& rows, std::size_t i) {
    return {load(rows[0], i), load(rows[1], i), load(rows[2], i)};
}
HWY_INLINE void store(Floats x, LightBlock::Row& row, std::size_t i) {
    hn::Store(x, FloatTag(), row + i);
}
HWY_INLINE void store(const Vec3Lanes& v, LightBlock::Rows& rows, std::size_t i) {
    store(v.x, rows[0], i);
    store(v.y, rows[1], i);
    store(v.z, rows[2], i);
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
