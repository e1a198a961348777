// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_CUT_BINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_CUT_BINS_INL_H_
#undef RAYUELA_CORE_ACCEL_CUT_BINS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_CUT_BINS_INL_H_
#endif

#include "core/accel/kd_reference.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "core/accel/lane_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

constexpr int kBins = 32;

/// Coordinates of a box: lo.x lo.y lo.z hi.x hi.y hi.z, and two words more of the reference in whole vectors.
using BoxTag = hn::CappedTag<float, 8>;
using Boxes = hn::Vec<BoxTag>;
constexpr std::size_t kSides = 6, kBoxLanes = hn::MaxLanes(BoxTag());
using BoxRow = float[8];
static_assert(sizeof(KdReference) == sizeof(BoxRow));

/// A vector of bytes, as many of which as are needed hold a count for each bin.
using ByteTag = hn::CappedTag<std::uint8_t, kBins>;
constexpr std::size_t kBytes = hn::MaxLanes(ByteTag());

/// kSteps + kBins - b: for each bin whether it is b or lies beyond.
alignas(64) constexpr auto kSteps = [] {
    std::array<std::uint8_t, 2 * kBins> steps{};
    for (std::size_t i = kBins; i < steps.size(); ++i) steps[i] = 1;
    return steps;
}();

/// How many boxes begin, and how many end, in each bin along each axis or in one before.
class Bins {
public:
    Bins(const Bounds3& held, const Vec3& per_unit) {
        // Words that are no sides look like denormal numbers, which are slow to multiply.
        origin_[kSides] = origin_[kSides + 1] = 1;
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = origin_[3 + axis] = held.lo[axis];
            scale_[axis] = scale_[3 + axis] = per_unit[axis];
            at_end_[3 + axis] = 1;
        }
    }

    /// Of every stride-th reference.
    HWY_INLINE void count(std::span<const KdReference> references, std::size_t stride) {
        constexpr std::size_t kFitByte = 255;
        for (std::size_t k = 0; k < references.size(); k += kFitByte * stride) {
            const auto few = references.subspan(k, std::min(kFitByte * stride, references.size() - k));
            count_few(few, stride, k == 0);
        }
    }

    std::int32_t begun(std::size_t axis, std::size_t bin) const { return counts_[axis][bin]; }
    std::int32_t ended(std::size_t axis, std::size_t bin) const { return counts_[3 + axis][bin]; }

private:
    HWY_INLINE void count_few(std::span<const KdReference> references, std::size_t stride, bool first) {
        const ByteTag db;
        hn::Vec<ByteTag> counts[kSides][kBins / kBytes];
        for (auto& side : counts) {
            for (auto& part : side) part = hn::Zero(db);
        }
        const auto add = [&](std::size_t side, std::uint32_t bins_left) HWY_ATTR {
            const std::uint8_t* const step = kSteps.data() + bins_left;
            for (std::size_t i = 0; i < kBins / kBytes; ++i)
                counts[side][i] = hn::Add(counts[side][i], hn::LoadU(db, step + i * kBytes));
        };
        for (std::size_t k = 0; k < references.size(); k += stride) {
            alignas(32) std::uint32_t left[8];
            for (std::size_t i = 0; i < kSides; i += kBoxLanes) bins_left(&references[k].box.lo.x, i, left);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::uint32_t end = left[3 + axis] & kLeftMask;
                add(axis, std::max(left[axis] & kLeftMask, end));
                add(3 + axis, end);
            }
        }
        for (std::size_t side = 0; side < kSides; ++side) {
            alignas(32) std::uint8_t bytes[kBins];
            for (std::size_t i = 0; i < kBins / kBytes; ++i) hn::Store(counts[side][i], db, bytes + i * kBytes);
            auto& sum = counts_[side];
            for (std::size_t bin = 0; bin < kBins; ++bin) sum[bin] = first ? bytes[bin] : sum[bin] + bytes[bin];
        }
    }

    /// kBins less the bin of each side, in the last bits.
    HWY_INLINE void bins_left(const float* box, std::size_t i, std::uint32_t* left) const {
        const BoxTag d;
        const Boxes bins = hn::Mul(hn::Sub(hn::LoadU(d, box + i), hn::Load(d, origin_ + i)), hn::Load(d, scale_ + i));
        const Boxes at = hn::Min(bins, hn::Set(d, float{kBins})), whole = hn::Floor(at);
        // A box that ends at a plane is not above it: its end is in the bin before.
        const Boxes back = hn::IfThenElseZero(hn::Eq(whole, at), hn::Load(d, at_end_ + i));
        const Boxes bin = hn::Max(hn::Sub(whole, back), hn::Zero(d));
        hn::Store(hn::BitCast(hn::RebindToUnsigned<BoxTag>(), hn::Sub(hn::Set(d, kWhole + kBins), bin)),
                  hn::RebindToUnsigned<BoxTag>(), left + i);
    }

    /// A whole number that is added to this one stands in the last bits of the sum.
    static constexpr float kWhole = 0x1p23f;
    static constexpr std::uint32_t kLeftMask = 0xff;

    alignas(64) std::array<std::array<std::int32_t, kBins>, kSides> counts_;  ///< Beginnings of three axes, then ends.
    alignas(32) BoxRow origin_{}, scale_{}, at_end_{};
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
