#include "core/lights/few_lamps.h"

// The kernels need no more than these.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/lights/few_lamps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/lights/corner_warp-inl.h"
#include "core/lights/light_block_lanes-inl.h"
#include "core/lights/light_importance-inl.h"
#include "core/lights/rectangle_view-inl.h"
#include "core/lights/triangle_view-inl.h"
#include "core/math/double_lanes-inl.h"
#include "core/math/float_error.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// One lamp in all lanes.
HWY_INLINE ClusterLanes cluster_of(const LightClusters& clusters, std::size_t k) {
    const auto all = [&](const auto& rows) HWY_ATTR { return all_lanes(Vec3(rows[0][k], rows[1][k], rows[2][k])); };
    return {all(clusters.center),
            all(clusters.axis),
            all_lanes(clusters.radius2[k]),
            all_lanes(clusters.cos_spread[k]),
            all_lanes(clusters.sin_spread[k]),
            all_lanes(clusters.power[k]),
            hn::BitCast(FloatTag(), hn::Set(WordTag(), clusters.two_sided[k]))};
}

/// Which lamp each lane samples.
struct Choice {
    FloatMask any;
    hn::Vec<hn::RebindToSigned<FloatTag>> lamp;
    Floats probability, remainder;
};

/// As LightTree::draw has it, the order of its sum included.
HWY_INLINE Choice choose(const FewLamps& lamps, const Vec3Lanes& p, const Vec3Lanes& n, Floats u) {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    const Floats zero = hn::Zero(d);
    if (lamps.count == 1) return {hn::FirstN(d, kLanes), hn::Zero(di), all_lanes(1.0f), u};
    Floats sent[FewLamps::kMost];
    for (Floats& s : sent) s = zero;
    const FloatMask facing = hn::Not(is_black(n));
    for (std::size_t k = 0; k < lamps.count; ++k) sent[k] = importance(p, &n, facing, cluster_of(lamps.clusters, k));
    const Floats total = ((sent[0] + sent[1]) + (sent[2] + sent[3])) + ((sent[4] + sent[5]) + (sent[6] + sent[7]));
    const FloatMask usable = hn::And(hn::Gt(total, zero), hn::Lt(total, all_lanes(kInfinity)));
    Floats rest = u * total, chosen = all_lanes(1.0f);
    auto lamp = hn::Zero(di);
    FloatMask open = usable;
    for (std::size_t k = 0; k < lamps.count; ++k) {
        const FloatMask here = hn::And(open, hn::Ne(sent[k], zero));
        lamp = hn::IfThenElse(hn::RebindMask(di, here), hn::Set(di, static_cast<std::int32_t>(k)), lamp);
        chosen = hn::IfThenElse(here, sent[k], chosen);
        const FloatMask ends = hn::And(here, hn::Lt(rest, sent[k]));
        rest = hn::IfThenElse(hn::AndNot(ends, here), rest - sent[k], rest);
        open = hn::AndNot(ends, open);
    }
    const Floats probability = chosen / total;
    const Floats remainder = hn::Min(hn::Max(rest / chosen, zero), all_lanes(1 - kUnitRoundoff));
    return {hn::And(usable, hn::Gt(probability, zero)), lamp, probability, remainder};
}

/// As AreaLight's cone_of has it, a lane each.
struct ConeLanes {
    Vec3Lanes axis;
    Floats distance, one_minus_cos;
    FloatMask outside;
};

HWY_INLINE ConeLanes cone_of(const Vec3Lanes& origin, Floats size, const Vec3Lanes& p) {
    const FloatTag d;
    const DoubleTag dd;
    const hn::Rebind<float, DoubleTag> df;
    alignas(64) float o[3][kLanes], from[3][kLanes], r[kLanes], axis[3][kLanes], distance[kLanes], cosine[kLanes];
    alignas(64) float inside[kLanes];
    const Floats origins[3] = {origin.x, origin.y, origin.z}, points[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; ++k) {
        hn::Store(origins[k], d, o[k]);
        hn::Store(points[k], d, from[k]);
    }
    hn::Store(size, d, r);
    for (std::size_t i = 0; i < kLanes; i += hn::MaxLanes(dd)) {
        const auto load = [&](const float* x) HWY_ATTR { return hn::PromoteTo(dd, hn::Load(df, x + i)); };
        const Doubles x = load(o[0]) - load(from[0]), y = load(o[1]) - load(from[1]), z = load(o[2]) - load(from[2]);
        const Doubles d2 = x * x + y * y + z * z, radius = load(r), one = hn::Set(dd, 1);
        const Doubles sin2 = radius * radius / d2, length = hn::Sqrt(d2);
        const auto within = hn::Not(hn::Lt(sin2, one));
        hn::Store(hn::DemoteTo(df, hn::IfThenElseZero(within, one)), df, inside + i);
        hn::Store(hn::DemoteTo(df, x / length), df, axis[0] + i);
        hn::Store(hn::DemoteTo(df, y / length), df, axis[1] + i);
        hn::Store(hn::DemoteTo(df, z / length), df, axis[2] + i);
        hn::Store(hn::DemoteTo(df, length), df, distance + i);
        hn::Store(hn::DemoteTo(df, sin2 / (one + hn::Sqrt(one - sin2))), df, cosine + i);
    }
    return {{hn::Load(d, axis[0]), hn::Load(d, axis[1]), hn::Load(d, axis[2])},
            hn::Load(d, distance),
            hn::Load(d, cosine),
            hn::Eq(hn::Load(d, inside), hn::Zero(d))};
}

