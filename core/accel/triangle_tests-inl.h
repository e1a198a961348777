// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_ACCEL_TRIANGLE_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_ACCEL_TRIANGLE_TESTS_INL_H_
#undef RAYUELA_CORE_ACCEL_TRIANGLE_TESTS_INL_H_
#else
#define RAYUELA_CORE_ACCEL_TRIANGLE_TESTS_INL_H_
#endif

#include "core/accel/triangle_runs.h"
#include "core/shapes/intersect_triangle.h"

#include "core/accel/kd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// By how much edge functions may be off for triangles of extent E: slope * E + offset. See may_hit.
struct FilterSlack {
    Floats slope, offset;

    /// `pad` is RayBlock's. Infinite, so that all triangles pass, where the edge functions could overflow.
    HWY_INLINE static FilterSlack of(Floats pad) {
        const FloatTag d;
        constexpr float kLargestReach = 0x1p60f;
        const auto common = hn::Lt(pad, hn::Set(d, 10 * kUnitRoundoff * kLargestReach));
        const Floats bounded = hn::IfThenElse(common, pad, hn::Set(d, kInfinity)), slope = hn::Set(d, 16) * bounded;
        return {slope, slope * hn::Set(d, 1.6f) * bounded};
    }
};

/// Rays, or one ray in all lanes, in the turn of the axes that RayBlock describes.
struct FilterRays {
    Floats ox, oy, oz, shear_x, shear_y;
    FilterSlack slack;
    Floats z_begin, z_end;  ///< The depths, from the origin along z, between which a hit counts.
};

/// Triangles, or one triangle in all lanes, in the same turn.
struct FilterTriangles {
    Floats ax, ay, az, bx, by, bz, cx, cy, cz;
    Floats extent;  ///< The largest along an axis.
};

/// The turn of the axes, as TriangleRay has it, that makes the dominant axis z.
struct Turn {
    std::uint32_t x, y, z;

    explicit Turn(std::uint32_t dominant_axis)
        : x(dominant_axis == 2 ? 0 : dominant_axis + 1), y(x == 2 ? 0 : x + 1), z(dominant_axis) {}
};

/// Triangles of runs in a turn of the axes.
struct TurnedRuns {
    const float* run[kTriangleRuns];

    HWY_INLINE TurnedRuns(const float* runs, std::size_t n, const Turn& turn) {
        const std::uint32_t axes[3] = {turn.x, turn.y, turn.z};
        for (std::size_t i = 0; i < 9; ++i) run[i] = runs + (i / 3 * 3 + axes[i % 3]) * n;
        run[9] = runs + 9 * n;
    }
    /// Triangle i in all lanes.
    HWY_INLINE FilterTriangles triangle(std::size_t i) const {
        const auto set = [&](std::size_t k) HWY_ATTR { return hn::Set(FloatTag(), run[k][i]); };
        return {set(0), set(1), set(2), set(3), set(4), set(5), set(6), set(7), set(8), set(9)};
    }
};

/// Vertices as rays see them that go along z from the origin.
struct ShearedVertices {
    Floats x, y, z;
};

HWY_INLINE ShearedVertices shear(const FilterRays& ray, Floats x, Floats y, Floats z) {
    const Floats depth = z - ray.oz;
    return {hn::NegMulAdd(ray.shear_x, depth, x - ray.ox), hn::NegMulAdd(ray.shear_y, depth, y - ray.oy), depth};
}

/// False only for triangles that the exact test rejects. With u the unit roundoff and R = |origin| + |bounds|, the sheared
/// vertices are right within 8uR; those of a triangle of extent E that is hit are below 2E; so its edge functions are right
/// within 128uR(E + uR), which is less than 16 pad (E + 1.6 pad). A hit's depth lies between those of the vertices. That holds
/// with and without fma.
HWY_INLINE FloatMask may_hit(const FilterRays& ray, const ShearedVertices& a, const ShearedVertices& b,
                             const ShearedVertices& c, Floats extent) {
    const Floats u = hn::NegMulAdd(c.y, b.x, c.x * b.y);
    const Floats v = hn::NegMulAdd(a.y, c.x, a.x * c.y);
    const Floats w = hn::NegMulAdd(b.y, a.x, b.x * a.y);
    const Floats slack = hn::MulAdd(ray.slack.slope, extent, ray.slack.offset);
    const auto outside =
        hn::And(hn::Lt(hn::Min(u, hn::Min(v, w)), hn::Neg(slack)), hn::Gt(hn::Max(u, hn::Max(v, w)), slack));
    const auto apart = hn::Or(hn::Lt(hn::Max(a.z, hn::Max(b.z, c.z)), ray.z_begin),
                              hn::Gt(hn::Min(a.z, hn::Min(b.z, c.z)), ray.z_end));
    return hn::Not(hn::Or(outside, apart));
}

HWY_INLINE FloatMask may_hit(const FilterRays& ray, const FilterTriangles& triangle) {
    return may_hit(ray, shear(ray, triangle.ax, triangle.ay, triangle.az),
                   shear(ray, triangle.bx, triangle.by, triangle.bz), shear(ray, triangle.cx, triangle.cy, triangle.cz),
                   triangle.extent);
}

