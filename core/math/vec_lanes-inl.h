// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATH_VEC_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATH_VEC_LANES_INL_H_
#undef RAYUELA_CORE_MATH_VEC_LANES_INL_H_
#else
#define RAYUELA_CORE_MATH_VEC_LANES_INL_H_
#endif

#include "core/math/lanes-inl.h"
#include "core/math/sampling.h"
#include "core/math/vec.h"

// What math/vec.h, basis.h, float_error.h and sampling.h do, one point, direction or basis a lane: the same operations in
// the same order, and so the same bits on every set of instructions.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE Floats all_lanes(float x) {
    return hn::Set(FloatTag(), x);
}

struct Vec3Lanes {
    Floats x, y, z;
};

HWY_INLINE Vec3Lanes operator+(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Vec3Lanes operator-(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Vec3Lanes operator*(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
HWY_INLINE Vec3Lanes operator*(const Vec3Lanes& a, Floats s) {
    return {a.x * s, a.y * s, a.z * s};
}
HWY_INLINE Vec3Lanes operator/(const Vec3Lanes& a, Floats s) {
    return {a.x / s, a.y / s, a.z / s};
}
HWY_INLINE Vec3Lanes operator-(const Vec3Lanes& a) {
    return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}

HWY_INLINE Vec3Lanes all_lanes(const Vec3& v) {
    return {all_lanes(v.x), all_lanes(v.y), all_lanes(v.z)};
}
HWY_INLINE Vec3Lanes select(FloatMask mask, const Vec3Lanes& yes, const Vec3Lanes& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE Vec3Lanes abs(const Vec3Lanes& v) {
    return {hn::Abs(v.x), hn::Abs(v.y), hn::Abs(v.z)};
}
HWY_INLINE Floats dot(const Vec3Lanes& a, const Vec3Lanes& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Vec3Lanes normalize(const Vec3Lanes& v) {
    return v * (all_lanes(1.0f) / hn::Sqrt(dot(v, v)));
}
HWY_INLINE FloatMask is_black(const Vec3Lanes& c) {
    const Floats zero = hn::Zero(FloatTag());
    return hn::And(hn::And(hn::Eq(c.x, zero), hn::Eq(c.y, zero)), hn::Eq(c.z, zero));
}
HWY_INLINE Floats max_component(const Vec3Lanes& v) {
    return hn::Max(v.x, hn::Max(v.y, v.z));
}

struct BasisLanes {
    Vec3Lanes s, t, n;

    explicit HWY_INLINE BasisLanes(const Vec3Lanes& normal) : n(normal) {
        const Floats one = all_lanes(1.0f), sign = hn::CopySign(one, n.z);
        const Floats a = hn::Neg(one) / (sign + n.z);
        const Floats b = n.x * n.y * a;
        s = {one + sign * n.x * n.x * a, sign * b, hn::Neg(sign) * n.x};
        t = {b, sign + n.y * n.y * a, hn::Neg(n.y)};
    }

    HWY_INLINE Vec3Lanes to_local(const Vec3Lanes& w) const { return {dot(w, s), dot(w, t), dot(w, n)}; }
    HWY_INLINE Vec3Lanes to_world(const Vec3Lanes& l) const { return s * l.x + t * l.y + n * l.z; }
};

/// x + offset, rounded away from x: next_up or next_down where the offset is not 0.
HWY_INLINE Floats moved_away(Floats x, Floats offset) {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    const Floats zero = hn::Zero(d);
    // next_down(x) is -next_up(-x): the sign of the offset is taken off and put back.
    const Floats side = hn::CopySign(hn::Zero(d), offset), outward = hn::Xor(x + offset, side);
    const auto bits = hn::BitCast(di, outward + zero);
    const auto up =
        hn::IfThenElse(hn::Lt(bits, hn::Zero(di)), hn::Sub(bits, hn::Set(di, 1)), hn::Add(bits, hn::Set(di, 1)));
    return hn::IfThenElse(hn::Eq(offset, zero), x + offset, hn::Xor(hn::BitCast(d, up), side));
}

HWY_INLINE Vec3Lanes offset_ray_origin(const Vec3Lanes& p, const Vec3Lanes& error, const Vec3Lanes& n,
                                       const Vec3Lanes& w) {
    const Floats distance = dot(abs(n), error);
    const FloatMask back = hn::Lt(dot(w, n), hn::Zero(FloatTag()));
    const Vec3Lanes offset = n * hn::IfThenElse(back, hn::Neg(distance), distance);
    return {moved_away(p.x, offset.x), moved_away(p.y, offset.y), moved_away(p.z, offset.z)};
}

struct Vec2Lanes {
    Floats x, y;
};

HWY_INLINE Vec2Lanes cos_sin_octant(Floats x) {
    const Floats z = x * x;
    const Floats s = (all_lanes(kSinOctant[0]) * z + all_lanes(kSinOctant[1])) * z + all_lanes(kSinOctant[2]);
    const Floats c = (all_lanes(kCosOctant[0]) * z + all_lanes(kCosOctant[1])) * z + all_lanes(kCosOctant[2]);
    return {all_lanes(1.0f) - all_lanes(0.5f) * z + z * z * c, x + x * z * s};
}

HWY_INLINE Vec2Lanes sample_concentric_disk(const Vec2Lanes& u) {
    const Floats two = all_lanes(2.0f), one = all_lanes(1.0f), zero = hn::Zero(FloatTag());
    const Floats x = two * u.x - one, y = two * u.y - one;
    const FloatMask horizontal = hn::Gt(hn::Abs(x), hn::Abs(y));
    const Floats r = hn::IfThenElse(horizontal, x, y), across = hn::IfThenElse(horizontal, y, x);
    const Floats ratio = hn::IfThenElse(hn::Eq(r, zero), zero, all_lanes(kPi / 4) * (across / r));
    const Vec2Lanes w = cos_sin_octant(ratio);
    const Floats along = r * w.x, beside = r * w.y;
    return {hn::IfThenElse(horizontal, along, beside), hn::IfThenElse(horizontal, beside, along)};
}

HWY_INLINE Vec3Lanes sample_cosine_hemisphere(const Vec2Lanes& u) {
    const Vec2Lanes d = sample_concentric_disk(u);
    const Floats z2 = all_lanes(1.0f) - d.x * d.x - d.y * d.y;
    return {d.x, d.y, hn::Sqrt(hn::Max(all_lanes(kLowestHemisphereZ2), z2))};
}

HWY_INLINE Vec2Lanes cos_sin_turns(Floats turns) {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    const Floats quarter = hn::Floor(all_lanes(4.0f) * turns + all_lanes(0.5f));
    const Vec2Lanes w = cos_sin_octant(all_lanes(2 * kPi) * (turns - all_lanes(0.25f) * quarter));
    const auto quarters = hn::ConvertTo(di, quarter);
    const auto bit = [&](int value) HWY_ATTR { return hn::RebindMask(d, hn::TestBit(quarters, hn::Set(di, value))); };
    const FloatMask odd = bit(1), beyond_half = bit(2);
    const Vec2Lanes across{hn::IfThenElse(odd, hn::Neg(w.y), w.x), hn::IfThenElse(odd, w.x, w.y)};
    return {hn::IfThenElse(beyond_half, hn::Neg(across.x), across.x),
            hn::IfThenElse(beyond_half, hn::Neg(across.y), across.y)};
}

HWY_INLINE Vec3Lanes disk_to_cap(const Vec2Lanes& disk, Floats one_minus_cos) {
    const Floats zero = hn::Zero(FloatTag()), two = all_lanes(2.0f);
    const Floats x = (disk.x * disk.x + disk.y * disk.y) * one_minus_cos;
    const Floats scale = hn::Sqrt(one_minus_cos * hn::Max(zero, two - x));
    return {disk.x * scale, disk.y * scale, all_lanes(1.0f) - x};
}

HWY_INLINE Vec3Lanes sample_uniform_cone(const Vec2Lanes& u, Floats one_minus_cos) {
    return disk_to_cap(sample_concentric_disk(u), one_minus_cos);
}

HWY_INLINE Vec2Lanes sample_uniform_triangle(const Vec2Lanes& u) {
    const FloatMask below = hn::Lt(u.x, u.y);
    const Floats x = u.x * all_lanes(0.5f), y = u.y * all_lanes(0.5f);
    return {hn::IfThenElse(below, x, u.x - y), hn::IfThenElse(below, u.y - x, y)};
}

HWY_INLINE Floats sample_linear(Floats u, Floats a, Floats b) {
    return hn::Min(u * (a + b) / (a + hn::Sqrt(a * a + u * (b * b - a * a))), all_lanes(1.0f));
}

HWY_INLINE Floats power_heuristic(Floats a, Floats b) {
    const Floats ratio = b / a, one = all_lanes(1.0f);
    return hn::IfThenZeroElse(hn::Eq(a, hn::Zero(FloatTag())), one / (one + ratio * ratio));
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
