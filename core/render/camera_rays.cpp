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

CameraRays::CameraRays(const Camera& camera, double aspect) {
    const auto [forward, right, up] = view_axes(camera);
    const double half_height = std::tan(glm::radians(static_cast<double>(camera.vfov)) / 2);
    const double half_width = half_height * aspect;
    forward_ = Vec3(forward);
    model_ = {.origin = camera.position,
              .right = right,
              .up = up,
              .corner = forward - half_width * right + half_height * up,
              .across = 2 * half_width * right,
              .down = -2 * half_height * up,
              .lens_radius = camera.lens_radius,
              .focus_distance = camera.focus_distance};
}

Ray CameraRays::ray(const Vec2& position, const Vec2& lens) const {
    Ray ray;
    rays({&position, 1}, {&lens, 1}, {&ray, 1});
    return ray;
}

std::optional<CameraRays::View> CameraRays::view(const Vec3& p, const Vec2& lens) const {
    const Vec3d offset = model_.lens_radius * (double{lens.x} * model_.right + double{lens.y} * model_.up);
    const Vec3d to_p = Vec3d(p) - model_.origin - offset;
    const double depth = glm::dot(to_p, Vec3d(forward_));
    if (!(depth > 0)) return std::nullopt;
    // Where the ray meets the plane that is sharp, as seen from the lens centre at distance 1.
    const Vec3d direction = to_p / depth + (model_.lens_radius > 0 ? offset / model_.focus_distance : Vec3d(0));
    const Vec3d from_corner = direction - model_.corner;
    return View{Vec3(model_.origin + offset),
                Vec2(glm::dot(from_corner, model_.across) / glm::dot(model_.across, model_.across),
                     glm::dot(from_corner, model_.down) / glm::dot(model_.down, model_.down))};
}

float CameraRays::density(const Vec3& direction) const {
    const double cosine = glm::dot(Vec3d(direction), Vec3d(forward_));
    const double area = std::sqrt(glm::dot(model_.across, model_.across) * glm::dot(model_.down, model_.down));
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