/// The depths between which hits of a ray with t between t_min and t_max lie, where its direction has this depth and those of
/// vertices are right within depth_pad and their own rounding.
HWY_INLINE void depth_range(float depth, float depth_pad, float t_min, float t_max, float& z_begin, float& z_end) {
    const float from = depth * t_min, to = depth * t_max;
    constexpr float kRounding = 4 * kUnitRoundoff;
    z_begin = std::min(from, to);
    z_end = std::max(from, to);
    z_begin -= depth_pad + kRounding * std::fabs(z_begin);
    z_end += depth_pad + kRounding * std::fabs(z_end);
}

struct DepthRange {
    Floats begin, end;
};
/// The same of many rays.
HWY_INLINE DepthRange depth_range(Floats depth, Floats depth_pad, Floats t_min, Floats t_max) {
    const FloatTag d;
    const Floats from = depth * t_min, to = depth * t_max, rounding = hn::Set(d, 4 * kUnitRoundoff);
    const Floats begin = hn::Min(from, to), end = hn::Max(from, to);
    return {begin - (depth_pad + rounding * hn::Abs(begin)), end + (depth_pad + rounding * hn::Abs(end))};
}

/// difference_of_products, the same to the bit.
HWY_INLINE Doubles exact_difference(Doubles a, Doubles d, Doubles b, Doubles c) {
    const DoubleTag dd;
    const Doubles ad = hn::Mul(a, d), bc = hn::Mul(b, c);
    const Doubles difference = hn::Sub(ad, bc);
    const auto safe = hn::Gt(hn::Abs(difference), hn::Mul(hn::Set(dd, 0x1p-12), hn::Add(hn::Abs(ad), hn::Abs(bc))));
    if (HWY_LIKELY(hn::AllTrue(dd, safe))) return difference;
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_SSE4
    // No fused multiply-add here.
    alignas(16) double as[kDoubles], bs[kDoubles], cs[kDoubles], ds[kDoubles];
    hn::Store(a, dd, as);
    hn::Store(b, dd, bs);
    hn::Store(c, dd, cs);
    hn::Store(d, dd, ds);
    for (std::size_t k = 0; k < kDoubles; ++k) as[k] = difference_of_products(as[k], ds[k], bs[k], cs[k]);
    return hn::Load(dd, as);
#else
    const Doubles careful = hn::Add(hn::MulSub(a, d, bc), hn::NegMulAdd(b, c, bc));
    return hn::IfThenElse(safe, difference, careful);
#endif
}

struct EdgeFunctions {
    Doubles u, v, w;
};
/// cx by - cy bx, ax cy - ay cx and bx ay - by ax by exact_difference.
HWY_INLINE EdgeFunctions edge_functions(Doubles ax, Doubles ay, Doubles bx, Doubles by, Doubles cx, Doubles cy) {
    const DoubleTag dd;
    const Doubles cx_by = hn::Mul(cx, by), ax_cy = hn::Mul(ax, cy), bx_ay = hn::Mul(bx, ay);
    const Doubles u = hn::Sub(cx_by, hn::Mul(cy, bx)), v = hn::Sub(ax_cy, hn::Mul(ay, cx)),
                  w = hn::Sub(bx_ay, hn::Mul(by, ax));
    // |difference| > 2^-10 |one product| is more than exact_difference asks for, of both.
    const auto plain = [&](Doubles difference, Doubles product) HWY_ATTR {
        return hn::Gt(hn::Abs(difference), hn::Mul(hn::Set(dd, 0x1p-10), hn::Abs(product)));
    };
    if (HWY_LIKELY(hn::AllTrue(dd, hn::And(plain(u, cx_by), hn::And(plain(v, ax_cy), plain(w, bx_ay))))))
        return {u, v, w};
    return {exact_difference(cx, by, cy, bx), exact_difference(ax, cy, ay, cx), exact_difference(bx, ay, by, ax)};
}

/// As FilterRays and FilterTriangles.
struct ExactRays {
    Doubles ox, oy, oz, shear_x, shear_y, inverse_z;
};
struct ExactTriangles {
    Doubles ax, ay, az, bx, by, bz, cx, cy, cz;
};
struct ExactHits {
    hn::Mask<DoubleTag> hit;
    Doubles t, u, v;  ///< Not yet rounded.
};

/// intersect_triangle, the same to the bit, but for the range of t.
HWY_INLINE ExactHits intersect(const ExactRays& ray, const ExactTriangles& triangle) {
    const DoubleTag dd;
    const Doubles az = triangle.az - ray.oz, bz = triangle.bz - ray.oz, cz = triangle.cz - ray.oz;
    const Doubles ax = triangle.ax - ray.ox - ray.shear_x * az, bx = triangle.bx - ray.ox - ray.shear_x * bz,
                  cx = triangle.cx - ray.ox - ray.shear_x * cz;
    const Doubles ay = triangle.ay - ray.oy - ray.shear_y * az, by = triangle.by - ray.oy - ray.shear_y * bz,
                  cy = triangle.cy - ray.oy - ray.shear_y * cz;
    const auto [u, v, w] = edge_functions(ax, ay, bx, by, cx, cy);
    const Doubles zero = hn::Zero(dd), determinant = u + v + w;
    const auto outside = hn::And(hn::Lt(hn::Min(u, hn::Min(v, w)), zero), hn::Gt(hn::Max(u, hn::Max(v, w)), zero));
    const Doubles inverse = hn::Set(dd, 1) / determinant;
    const Doubles depth = u * az + v * bz + w * cz;
    return {hn::AndNot(outside, hn::Ne(determinant, zero)), depth * inverse * ray.inverse_z, v * inverse, w * inverse};
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