/// A point of a lamp a lane.
struct LampPoints {
    Vec3Lanes point, normal;
    Floats solid_angle, area;  ///< As in AreaLight::Density.
};

/// As AreaLight::sample_sphere has it.
HWY_INLINE LampPoints sphere_points(const Vec3Lanes& origin, Floats size, const Vec3Lanes& p, const Vec2Lanes& u) {
    const Floats zero = hn::Zero(FloatTag()), one = all_lanes(1.0f);
    const ConeLanes cone = cone_of(origin, size, p);
    const Vec3Lanes local = sample_uniform_cone(u, hn::IfThenElse(cone.outside, cone.one_minus_cos, all_lanes(2.0f)));
    const Floats sin2_theta = local.x * local.x + local.y * local.y;
    const Floats ratio = cone.distance / size;
    const Floats cos_alpha = sin2_theta * ratio + local.z * hn::Sqrt(hn::Max(zero, one - sin2_theta * ratio * ratio));
    const Floats sin_alpha = hn::Sqrt(hn::Max(zero, one - cos_alpha * cos_alpha));
    const Floats length = hn::Sqrt(sin2_theta);
    const FloatMask beside = hn::Gt(length, zero);
    const Floats x = hn::IfThenElse(beside, local.x / length, one), y = hn::IfThenElseZero(beside, local.y / length);
    const Vec3Lanes turned = BasisLanes(-cone.axis).to_world({sin_alpha * x, sin_alpha * y, cos_alpha});
    const Vec3Lanes n = select(cone.outside, turned, local);
    return {origin + n * size, n, hn::IfThenElseZero(cone.outside, one / (all_lanes(2 * kPi) * cone.one_minus_cos)),
            one};
}

using LampIndices = hn::Vec<hn::RebindToSigned<FloatTag>>;

/// The numbers of the row that the indices say: shuffled where a register holds all of it, as a gather takes longer.
template <typename Tag>
HWY_INLINE hn::Vec<Tag> looked_up(Tag d, const FewLamps::Row& row, LampIndices index) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(d) == FewLamps::kMost) {
        return hn::TableLookupLanes(hn::LoadU(d, row.data()), hn::IndicesFromVec(d, index));
    } else if constexpr (hn::MaxLanes(d) == 2 * FewLamps::kMost) {
        const auto table = hn::ZeroExtendVector(d, hn::LoadU(hn::Half<Tag>(), row.data()));
        return hn::TableLookupLanes(table, hn::IndicesFromVec(d, index));
    }
#endif
    return hn::GatherIndex(d, row.data(), index);
}

/// The lamp of each lane.
class ChosenLamps {
public:
    HWY_INLINE ChosenLamps(const FewLamps& lamps, const Choice& choice) : lamps_(lamps), lamp_(choice.lamp) {}

    HWY_INLINE Floats of(const FewLamps::Row& row) const {
        return lamps_.count == 1 ? all_lanes(row[0]) : looked_up(FloatTag(), row, lamp_);
    }
    HWY_INLINE Vec3Lanes of(const FewLamps::Rows& rows) const { return {of(rows[0]), of(rows[1]), of(rows[2])}; }
    HWY_INLINE FloatMask is(const FewLamps::Row& row) const { return hn::Ne(of(row), hn::Zero(FloatTag())); }

    HWY_INLINE LampPoints points(const Vec3Lanes& p, const Vec3Lanes& n, const Vec2Lanes& u) const {
        if (!lamps_.any_flat) return sphere_points(of(lamps_.origin), of(lamps_.size), p, u);
        const LampPoints flat = flat_points(p, n, u);
        if (!lamps_.any_sphere) return flat;
        const LampPoints sphere = sphere_points(of(lamps_.origin), of(lamps_.size), p, u);
        const FloatMask round = is(lamps_.is_sphere);
        return {select(round, sphere.point, flat.point), select(round, sphere.normal, flat.normal),
                hn::IfThenElse(round, sphere.solid_angle, flat.solid_angle),
                hn::IfThenElse(round, sphere.area, flat.area)};
    }

private:
    /// A place on a flat lamp, as shares of its edges.
    struct Position {
        Vec2Lanes at;
        Floats solid_angle, area;  ///< As in AreaLight::Density.

