// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_LIGHTS_TRIANGLE_VIEW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_LIGHTS_TRIANGLE_VIEW_INL_H_
#undef RAYUELA_CORE_LIGHTS_TRIANGLE_VIEW_INL_H_
#else
#define RAYUELA_CORE_LIGHTS_TRIANGLE_VIEW_INL_H_
#endif

#include "core/lights/rectangle_view-inl.h"
#include "core/lights/triangle_view.h"

// What triangle_view.h does, one triangle and eye a lane, to the same bits.

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

class TriangleViewLanes {
public:
    HWY_INLINE TriangleViewLanes(const Vec3Lanes (&corners)[3], Floats area, Floats height) {
        const Floats one = all_lanes(1.0f);
        for (std::size_t i = 0; i < 3; ++i) closeness_[i] = one / hn::Sqrt(dot(corners[i], corners[i]));
        const Vec3Lanes a = corners[0] * closeness_[0], b = corners[1] * closeness_[1], c = corners[2] * closeness_[2];
        ab_ = dot(a, b);
        ac_ = dot(a, c);
        bc_ = dot(b, c);
        volume_ = all_lanes(2.0f) * area * closeness_[1] * closeness_[2] * (height * closeness_[0]);
    }

    HWY_INLINE Floats solid_angle() const {
        return all_lanes(2.0f) * angle_of((all_lanes(1.0f) + ab_) + (ac_ + bc_), volume_);
    }

    HWY_INLINE Vec2Lanes sample(const Vec2Lanes& u, Floats angle) const {
        const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f), two = all_lanes(2.0f);
        const Vec2Lanes w = cos_sin_turns(u.x * angle * all_lanes(0.25f * kInvPi));
        const Floats to_b = volume_ * w.x - (ac_ + bc_) * w.y, to_c = (one + ab_) * w.y;
        const Floats difference = hn::Max(to_b - to_c, zero);
        const Floats scale = one / (difference * difference + two * to_b * to_c * (one + bc_));
        const Floats b = difference * (to_b + to_c) * scale, c = two * to_c * (to_b + to_c * bc_) * scale;
        const Floats ad = b * ab_ + c * ac_, cosine = one - u.y * (one - ad);
        const Floats d = hn::Sqrt(u.y * (one + cosine) / (one + ad)), a = hn::Max(cosine - d * ad, zero);
        const Floats along_b = d * b * closeness_[1], along_c = d * c * closeness_[2];
        const Floats all = one / (a * closeness_[0] + (along_b + along_c));
        return {hn::Min(along_b * all, one), hn::Min(along_c * all, one)};
    }

    HWY_INLINE void closeness(Floats (&result)[4]) const {
        result[0] = result[1] = closeness_[0];
        result[2] = closeness_[1];
        result[3] = closeness_[2];
    }

private:
    Floats closeness_[3], ab_, ac_, bc_, volume_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
