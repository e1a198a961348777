#include "core/render/reference_trace.h"

#include "core/math/float_error.h"

namespace rayuela {

namespace {

/// Share of a primitive by which it is taken larger than it is: rays that run exactly along an edge which primitives share
/// must not slip between them.
constexpr double kEdge = 0x1p-40;

struct Meeting {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t primitive = 0;

    void keep_closer(double other, std::uint32_t of = 0) {
        if (other >= 0 && other < t) *this = {other, of};
    }
};

/// Moeller & Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
double triangle_distance(const Vec3d& a, const Vec3d& b, const Vec3d& c, const RayD& ray) {
    const Vec3d e1 = b - a, e2 = c - a, p = glm::cross(ray.direction, e2), s = ray.origin - a, q = glm::cross(s, e1);
    const double determinant = glm::dot(e1, p);
    const double u = glm::dot(s, p) / determinant, v = glm::dot(ray.direction, q) / determinant;
    if (!(u >= -kEdge && v >= -kEdge && u + v <= 1 + kEdge)) return -1;
    return glm::dot(e2, q) / determinant;
}

/// The quadratic in long double, where a ground sphere seen from close by leaves digits to lose.
Meeting meet(const SphereD& sphere, const RayD& ray) {
    using Vec3l = glm::vec<3, long double>;
    const Vec3l d(ray.direction), o = Vec3l(ray.origin) - Vec3l(sphere.center);
    const long double a = glm::dot(d, d), b = glm::dot(o, d), r = sphere.radius, c = glm::dot(o, o) - r * r;
    const long double discriminant = b * b - a * c;
    Meeting first;
    if (!(discriminant >= 0)) return first;
    const long double q = -(b + std::copysign(std::sqrt(discriminant), b));
    first.keep_closer(static_cast<double>(q / a));
    if (q != 0) first.keep_closer(static_cast<double>(c / q));
    return first;
}

Meeting meet(const PlaneD& plane, const RayD& ray) {
    Meeting first;
    first.keep_closer(glm::dot(plane.normal, plane.point - ray.origin) / glm::dot(plane.normal, ray.direction));
    return first;
}

/// Each face on its own: the point on its plane must lie within it.
Meeting meet(const Box& box, const RayD& ray) {
    const Vec3d lo(box.min), hi(box.max), margin = kEdge * (hi - lo);
    Meeting first;
    for (int axis = 0; axis < 3; ++axis) {
        for (const bool max_side : {false, true}) {
            const double t = ((max_side ? hi : lo)[axis] - ray.origin[axis]) / ray.direction[axis];
            Vec3d p = ray.at(t);
            p[axis] = lo[axis];
            const bool within =
                glm::all(glm::greaterThanEqual(p, lo - margin)) && glm::all(glm::lessThanEqual(p, hi + margin));
            if (within) first.keep_closer(t, static_cast<std::uint32_t>(2 * axis + max_side));
        }
    }
    return first;
}

Meeting meet(const TriangleCorners& c, const RayD& ray) {
    Meeting first;
    first.keep_closer(triangle_distance(Vec3d(c[0]), Vec3d(c[1]), Vec3d(c[2]), ray));
    return first;
}

Meeting meet(const QuadCorners& c, const RayD& ray) {
    Meeting first;
    first.keep_closer(triangle_distance(Vec3d(c[0]), Vec3d(c[1]), Vec3d(c[2]), ray));
    first.keep_closer(triangle_distance(Vec3d(c[0]), Vec3d(c[2]), Vec3d(c[3]), ray));
    return first;
}

Meeting meet(const std::shared_ptr<const TriangleMesh>&, const RayD&) {
    return {};
}

/// Pixels from `low` up to and without `high`.
struct Rectangle {
    glm::ivec2 low{0}, high{0};
};

/// The image while primitives are being drawn into it.
class Raster {
public:
    Raster(const CameraRays& camera, const glm::ivec2& size)
        : camera_(camera),
          size_(size),
          pixels_per_unit_(std::sqrt(double(size.x) * size.y * double{camera.density(camera.forward())})) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                const Ray ray = camera.ray((Vec2(x, y) + 0.5f) / Vec2(size), Vec2(0));
                origin_ = Vec3d(ray.origin);
                directions_.push_back(ray.direction);
            }
        }
        hits.resize(directions_.size());
    }

    Rectangle whole() const { return {glm::ivec2(0), size_}; }

    /// Pixels that may see the convex hull of the points: none where it is behind the camera, all where it is on both sides.
    Rectangle around(std::span<const Vec3d> points) const {
        Vec3d low(INFINITY), high(-INFINITY);
        std::size_t behind = 0;
        for (const Vec3d& p : points) {
            const Vec3 rounded(p);
            const auto view = camera_.view(rounded, Vec2(0));
            const double depth = glm::dot(p - origin_, Vec3d(camera_.forward()));
            if (!view || !(depth > 0)) {
                ++behind;
                continue;
            }
            // Where the point may lie by its rounding to float, and a pixel more.
            const double shift = 2 * double{kUnitRoundoff} * double{max_component(glm::abs(rounded))} / depth;
            const Vec3d at(Vec2(size_) * view->position, 0), margin(1 + shift * pixels_per_unit_);
            low = glm::min(low, at - margin);
            high = glm::max(high, at + margin);
        }
        if (behind == points.size()) return {};
        if (behind > 0) return whole();
        const Vec3d limit(size_, 0);
        return {glm::ivec2(glm::clamp(glm::floor(low), Vec3d(0), limit)),
                glm::ivec2(glm::clamp(glm::ceil(high), Vec3d(0), limit))};
    }

    /// Calls meets(ray), a Meeting, for each pixel of the rectangle.
    template <typename Meets>
    void draw(const Rectangle& where, std::uint32_t object, const Meets& meets) {
        for (int y = where.low.y; y < where.high.y; ++y) {
            for (int x = where.low.x; x < where.high.x; ++x) {
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(x);
                const Meeting meeting = meets(RayD(origin_, Vec3d(directions_[i])));
                if (meeting.t < hits[i].t) hits[i] = {meeting.t, object, meeting.primitive};
            }
        }
    }

    std::vector<ReferenceHit> hits;