        HWY_INLINE void set(FloatMask mask, const Vec2Lanes& position) {
            at = {hn::IfThenElse(mask, position.x, at.x), hn::IfThenElse(mask, position.y, at.y)};
        }
    };

    /// As AreaLight::sample_flat has it.
    HWY_INLINE LampPoints flat_points(const Vec3Lanes& p, const Vec3Lanes& n, const Vec2Lanes& u) const {
        const Position position = flat_position(p, n, u);
        return {of(lamps_.origin) + of(lamps_.edge_u) * position.at.x + of(lamps_.edge_v) * position.at.y,
                of(lamps_.normal), position.solid_angle, position.area};
    }

    HWY_INLINE Position flat_position(const Vec3Lanes& p, const Vec3Lanes& n, const Vec2Lanes& u) const {
        const FloatTag d;
        Position position{u, hn::Zero(d), all_lanes(1.0f)};
        const Vec3Lanes corner = of(lamps_.origin) - p, across = of(lamps_.diagonal);
        const Vec3Lanes middle = corner + across * all_lanes(0.5f);
        const Floats distance2 = dot(middle, middle);
        const FloatMask near = hn::Lt(distance2, of(lamps_.near2)), triangle = is(lamps_.is_triangle);
        const FloatMask close = hn::Lt(distance2, of(lamps_.close2));
        const FloatMask close_rectangle = hn::AndNot(triangle, close), close_triangle = hn::And(triangle, close);
        if (!hn::AllFalse(d, close_rectangle)) view_rectangle(corner, across, n, close_rectangle, position);
        if (!hn::AllFalse(d, close_triangle)) view_triangle(corner, n, close_triangle, position);
        const FloatMask viewed = hn::Gt(position.solid_angle, hn::Zero(d));
        const FloatMask bent = hn::AndNot(viewed, near);
        if (!hn::AllFalse(d, bent)) warp(corner, across, n, bent, position);
        if (lamps_.any_triangle) position.set(hn::AndNot(viewed, triangle), sample_uniform_triangle(position.at));
        return position;
    }

    /// As AreaLight::rectangle_view has it.
    HWY_INLINE void view_rectangle(const Vec3Lanes& corner, const Vec3Lanes& across, const Vec3Lanes& n,
                                   FloatMask close, Position& position) const {
        const RectangleFrameLanes frame{of(lamps_.frame_x), of(lamps_.frame_y), of(lamps_.frame_z),
                                        of(lamps_.frame_width), of(lamps_.frame_height)};
        const RectangleViewLanes view(frame, corner);
        const Vec3Lanes corners[] = {corner, corner + of(lamps_.edge_u), corner + of(lamps_.edge_v), corner + across};
        sample_view(view, corners, n, hn::And(close, hn::Gt(view.z, all_lanes(kLeastHeight))), position);
    }

    /// As AreaLight::triangle_view has it.
    HWY_INLINE void view_triangle(const Vec3Lanes& corner, const Vec3Lanes& n, FloatMask close,
                                  Position& position) const {
        const Floats height = hn::Abs(dot(corner, of(lamps_.normal)));
        const FloatMask above = hn::Gt(height * height, all_lanes(kLeastHeight2) * of(lamps_.close2));
        const Vec3Lanes b = corner + of(lamps_.edge_u), c = corner + of(lamps_.edge_v);
        const TriangleViewLanes view({corner, b, c}, of(lamps_.size), height);
        sample_view(view, {corner, corner, b, c}, n, hn::And(close, above), position);
    }

    template <typename View>
    static HWY_INLINE void sample_view(const View& view, const Vec3Lanes (&corners)[4], const Vec3Lanes& n,
                                       FloatMask here, Position& position) {
        // What follows says nothing, and may be NaN, of lanes that are not here.
        if (hn::AllFalse(FloatTag(), here)) return;
        Floats closeness[4];
        view.closeness(closeness);
        const CornerWarpLanes warp = cosine_warp(corners, closeness, n);
        const Vec2Lanes numbers = warp.sample(position.at);
        const Floats angle = view.solid_angle();
        position.set(here, view.sample(numbers, angle));
        position.solid_angle = hn::IfThenElse(here, warp.density(numbers) / angle, position.solid_angle);
    }

    /// As AreaLight::warp has it.
    HWY_INLINE void warp(const Vec3Lanes& corner, const Vec3Lanes& across, const Vec3Lanes& n, FloatMask here,
                         Position& position) const {
        const Vec3Lanes corners[] = {corner, corner + of(lamps_.edge_u), corner + of(lamps_.edge_v), corner + across};
        const CornerWarpLanes warp = corner_warp(corners, n);
        const Vec2Lanes bent = warp.sample(position.at);
        position.set(here, bent);
        position.area = hn::IfThenElse(here, warp.density(bent), position.area);
    }

