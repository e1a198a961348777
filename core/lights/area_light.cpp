#include "core/lights/area_light.h"

#include "core/lights/corner_warp.h"
#include "core/lights/triangle_view.h"
#include "core/materials/bsdf.h"
#include "core/math/basis.h"
#include "core/math/float_error.h"
#include "core/math/sampling.h"

#include <cmath>

namespace rayuela {
namespace {

/// A sphere as seen from a point outside.
struct Cone {
    Vec3 axis;
    float distance;  ///< To the centre.
    float one_minus_cos;
};

/// In double: close to the sphere both differences cancel.
std::optional<Cone> cone_of(const AreaLight& sphere, const Vec3& p) {
    const Vec3d to_centre = Vec3d(sphere.origin) - Vec3d(p);
    const double d2 = glm::dot(to_centre, to_centre), r = sphere.size;
    const double sin2 = r * r / d2;
    if (!(sin2 < 1)) return std::nullopt;
    const double d = std::sqrt(d2);
    return Cone{Vec3(to_centre / d), static_cast<float>(d), static_cast<float>(sin2 / (1 + std::sqrt(1 - sin2)))};
}

/// Density per solid angle at p of a point drawn evenly over `area`, seen along `wi` (unit).
float area_pdf(const Vec3& p, const Vec3& point, const Vec3& wi, const Vec3& normal, float area) {
    const Vec3 d = point - p;
    return glm::dot(d, d) / (area * std::abs(glm::dot(normal, wi)));
}

/// A light is near up to so many times the half of its diagonal.
constexpr float kNear = 5;
/// Of edges that are closer to parallel than this sine the numbers of a point are lost in its rounding.
constexpr double kLeastSine = 1.0 / 64;

/// The cosine of edges that stand at right angles but for the rounding of corners 2^7 sizes away from the origin.
constexpr double kRightAngle = 0x1p-16;
/// Of the half diagonal: narrower ones are not looked at as such, for their solid angle is lost in rounding.
constexpr double kLeastSide = 1.0 / 64;

/// AreaLight::near2.
float near_distance2(const AreaLight& flat) {
    const double u2 = glm::dot(Vec3d(flat.edge_u), Vec3d(flat.edge_u));
    const double v2 = glm::dot(Vec3d(flat.edge_v), Vec3d(flat.edge_v));
    const double span = (flat.kind == AreaLight::Kind::triangle ? 2.0 : 1.0) * flat.size;
    const bool sliver = span * span < kLeastSine * kLeastSine * u2 * v2;
    return sliver ? 0.0f : static_cast<float>(0.25 * kNear * kNear * (u2 + v2));
}

/// Half the diagonal of the parallelogram of these edges, if it had right angles.
double half_diagonal(const Vec3d& u, const Vec3d& v) {
    return 0.5 * std::sqrt(glm::dot(u, u) + glm::dot(v, v));
}

bool looks_like_triangle(const Vec3d& u, const Vec3d& v) {
    const double longest = std::max({glm::length(u), glm::length(v), glm::length(v - u)});
    return glm::length(glm::cross(u, v)) >= kLeastSide * half_diagonal(u, v) * longest;
}

bool looks_like_rectangle(const Vec3d& u, const Vec3d& v) {
    const double width = glm::length(u), height = glm::length(v);
    return std::abs(glm::dot(u, v)) <= kRightAngle * width * height &&
           std::min(width, height) >= kLeastSide * half_diagonal(u, v);
}

RectangleFrame rectangle_frame(const Vec3d& u, const Vec3d& v) {
    const double width = glm::length(u), height = glm::length(v), unit = half_diagonal(u, v);
    return {.x = Vec3(u / (width * unit)),
            .y = Vec3(v / (height * unit)),
            .z = Vec3(glm::normalize(glm::cross(u, v)) / unit),
            .width = static_cast<float>(width / unit),
            .height = static_cast<float>(height / unit)};
}

/// Of a point of a flat light, along its edges.
Vec2 position_on(const AreaLight& flat, const Vec3& point) {
    const Vec3d d = Vec3d(point) - Vec3d(flat.origin), u(flat.edge_u), v(flat.edge_v), across = glm::cross(u, v);
    const double area2 = glm::dot(across, across);
    return {glm::dot(glm::cross(d, v), across) / area2, glm::dot(glm::cross(u, d), across) / area2};
}

/// A close flat light as seen from a receiver: even over the solid angle, but for the cosine at the receiver.
template <typename View>
class BentView {
public:
    BentView(const AreaLight& light, const LightReceiver& receiver, const View& view)
        : view_(view), angle_(view.solid_angle()) {
        const Vec3 a = light.origin - receiver.p, b = a + light.edge_u, c = a + light.edge_v;
        const bool triangle = light.kind == AreaLight::Kind::triangle;
        const std::array<Vec3, 4> corners{a, triangle ? a : b, triangle ? b : c, triangle ? c : a + light.diagonal()};
        bent_ = cosine_warp(corners, view.closeness(), receiver.n);
    }
    Vec2 numbers(const Vec2& u) const { return bent_.sample(u); }
    Vec2 position(const Vec2& numbers) const { return view_.sample(numbers, angle_); }
    float pdf(const Vec2& numbers) const { return bent_.density(numbers) / angle_; }
    float pdf_at(const Vec2& position) const { return pdf(view_.numbers_of(position, angle_)); }

private:
    View view_;
    float angle_;
    CornerWarp bent_;
};

Vec2 sphere_uv(const Vec3& own) {
    const float longitude = std::atan2(-own.z, own.x) * (0.5f * kInvPi);
    return {longitude < 0 ? longitude + 1 : longitude, std::atan2(std::hypot(own.x, own.z), own.y) * kInvPi};
}

}  // namespace

void AreaLight::place(Kind flat_kind, const Vec3& corner, const Vec3& u, const Vec3& v, bool inverted) {
    kind = flat_kind;
    origin = corner;
    edge_u = u;
    edge_v = v;
    const Vec3d cross = glm::cross(Vec3d(u), Vec3d(v));
    const double length = glm::length(cross);
    if (length > 0 && std::isfinite(length)) {
        normal = Vec3(cross / (inverted ? -length : length));
        size = static_cast<float>(kind == Kind::triangle ? 0.5 * length : length);
    }
    near2 = near_distance2(*this);
    const Vec3d du(u), dv(v);
    if (near2 > 0 && (kind == Kind::triangle ? looks_like_triangle(du, dv) : looks_like_rectangle(du, dv))) {
        const double reach = double{kClose} * half_diagonal(du, dv);
        close2 = static_cast<float>(reach * reach);
        if (kind == Kind::parallelogram) frame = rectangle_frame(du, dv);
    }
}

float AreaLight::area() const {
    return kind == Kind::sphere ? 4 * kPi * size * size : size;
}

float AreaLight::power() const {
    const float mean = (radiance.x + radiance.y + radiance.z) / 3;
    return mean * kPi * area() * (two_sided ? 2.0f : 1.0f);
}

Color AreaLight::radiance_at(const Vec2& position) const {
    if (!texture) return radiance;
    return emitted(*texture->material, texture->uv_origin + position.x * texture->uv_u + position.y * texture->uv_v,
                   true);
}

Color AreaLight::radiance_at(const Vec3& sphere_normal) const {
    if (!texture) return radiance;
    return emitted(*texture->material, sphere_uv(glm::normalize(texture->sphere_to_local * sphere_normal)), true);
}

std::optional<LightSample> AreaLight::sample(const LightReceiver& receiver, const Vec2& u) const {
    return kind == Kind::sphere ? sample_sphere(receiver.p, u) : sample_flat(receiver, u);
}

std::optional<LightSample> AreaLight::sample_sphere(const Vec3& p, const Vec2& u) const {
    const std::optional<Cone> cone = cone_of(*this, p);
    if (!cone && !two_sided) return std::nullopt;
    Vec3 n;
    if (cone) {
        // The near point where the direction meets the sphere, by its angle from the axis at the centre: no difference of
        // large numbers. sin(alpha) from the law of sines, PBRT 4th ed., 6.2.4.
        const Vec3 local = sample_uniform_cone(u, cone->one_minus_cos);
        const float sin2_theta = local.x * local.x + local.y * local.y;
        const float ratio = cone->distance / size;
        const float cos_alpha =
            sin2_theta * ratio + local.z * std::sqrt(std::max(0.0f, 1 - sin2_theta * ratio * ratio));
        const float sin_alpha = std::sqrt(std::max(0.0f, 1 - cos_alpha * cos_alpha));
        const float length = std::sqrt(sin2_theta);
        const Vec2 around = length > 0 ? Vec2(local) / length : Vec2(1, 0);
        n = Basis(-cone->axis).to_world({sin_alpha * around.x, sin_alpha * around.y, cos_alpha});
    } else {
        n = sample_uniform_sphere(u);
    }
    return finish(p, origin + size * n, n, {cone ? uniform_cone_pdf(cone->one_minus_cos) : 0.0f, 1}, radiance_at(n));
}

Vec3 AreaLight::diagonal() const {
    const Vec3 across = edge_u + edge_v;
    return kind == Kind::triangle ? 0.5f * across : across;
}

bool AreaLight::close(const Vec3& p) const {
    const Vec3 middle = (origin - p) + 0.5f * diagonal();
    return glm::dot(middle, middle) < close2;
}

std::optional<RectangleView> AreaLight::rectangle_view(const Vec3& p) const {
    if (kind != Kind::parallelogram || !close(p)) return std::nullopt;
    const RectangleView view(frame, origin - p);
    return view.z > kLeastHeight ? std::optional(view) : std::nullopt;
}

std::optional<TriangleView> AreaLight::triangle_view(const Vec3& p) const {
    if (kind != Kind::triangle || !close(p)) return std::nullopt;
    const Vec3 corner = origin - p;
    const float height = std::abs(glm::dot(corner, normal));
    if (!(height * height > kLeastHeight2 * close2)) return std::nullopt;
    return TriangleView({corner, corner + edge_u, corner + edge_v}, size, height);
}

std::optional<CornerWarp> AreaLight::warp(const LightReceiver& receiver) const {
    const Vec3 corner = origin - receiver.p, across = diagonal(), middle = corner + 0.5f * across;
    if (!(glm::dot(middle, middle) < near2)) return std::nullopt;
    const std::array<Vec3, 4> corners{corner, corner + edge_u, corner + edge_v, corner + across};
    return corner_warp(corners, receiver.n);
}

Vec2 AreaLight::numbers_of(const Vec3& point) const {
    const Vec2 position = position_on(*this, point);
    return glm::clamp(kind == Kind::triangle ? invert_uniform_triangle(position) : position, 0.0f, 1.0f);
}

std::optional<LightSample> AreaLight::sample_flat(const LightReceiver& receiver, const Vec2& u) const {
    const auto sample_at = [&](const Vec2& position, const Density& density) {
        return finish(receiver.p, origin + position.x * edge_u + position.y * edge_v, normal, density,
                      radiance_at(position));
    };
    const auto sample_view = [&](const auto& view) {
        const BentView bent(*this, receiver, view);
        const Vec2 numbers = bent.numbers(u);
        return sample_at(bent.position(numbers), {bent.pdf(numbers), 1});
    };
    if (const auto view = rectangle_view(receiver.p)) return sample_view(*view);
    if (const auto view = triangle_view(receiver.p)) return sample_view(*view);
    const std::optional<CornerWarp> bent = warp(receiver);
    const Vec2 numbers = bent ? bent->sample(u) : u;
    return sample_at(kind == Kind::triangle ? sample_uniform_triangle(numbers) : numbers,
                     {0, bent ? bent->density(numbers) : 1});
}

std::optional<LightSample> AreaLight::finish(const Vec3& p, const Vec3& point, const Vec3& n, const Density& density,
                                             const Color& emitted_radiance) const {
    const Vec3 d = point - p;
    const float distance = glm::length(d);
    LightSample s;
    s.wi = d / distance;
    const float cosine = -glm::dot(n, s.wi);
    if (!(distance > 0) || cosine == 0 || (cosine < 0 && !two_sided) || is_black(emitted_radiance)) return std::nullopt;
    s.distance = distance;
    s.radiance = emitted_radiance;
    s.pdf = density.solid_angle > 0 ? density.solid_angle : density.area * area_pdf(p, point, s.wi, n, area());
    if (!(s.pdf > 0 && s.pdf < kInfinity)) return std::nullopt;
    // Rounding of the point itself, of the shadow ray's direction and of its intersection with the surface.
    const Vec3 error = gamma(6) * glm::abs(p) + point_error();
    s.target = offset_ray_origin(point, error, n, -s.wi);
    return s;
}

Vec3 AreaLight::point_error() const {
    return gamma(6) * (glm::abs(origin) + (kind == Kind::sphere ? Vec3(size) : glm::abs(edge_u) + glm::abs(edge_v)));
}

AreaLight::SurfaceSample AreaLight::sample_surface(const Vec2& u, float u_side) const {
    SurfaceSample s;
    if (kind == Kind::sphere) {
        s.normal = sample_uniform_sphere(u);
        s.point = origin + size * s.normal;
        s.radiance = radiance_at(s.normal);
    } else {
        const Vec2 position = kind == Kind::triangle ? sample_uniform_triangle(u) : u;
        s.normal = normal;
        s.point = origin + position.x * edge_u + position.y * edge_v;
        s.radiance = radiance_at(position);
    }
    s.error = point_error();
    s.pdf = (two_sided ? 0.5f : 1.0f) / area();
    if (two_sided && u_side < 0.5f) s.normal = -s.normal;
    return s;
}

float AreaLight::pdf(const LightReceiver& receiver, const Vec3& wi, const Vec3& hit_point, const Vec3& ng) const {
    if (glm::dot(ng, wi) >= 0 && !two_sided) return 0;
    const auto view_pdf = [&](const auto& view) {
        const Vec2 position = glm::clamp(position_on(*this, hit_point), 0.0f, 1.0f);
        return BentView(*this, receiver, view).pdf_at(position);
    };
    if (const auto view = rectangle_view(receiver.p)) return view_pdf(*view);
    if (const auto view = triangle_view(receiver.p)) return view_pdf(*view);
    float density = area_pdf(receiver.p, hit_point, wi, ng, area());
    if (kind == Kind::sphere) {
        if (const std::optional<Cone> cone = cone_of(*this, receiver.p)) return uniform_cone_pdf(cone->one_minus_cos);
    } else if (const std::optional<CornerWarp> bent = warp(receiver)) {
        density *= bent->density(numbers_of(hit_point));
    }
    return density < kInfinity ? density : 0.0f;
}

}  // namespace rayuela
