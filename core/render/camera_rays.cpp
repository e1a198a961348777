#include "core/render/camera_rays.h"

#include "core/math/basis.h"
#include "core/math/sampling.h"

#include <cmath>

namespace rayuela {

namespace {

struct Axes {
    Vec3d forward, right, up;
};

/// `v` at unit length without overflow or underflow on the way, or `fallback` where it has no direction.
Vec3d unit_or(const Vec3d& v, const Vec3d& fallback) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : fallback;
}

Axes view_axes(const Camera& camera) {
    const Vec3d forward = unit_or(Vec3d(camera.target) - Vec3d(camera.position), Vec3d(0, 0, -1));
    // The cosine below which `up` still says which way is up: its sine is lost in the rounding of the two vectors.
    constexpr double kParallel = 1 - 1e-12;
    Vec3d up = unit_or(Vec3d(camera.up), Vec3d(0, 1, 0));
    if (std::abs(glm::dot(up, forward)) > kParallel) up = Vec3d(Basis(Vec3(forward)).s);
    const Vec3d right = glm::normalize(glm::cross(forward, up));
    return {forward, right, glm::cross(right, forward)};
}

constexpr float kSigma = 0.5f, kGaussianRadius = 1.5f;

/// Of the Gaussian, within its radius.
float gaussian_mass() {
    return 1 - std::exp(-kGaussianRadius * kGaussianRadius / (2 * kSigma * kSigma));
}

float tent(float u) {
    return u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u);
}

}  // namespace

CameraRays::CameraRays(const Camera& camera, double aspect)
    : origin_(camera.position), lens_radius_(camera.lens_radius), focus_distance_(camera.focus_distance) {
    const auto [forward, right, up] = view_axes(camera);
    const double half_height = std::tan(glm::radians(static_cast<double>(camera.vfov)) / 2);
    const double half_width = half_height * aspect;
    forward_ = Vec3(forward);
    right_ = right;
    up_ = up;
    corner_ = forward - half_width * right + half_height * up;
    across_ = 2 * half_width * right;
    down_ = -2 * half_height * up;
}

/// To `position` of the image plane at distance 1, from the centre of the lens.
Vec3d CameraRays::direction(const Vec2& position) const {
    return corner_ + double{position.x} * across_ + double{position.y} * down_;
}

// Rays are written where they are to be: a whole that is copied has to wait for its parts to be stored.

void CameraRays::write_ray_of_centre(const Vec2& position, Ray& ray) const {
    ray.t_min = 0;
    ray.t_max = kInfinity;
    ray.origin = origin_;
    ray.direction = Vec3(glm::normalize(direction(position)));
}

void CameraRays::write_ray_of_lens(const Vec2& position, const Vec2& lens, Ray& ray) const {
    // Relative to the lens centre: the distance to the focus plane is not lost in the camera's coordinates.
    const Vec3d offset = lens_radius_ * (double{lens.x} * right_ + double{lens.y} * up_);
    ray.t_min = 0;
    ray.t_max = kInfinity;
    ray.origin = Vec3(Vec3d(origin_) + offset);
    ray.direction = Vec3(glm::normalize(focus_distance_ * direction(position) - offset));
}

void CameraRays::rays(std::span<const Vec2> positions, std::span<const Vec2> lens, std::span<Ray> rays) const {
    if (lens_radius_ == 0) {
        for (std::size_t i = 0; i < positions.size(); ++i) write_ray_of_centre(positions[i], rays[i]);
    } else {
        for (std::size_t i = 0; i < positions.size(); ++i) write_ray_of_lens(positions[i], lens[i], rays[i]);
    }
}

Ray CameraRays::ray(const Vec2& position, const Vec2& lens) const {
    Ray ray;
    rays({&position, 1}, {&lens, 1}, {&ray, 1});
    return ray;
}

std::optional<CameraRays::View> CameraRays::view(const Vec3& p, const Vec2& lens) const {
    const Vec3d offset = lens_radius_ * (double{lens.x} * right_ + double{lens.y} * up_);
    const Vec3d to_p = Vec3d(p) - Vec3d(origin_) - offset;
    const double depth = glm::dot(to_p, Vec3d(forward_));
    if (!(depth > 0)) return std::nullopt;
    // Where the ray meets the plane that is sharp, as seen from the lens centre at distance 1.
    const Vec3d direction = to_p / depth + (lens_radius_ > 0 ? offset / focus_distance_ : Vec3d(0));
    const Vec3d from_corner = direction - corner_;
    return View{Vec3(Vec3d(origin_) + offset), Vec2(glm::dot(from_corner, across_) / glm::dot(across_, across_),
                                                    glm::dot(from_corner, down_) / glm::dot(down_, down_))};
}

float CameraRays::density(const Vec3& direction) const {
    const double cosine = glm::dot(Vec3d(direction), Vec3d(forward_));
    const double area = std::sqrt(glm::dot(across_, across_) * glm::dot(down_, down_));
    return static_cast<float>(1 / (cosine * cosine * cosine * area));
}

Vec2 sample_filter(PixelFilter filter, const Vec2& u) {
    switch (filter) {
        case PixelFilter::box:
            return u - 0.5f;
        case PixelFilter::tent:
            return {tent(u.x), tent(u.y)};
        case PixelFilter::gaussian:
            break;
    }
    // Box & Muller in polar form, the radius by inversion of its distribution cut at kGaussianRadius.
    const float radius = kSigma * std::sqrt(-2 * std::log(1 - u.x * gaussian_mass()));
    return radius * cos_sin_turns(u.y);
}

float filter_radius(PixelFilter filter) {
    switch (filter) {
        case PixelFilter::box:
            return 0.5f;
        case PixelFilter::tent:
            return 1;
        case PixelFilter::gaussian:
            break;
    }
    return kGaussianRadius;
}

float filter_density(PixelFilter filter, const Vec2& offset) {
    switch (filter) {
        case PixelFilter::box:
            return offset.x >= -0.5f && offset.x < 0.5f && offset.y >= -0.5f && offset.y < 0.5f ? 1.0f : 0.0f;
        case PixelFilter::tent:
            return std::max(0.0f, 1 - std::abs(offset.x)) * std::max(0.0f, 1 - std::abs(offset.y));
        case PixelFilter::gaussian:
            break;
    }
    const float r2 = glm::dot(offset, offset);
    if (!(r2 < kGaussianRadius * kGaussianRadius)) return 0;
    return std::exp(-r2 / (2 * kSigma * kSigma)) / (2 * kPi * kSigma * kSigma * gaussian_mass());
}

}  // namespace rayuela