    const FewLamps& lamps_;
    hn::Vec<hn::RebindToSigned<FloatTag>> lamp_;
};

/// As LightTable::sample and AreaLight::finish have it.
HWY_ATTR void sample_lamps(const FewLamps& lamps, LightBlock& block) {
    const FloatTag d;
    const Floats zero = hn::Zero(d);
    for (std::size_t i = 0; i < block.size; i += kLanes) {
        const Vec3Lanes p = load(block.p, i);
        const Floats u = hn::Min(hn::Load(d, block.u + i), all_lanes(1 - kUnitRoundoff));
        const Vec3Lanes n = load(block.n, i);
        const Choice choice = choose(lamps, p, n, u);
        const ChosenLamps chosen(lamps, choice);
        const LampPoints on_lamp = chosen.points(p, n, {choice.remainder, hn::Load(d, block.v + i)});
        const Vec3Lanes way = on_lamp.point - p;
        const Floats distance2 = dot(way, way), distance = hn::Sqrt(distance2);
        const Vec3Lanes wi = way / distance, radiance = chosen.of(lamps.radiance);
        const Floats towards = dot(on_lamp.normal, wi), cosine = hn::Neg(towards);
        const FloatMask shines =
            hn::Or(hn::Gt(cosine, zero), hn::And(hn::Lt(cosine, zero), chosen.is(lamps.two_sided)));
        const Floats by_area = on_lamp.area * (distance2 / (chosen.of(lamps.area) * hn::Abs(towards)));
        const Floats density = hn::IfThenElse(hn::Gt(on_lamp.solid_angle, zero), on_lamp.solid_angle, by_area);
        const Floats pdf = density * choice.probability;
        const FloatMask valid = hn::And(hn::And(hn::Gt(density, zero), hn::Lt(density, all_lanes(kInfinity))),
                                        hn::And(hn::Gt(pdf, zero), hn::Gt(distance, zero)));
        const FloatMask found = hn::And(hn::And(choice.any, valid), hn::AndNot(is_black(radiance), shines));
        const Vec3Lanes error = all_lanes(Vec3(gamma(6))) * abs(p) + chosen.of(lamps.point_error);
        hn::Store(hn::IfThenElseZero(found, pdf), d, block.pdf + i);
        hn::Store(distance, d, block.distance + i);
        store(wi, block.wi, i);
        store(radiance, block.radiance, i);
        store(offset_ray_origin(on_lamp.point, error, on_lamp.normal, -wi), block.target, i);
    }
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {
namespace {

void put(const Vec3& v, FewLamps::Rows& rows, std::size_t k) {
    for (int axis = 0; axis < 3; ++axis) rows[static_cast<std::size_t>(axis)][k] = v[axis];
}

}  // namespace

HWY_EXPORT(sample_lamps);

std::optional<FewLamps> FewLamps::of(std::span<const AreaLight> lights, const LightTree& tree) {
    if (tree.empty() || tree.size() > kMost) return std::nullopt;
    FewLamps result;
    for (std::size_t k = 0; k < tree.size(); ++k) {
        const AreaLight& light = lights[tree.size() == 1 ? *tree.only_light() : tree.light_in_lane(k)];
        if (light.texture) return std::nullopt;
        result.add(light);
    }
    if (tree.size() > 1) result.clusters = *tree.only_clusters();
    return result;
}

void FewLamps::add(const AreaLight& light) {
    const std::size_t k = count++;
    const bool sphere = light.kind == AreaLight::Kind::sphere;
    const bool triangle = light.kind == AreaLight::Kind::triangle;
    (sphere ? any_sphere : any_flat) = true;
    any_triangle |= triangle;
    put(light.origin, origin, k);
    put(light.edge_u, edge_u, k);
    put(light.edge_v, edge_v, k);
    put(light.diagonal(), diagonal, k);
    put(light.normal, normal, k);
    put(light.radiance, radiance, k);
    put(light.point_error(), point_error, k);
    size[k] = light.size;
    area[k] = light.area();
    near2[k] = light.near2;
    close2[k] = light.close2;
    const RectangleFrame& frame = light.frame;
    put(frame.x, frame_x, k);
    put(frame.y, frame_y, k);
    put(frame.z, frame_z, k);
    frame_width[k] = frame.width;
    frame_height[k] = frame.height;
    is_sphere[k] = sphere ? 1 : 0;
    is_triangle[k] = triangle ? 1 : 0;
    two_sided[k] = light.two_sided ? 1 : 0;
}

void FewLamps::sample(LightBlock& block) const {
    HWY_DYNAMIC_DISPATCH(sample_lamps)(*this, block);
}

}  // namespace rayuela
#endif
