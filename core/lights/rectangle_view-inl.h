// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_LIGHTS_RECTANGLE_VIEW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_LIGHTS_RECTANGLE_VIEW_INL_H_
#undef RAYUELA_CORE_LIGHTS_RECTANGLE_VIEW_INL_H_
#else
#define RAYUELA_CORE_LIGHTS_RECTANGLE_VIEW_INL_H_
#endif

#include "core/lights/rectangle_view.h"
#include "core/math/vec_lanes-inl.h"

// What rectangle_view.h does, one rectangle and eye a lane, to the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE Floats angle_of(Floats x, Floats y) {
    const Floats across = hn::Abs(x), low = hn::Min(across, y), high = hn::Max(across, y);
    const FloatMask beyond = hn::Gt(low, all_lanes(kTanPi8) * high);
    const Floats t = hn::IfThenElse(beyond, low - high, low) / hn::IfThenElse(beyond, low + high, high), z = t * t;
    const Floats tail =
        ((all_lanes(kAtan[0]) * z + all_lanes(kAtan[1])) * z + all_lanes(kAtan[2])) * z + all_lanes(kAtan[3]);
    const Floats octant = hn::IfThenElseZero(beyond, all_lanes(kPi / 4)) + (t + t * z * tail);
    const Floats quadrant = hn::IfThenElse(hn::Lt(across, y), all_lanes(kPi / 2) - octant, octant);
    return hn::IfThenElse(hn::Lt(x, hn::Zero(FloatTag())), all_lanes(kPi) - quadrant, quadrant);
}

struct RectangleFrameLanes {
    Vec3Lanes x, y, z;
    Floats width, height;
};

struct RectangleViewLanes {
    Floats x0, x1, y0, y1, z;

    HWY_INLINE RectangleViewLanes(const RectangleFrameLanes& frame, const Vec3Lanes& corner)
        : x0(dot(corner, frame.x)),
          x1(x0 + frame.width),
          y0(dot(corner, frame.y)),
          y1(y0 + frame.height),
          z(hn::Abs(dot(corner, frame.z))) {}

    HWY_INLINE Floats solid_angle() const {
        const Floats r00 = distance(x0, y0), r10 = distance(x1, y0), r01 = distance(x0, y1), r11 = distance(x1, y1);
        const Floats zz = z * z, volume = z * ((x1 - x0) * (y1 - y0));
        const Floats xx = x0 * x1 + zz, yy = y0 * y1 + zz, across = xx + y0 * y1;
        const Floats lower = r00 * r10 * r11 + (xx + y0 * y0) * r11 + (yy + x1 * x1) * r00 + across * r10;
        const Floats upper = r00 * r01 * r11 + (xx + y1 * y1) * r00 + (yy + x0 * x0) * r11 + across * r01;
        const Floats a = lower / volume, b = upper / volume;
        return all_lanes(2.0f) * angle_of(a * b - all_lanes(1.0f), a + b);
    }

    HWY_INLINE Vec2Lanes sample(const Vec2Lanes& u, Floats angle) const {
        const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f);
        const Floats zz = z * z, r00 = distance(x0, y0), r01 = distance(x0, y1);
        const Floats rho0 = hn::Sqrt(y0 * y0 + zz), rho1 = hn::Sqrt(y1 * y1 + zz);
        const Floats b0 = y0 / rho0, b1 = y1 / rho1, scale = one / ((x0 * x0 + zz) * (rho0 * rho1));
        const Floats cos_k = (x0 * x0 * (y0 * y1) + zz * (r00 * r01)) * scale;
        const Floats sin_k = x0 * z * (r00 * y1 - r01 * y0) * scale;
        const Vec2Lanes w = cos_sin_turns(u.x * angle * all_lanes(0.5f * kInvPi));
        const Floats cosine = w.x * cos_k - w.y * sin_k, sine = w.y * cos_k + w.x * sin_k;
        const Floats g = b1 - cosine * b0, below = sine * z / rho0;
        const Floats x = clamp(z * sine / hn::Sqrt(hn::Max(zero, g * g - below * below)), x0, x1);
        const Floats dd = x * x + zz, h0 = y0 / hn::Sqrt(dd + y0 * y0), h1 = y1 / hn::Sqrt(dd + y1 * y1);
        const Floats h = h0 + u.y * (h1 - h0);
        const Floats y = clamp(h * hn::Sqrt(dd / (one - h * h)), y0, y1);
        return {hn::Min((x - x0) / (x1 - x0), one), hn::Min((y - y0) / (y1 - y0), one)};
    }

    HWY_INLINE void closeness(Floats (&result)[4]) const {
        const Floats r00 = distance(x0, y0), r10 = distance(x1, y0), r01 = distance(x0, y1), r11 = distance(x1, y1);
        const Floats low = r00 * r10, high = r01 * r11;
        result[0] = r10 * high;
        result[1] = r00 * high;
        result[2] = low * r11;
        result[3] = low * r01;
    }

private:
    HWY_INLINE Floats distance(Floats x, Floats y) const { return hn::Sqrt(x * x + y * y + z * z); }
    static HWY_INLINE Floats clamp(Floats x, Floats low, Floats high) { return hn::Min(hn::Max(x, low), high); }
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
