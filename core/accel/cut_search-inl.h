// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_CUT_SEARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_CUT_SEARCH_INL_H_
#undef RAYUELA_CORE_ACCEL_CUT_SEARCH_INL_H_
#else
#define RAYUELA_CORE_ACCEL_CUT_SEARCH_INL_H_
#endif

#include "core/math/bounds.h"

#include <cmath>
#include <cstddef>

#include "core/accel/lane_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

constexpr double kEmptyBonus = 0.8;

/// The cheapest of the planes offered to it; of several the one with the least number.
class CutSearch {
public:
    /// What the cell is across the axis of each lane.
    struct Across {
        Doubles lo, hi, extent;
        Doubles per_depth, at_none;  ///< Half the surface area of a part of the cell by its depth.
    };

    /// `weight`: references that each of those stands for which are counted.
    CutSearch(const Bounds3& cell, double weight, float step_cost)
        : cell_(cell), extent_(Vec3d(cell.hi) - Vec3d(cell.lo)), step_cost_(step_cost) {
        const Vec3d& e = extent_;
        has_area_ = e.x * e.y + e.y * e.z + e.z * e.x > 0;
        per_whole_ = weight / slope_of(0).of(e.x);
    }

    /// The same axis in all lanes.
    HWY_INLINE Across across(int axis) const {
        const DoubleTag dd;
        const Slope slope = slope_of(axis);
        return {hn::Set(dd, cell_.lo[axis]), hn::Set(dd, cell_.hi[axis]), hn::Set(dd, extent_[axis]),
                hn::Set(dd, slope.per_depth), hn::Set(dd, slope.at_none)};
    }
    /// x, y, z, none and so on from the axis `first`; where there is none no cut is.
    HWY_INLINE Across across_in_turn(std::size_t first) const {
        alignas(64) double rows[5][8] = {};
        for (int axis = 0; axis < 3; ++axis) {
            const Slope slope = slope_of(axis);
            const double of_axis[5] = {cell_.lo[axis], cell_.hi[axis], extent_[axis], slope.per_depth, slope.at_none};
            for (std::size_t i = 0; i < 5; ++i) rows[i][axis] = rows[i][axis + 4] = of_axis[i];
        }
        const auto row = [&](std::size_t i) HWY_ATTR { return hn::Load(DoubleTag(), rows[i] + first); };
        return {row(0), row(1), row(2), row(3), row(4)};
    }

    HWY_INLINE void consider(const Across& cell, const float* planes, const std::int32_t* counts_below,
                             const std::int32_t* counts_above, Doubles number) {
        const DoubleTag dd;
        const hn::Rebind<float, DoubleTag> df;
        const hn::Rebind<std::int32_t, DoubleTag> di;
        const Doubles plane = hn::PromoteTo(dd, hn::Load(df, planes)), depth = plane - cell.lo, zero = hn::Zero(dd);
        const Doubles below = hn::PromoteTo(dd, hn::Load(di, counts_below)),
                      above = hn::PromoteTo(dd, hn::Load(di, counts_above));
        const Doubles tests = (cell.per_depth * depth + cell.at_none) * below +
                              (cell.per_depth * (cell.extent - depth) + cell.at_none) * above;
        const auto cuts_off_space = hn::Or(hn::Eq(below, zero), hn::Eq(above, zero));
        const Doubles bonus = hn::IfThenElse(cuts_off_space, hn::Set(dd, kEmptyBonus), hn::Set(dd, 1));
        const Doubles cost = bonus * (hn::Set(dd, step_cost_) + tests * hn::Set(dd, per_whole_));
        // What lies on a side of the cell is no cut.
        const auto inside = hn::And(hn::Gt(plane, cell.lo), hn::Lt(plane, cell.hi));
        const auto better = hn::And(inside, hn::Lt(cost, best_cost_));
        best_cost_ = hn::IfThenElse(better, cost, best_cost_);
        best_number_ = hn::IfThenElse(better, number, best_number_);
    }

    struct Best {
        double cost;  ///< Infinite where there is none.
        std::size_t number;
    };
    HWY_INLINE Best best() const {
        const DoubleTag dd;
        const Doubles cost = hn::MinOfLanes(dd, best_cost_);
        const Doubles numbers = hn::IfThenElse(hn::Eq(best_cost_, cost), best_number_, hn::Set(dd, INFINITY));
        return {hn::GetLane(cost), static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(dd, numbers)))};
    }

private:
    /// Half the surface area of a part of the cell, or its length where the cell has no area, by its depth along an axis.
    struct Slope {
        double per_depth = 0, at_none = 0;
        double of(double depth) const { return per_depth * depth + at_none; }
    };
    Slope slope_of(int axis) const {
        const double u = extent_[(axis + 1) % 3], v = extent_[(axis + 2) % 3];
        return has_area_ ? Slope{u + v, u * v} : Slope{1, u + v};
    }

    Bounds3 cell_;
    Vec3d extent_;
    bool has_area_;
    double step_cost_, per_whole_;
    /// In each lane, of the planes that came there.
    Doubles best_cost_ = hn::Set(DoubleTag(), INFINITY), best_number_ = hn::Zero(DoubleTag());
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