private:
    const CameraRays& camera_;
    glm::ivec2 size_;
    double pixels_per_unit_;  ///< At depth 1.
    Vec3d origin_{0};
    std::vector<Vec3> directions_;
};

using Corners = std::array<Vec3d, 8>;

Corners corners_of(const Vec3d& lo, const Vec3d& hi, const AffineD& to_world) {
    Corners corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        corners[i] = to_world.point({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
    return corners;
}

Rectangle around(const TracedObject& object, const AffineD& to_world, const Raster& raster) {
    if (const auto* sphere = std::get_if<SphereD>(&object.shape))
        return raster.around(corners_of(sphere->center - sphere->radius, sphere->center + sphere->radius, to_world));
    if (const auto* box = std::get_if<Box>(&object.shape))
        return raster.around(corners_of(Vec3d(box->min), Vec3d(box->max), to_world));
    if (const auto* triangle = std::get_if<TriangleCorners>(&object.shape))
        return raster.around(std::vector<Vec3d>(triangle->begin(), triangle->end()));
    if (const auto* quad = std::get_if<QuadCorners>(&object.shape))
        return raster.around(std::vector<Vec3d>(quad->begin(), quad->end()));
    return raster.whole();
}

void draw_mesh(const TriangleMesh& mesh, const AffineD& to_world, std::uint32_t object, Raster& raster,
               const std::atomic<bool>& cancelled) {
    const Rectangle all = raster.around(corners_of(Vec3d(mesh.bounds.lo), Vec3d(mesh.bounds.hi), to_world));
    if (all.low.x >= all.high.x || all.low.y >= all.high.y) return;
    for (std::uint32_t i = 0; i < mesh.triangles.size() && !cancelled; ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        const auto position = [&](std::uint32_t vertex) { return to_world.point(Vec3d(mesh.positions[vertex])); };
        const std::array<Vec3d, 3> c{position(t.x), position(t.y), position(t.z)};
        raster.draw(raster.around(c), object, [&](const RayD& ray) {
            Meeting first;
            first.keep_closer(triangle_distance(c[0], c[1], c[2], ray), i);
            return first;
        });
    }
}

Meeting meet_object(const TracedObject& object, const RayD& ray) {
    const RayD local = object.in_world ? ray : object.to_local.ray(ray);
    return std::visit([&](const auto& shape) { return meet(shape, local); }, object.shape);
}

}  // namespace

std::vector<ReferenceHit> reference_trace(std::span<const GeometryInstance> instances, const CameraRays& camera,
                                          const glm::ivec2& size, const std::atomic<bool>& cancelled) {
    Raster raster(camera, size);
    for (std::uint32_t i = 0; i < instances.size() && !cancelled; ++i) {
        const TracedObject object(instances[i]);
        const AffineD to_world = object.in_world ? AffineD() : AffineD(instances[i].to_world);
        if (const TriangleMesh* mesh = object.mesh()) {
            draw_mesh(*mesh, to_world, i, raster, cancelled);
        } else {
            raster.draw(around(object, to_world, raster), i, [&](const RayD& ray) { return meet_object(object, ray); });
        }
    }
    if (cancelled) return {};
    return std::move(raster.hits);
}

std::optional<double> reference_distance(const TracedObject& object, const RayD& ray) {
    const Meeting first = meet_object(object, ray);
    if (!std::isfinite(first.t)) return std::nullopt;
    return first.t;
}

}  // namespace rayuela
