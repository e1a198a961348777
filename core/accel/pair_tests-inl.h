// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_PAIR_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_PAIR_TESTS_INL_H_
#undef RAYUELA_CORE_ACCEL_PAIR_TESTS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_PAIR_TESTS_INL_H_
#endif

#include "core/accel/triangle_pairs.h"
#include "core/accel/triangle_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Rays of one dominant axis against pairs of triangles.
///
/// The test is may_hit's, with the slack and the depths of both triangles, in other operations: signs instead of comparisons
/// and minima, which leave half of the units idle. A vertex is sheared as (x - shear z) - (origin x - shear origin z), which
/// is right within 7uR: 2u of each part, u of the shear, whose error both share, and 2u of the difference.
template <std::uint32_t kAxis>
class PairFilter {
public:
    HWY_INLINE PairFilter(const FilterRays& rays, FloatMask usable)
        : rays_(rays),
          x_(hn::NegMulAdd(rays.shear_x, rays.oz, rays.ox)),
          y_(hn::NegMulAdd(rays.shear_y, rays.oz, rays.oy)) {
        const FloatTag d;
        const Floats set = hn::BitCast(d, hn::Set(WordTag(), 0xffffffffu)), zero = hn::Zero(d);
        // The sign of a NaN says nothing: where there may be one, all pass.
        const auto numbers = hn::And(hn::Eq(rays.slack.offset - rays.slack.offset, zero),
                                     hn::And(hn::Eq(rays.z_begin, rays.z_begin), hn::Eq(rays.z_end, rays.z_end)));
        decides_ = hn::IfThenElseZero(numbers, set);
        unusable_ = hn::IfThenZeroElse(usable, set);
    }

    /// Calls found(ray mask, 0) with what may hit the first triangle, and if kTwo found(ray mask, 1).
    template <bool kTwo, typename Found>
    HWY_INLINE void test(const TrianglePair& pair, const Found& found) const {
        const FloatTag d;
        constexpr std::size_t z = kAxis;
        const Sheared begin = corner(pair.corner[0]), end = corner(pair.corner[1]);
        const Floats shared = edge(begin, end);
        const Floats slack = hn::MulAdd(rays_.slack.slope, hn::Set(d, pair.extent), rays_.slack.offset);
        const Floats apart = hn::Or((hn::Set(d, pair.hi[z]) - rays_.oz) - rays_.z_begin,
                                    rays_.z_end - (hn::Set(d, pair.lo[z]) - rays_.oz));
        const Floats below = shared + slack, above = slack - shared;
        const auto may_hit = [&](const Sheared& apex) HWY_ATTR {
            const Floats to = edge(end, apex), back = edge(apex, begin);
            const Floats outside =
                hn::OrAnd(apart, hn::Or3(below, to + slack, back + slack), hn::Or3(above, slack - to, slack - back));
            return is_positive(hn::OrAnd(unusable_, outside, decides_));
        };
        found(may_hit(corner(pair.corner[2])), 0);
        if constexpr (kTwo) found(may_hit(corner(pair.corner[3])), 1);
    }

private:
    struct Sheared {
        Floats x, y;
    };

    HWY_INLINE Sheared corner(const float (&at)[4]) const {
        const FloatTag d;
        const auto [x, y, z] = Turn(kAxis);
        const Floats depth = hn::Set(d, at[z]);
        return {hn::NegMulAdd(rays_.shear_x, depth, hn::Set(d, at[x])) - x_,
                hn::NegMulAdd(rays_.shear_y, depth, hn::Set(d, at[y])) - y_};
    }
    static HWY_INLINE Floats edge(const Sheared& from, const Sheared& to) {
        return hn::NegMulAdd(from.y, to.x, from.x * to.y);
    }
    /// Whether the sign bit is not set.
    static HWY_INLINE FloatMask is_positive(Floats x) {
        const hn::RebindToSigned<FloatTag> di;
        return hn::RebindMask(FloatTag(), hn::Gt(hn::BitCast(di, x), hn::Set(di, -1)));
    }

    FilterRays rays_;
    Floats x_, y_;               ///< The origin, sheared.
    Floats decides_, unusable_;  ///< All bits or none.
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
