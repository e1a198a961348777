#pragma once

#include "core/math/float_error.h"
#include "core/math/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayuela {

/// Polynomial in z = x^2 for |x| <= tan(pi / 8): atan(x) = x + x z A(z). Moshier, Cephes Mathematical Library. Highest power
/// first.
inline constexpr float kAtan[] = {8.05374449538e-2f, -1.38776856032e-1f, 1.99777106478e-1f, -3.33329491539e-1f};
inline constexpr float kTanPi8 = 0.41421356237f;

/// The angle of (x, y) from the x axis, for y >= 0; in [0, pi].
inline float angle_of(float x, float y) {
    const float across = std::abs(x), low = std::min(across, y), high = std::max(across, y);
    const bool beyond = low > kTanPi8 * high;
    const float t = (beyond ? low - high : low) / (beyond ? low + high : high), z = t * t;
    const float tail = ((kAtan[0] * z + kAtan[1]) * z + kAtan[2]) * z + kAtan[3];
    const float octant = (beyond ? kPi / 4 : 0.0f) + (t + t * z * tail);
    const float quadrant = across < y ? kPi / 2 - octant : octant;
    return x < 0 ? kPi - quadrant : quadrant;
}

/// Axes of a rectangle, right-angled, of length one over `unit`, and its sides in this unit.
struct RectangleFrame {
    Vec3 x{0}, y{0}, z{0};
    float width = 0, height = 0;
};

/// A rectangle or triangle is close up to so many times the half of its diagonal. Farther away its corners say as much for
/// less time.
inline constexpr float kClose = 2;
/// Closer to its plane than this a rectangle is not looked at as such: differences of nearly equal sines would decide.
inline constexpr float kLeastHeight = 1.0f / 8;

/// A rectangle from x0 to x1 and y0 to y1 in a plane at distance z > 0, as seen from the origin. For coordinates of about 1.
struct RectangleView {
    float x0, x1, y0, y1, z;

    /// `corner`: from the eye to the one where the axes begin.
    RectangleView(const RectangleFrame& frame, const Vec3& corner)
        : x0(glm::dot(corner, frame.x)),
          x1(x0 + frame.width),
          y0(glm::dot(corner, frame.y)),
          y1(y0 + frame.height),
          z(std::abs(glm::dot(corner, frame.z))) {}

    /// That of two triangles; tan of the half of each by Van Oosterom & Strackee, "The Solid Angle of a Plane Triangle", 1983.
    /// No difference of large numbers, however small it is.
    float solid_angle() const {
        const float r00 = distance(x0, y0), r10 = distance(x1, y0), r01 = distance(x0, y1), r11 = distance(x1, y1);
        const float zz = z * z, volume = z * ((x1 - x0) * (y1 - y0));
        const float xx = x0 * x1 + zz, yy = y0 * y1 + zz, across = xx + y0 * y1;
        const float lower = r00 * r10 * r11 + (xx + y0 * y0) * r11 + (yy + x1 * x1) * r00 + across * r10;
        const float upper = r00 * r01 * r11 + (xx + y1 * y1) * r00 + (yy + x0 * x0) * r11 + across * r01;
        const float a = lower / volume, b = upper / volume;  // cotangents
        return 2 * angle_of(a * b - 1, a + b);
    }

    /// Even over the directions; as a share of either side. Urena, Fajardo & King, "An Area-Preserving Parametrization for
    /// Spherical Rectangles", 2013, their sines and cosines from sides instead of angles.
    Vec2 sample(const Vec2& u, float angle) const {
        const float zz = z * z, r00 = distance(x0, y0), r01 = distance(x0, y1);
        const float rho0 = std::sqrt(y0 * y0 + zz), rho1 = std::sqrt(y1 * y1 + zz);
        const float b0 = y0 / rho0, b1 = y1 / rho1, scale = 1 / ((x0 * x0 + zz) * (rho0 * rho1));
        const float cos_k = (x0 * x0 * (y0 * y1) + zz * (r00 * r01)) * scale;
        const float sin_k = x0 * z * (r00 * y1 - r01 * y0) * scale;
        const Vec2 w = cos_sin_turns(u.x * angle * (0.5f * kInvPi));
        const float cosine = w.x * cos_k - w.y * sin_k, sine = w.y * cos_k + w.x * sin_k;
        const float g = b1 - cosine * b0, below = sine * z / rho0;
        const float x = std::clamp(z * sine / std::sqrt(std::max(0.0f, g * g - below * below)), x0, x1);
        const float dd = x * x + zz, h0 = y0 / std::sqrt(dd + y0 * y0), h1 = y1 / std::sqrt(dd + y1 * y1);
        const float h = h0 + u.y * (h1 - h0);
        const float y = std::clamp(h * std::sqrt(dd / (1 - h * h)), y0, y1);
        return {std::min((x - x0) / (x1 - x0), 1.0f), std::min((y - y0) / (y1 - y0), 1.0f)};
    }

    /// The numbers that `sample` maps to this position.
    Vec2 numbers_of(const Vec2& position, float angle) const {
        RectangleView part = *this;
        part.x1 = x0 + std::max(position.x, kUnitRoundoff) * (x1 - x0);
        const float dd = part.x1 * part.x1 + z * z, y = y0 + position.y * (y1 - y0);
        const float h0 = y0 / std::sqrt(dd + y0 * y0), h1 = y1 / std::sqrt(dd + y1 * y1);
        const float h = y / std::sqrt(dd + y * y);
        return glm::clamp(Vec2(part.solid_angle() / angle, (h - h0) / (h1 - h0)), 0.0f, 1.0f);
    }

    /// In proportion to one over the distance of the corners that (0, 0), (1, 0), (0, 1), (1, 1) are mapped to.
    std::array<float, 4> closeness() const {
        const float r00 = distance(x0, y0), r10 = distance(x1, y0), r01 = distance(x0, y1), r11 = distance(x1, y1);
        const float low = r00 * r10, high = r01 * r11;
        return {r10 * high, r00 * high, low * r11, low * r01};
    }

private:
    float distance(float x, float y) const { return std::sqrt(x * x + y * y + z * z); }
};

}  // namespace rayuela
