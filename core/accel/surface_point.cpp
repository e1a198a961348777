#include "core/accel/surface_point.h"

#include "core/accel/sphere_points.h"
#include "core/accel/surface_rounding.h"
#include "core/accel/traced_object.h"

#include <numbers>
#include <tuple>

namespace rayuela {
namespace {

/// Surface in a space in which it is known exactly to double, before it is rounded to world floats.
struct Surface {
    Vec3d p{0};
    double size = 0;  ///< Extent of the numbers that p was made from; its error in double is a fraction of this.
    Vec3 ng{0};
    Vec3 ns{0};  ///< Zero: as ng.
    Vec2 uv{0};
};

double max_abs(const Vec3d& v) {
    return glm::max(std::fabs(v.x), glm::max(std::fabs(v.y), std::fabs(v.z)));
}

Vec3 unit(const Vec3d& v) {
    return Vec3(glm::normalize(v));
}

/// How far a point at `p` is kept from the edges of its surface: so far that rounding to float does not take it beyond a
/// wall that meets the surface there, and lets light into a sealed room.
double margin_at(const Vec3d& p) {
    return 3 * double{kUnitRoundoff} * max_abs(p);
}

/// The way from a shape's own space to the world and back. Points and normals of a shape that has been taken to the world
/// once and for all need no way, and what it is made of is read for texture coordinates alone.
class Placement {
public:
    Placement(const Affine& to_world, bool shape_in_world)
        : in_world_(shape_in_world), way_(std::make_unique<const Way>(AffineD(to_world))) {}

    bool in_world() const { return in_world_; }
    const AffineD& to_world() const { return way_->to_world; }
    const AffineD& to_local() const { return way_->to_local; }
    RayD ray(const Ray& world) const { return in_world_ ? RayD(world) : to_local().ray(RayD(world)); }
    Vec3d point(const Vec3d& p) const { return in_world_ ? p : to_world().point(p); }
    Vec3d normal(const Vec3d& n) const { return in_world_ ? n : way_->normals * n; }

private:
    struct Way {
        AffineD to_world, to_local;
        glm::dmat3 normals;  ///< The inverse transpose of to_world, up to a positive factor.

        explicit Way(const AffineD& affine) : to_world(affine), to_local(affine.inverse()) {
            const glm::dmat3& m = affine.linear;
            normals = glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
            if (glm::determinant(m) < 0) normals = -normals;
        }
    };

    bool in_world_;
    std::unique_ptr<const Way> way_;
};

/// A shape ready to tell the surface where it was hit. Specialised for each alternative of TracedShape.
template <typename Shape>
struct SurfaceOf;

template <>
struct SurfaceOf<Sphere> {
    Placement placement;
    SphereD sphere;

    SurfaceOf(const Sphere& own, const Affine& to_world)
        : placement(to_world, world_sphere(own, to_world).has_value()),
          sphere(world_sphere(own, to_world).value_or(SphereD{Vec3d(own.center), own.radius})) {}

    Surface at(const Ray& ray, const Hit& hit, bool with_uv) const {
        // Down to the surface from a point close to it: from the centre up, a ground of large radius would lose digits.
        const Vec3d along = placement.ray(ray).at(hit.t);
        const double distance = glm::length(along - sphere.center);
        const Vec3d n = (along - sphere.center) / distance;
        const double height = squared_distance_excess(along, sphere.center, sphere.radius) / (distance + sphere.radius);
        const Vec3d p = along - height * n;

        Surface surface;
        surface.p = placement.point(p);
        surface.ng = unit(placement.normal(n));
        surface.size = max_abs(surface.p);
        if (!placement.in_world())
            surface.size += max_abs(placement.to_world().translation) + max_abs(placement.to_world().vector(p));
        if (with_uv) surface.uv = uv(n);
        return surface;
    }

    Vec2 uv(const Vec3d& n) const {
        const Vec3d own = glm::normalize(placement.in_world() ? glm::transpose(placement.to_world().linear) * n : n);
        const double longitude = std::atan2(-own.z, own.x) * (0.5 * std::numbers::inv_pi);
        const double polar = std::acos(glm::clamp(own.y, -1.0, 1.0)) * std::numbers::inv_pi;
        return Vec2(longitude < 0 ? longitude + 1 : longitude, polar);
    }
};

template <>
struct SurfaceOf<Plane> {
    Placement placement;
    PlaneD plane;  ///< Unit normal.
    Vec3d own_point, s, t;

    SurfaceOf(const Plane& own, const Affine& to_world)
        : placement(to_world, to_world.is_identity()), plane(world_plane(own, to_world)), own_point(own.point) {
        plane.normal = glm::normalize(plane.normal);
        const Vec3d normal = glm::normalize(Vec3d(own.normal));
        const Vec3d axis = std::fabs(normal.y) > 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        s = glm::normalize(axis - glm::dot(axis, normal) * normal);
        t = glm::cross(normal, s);
    }

    Surface at(const Ray& ray, const Hit& hit, bool) const {
        const Vec3d along = RayD(ray).at(hit.t);
        Surface surface;
        surface.p = along - glm::dot(plane.normal, along - plane.point) * plane.normal;
        surface.ng = Vec3(plane.normal);
        surface.size = max_abs(along) + max_abs(plane.point);
        const Vec3d own = (placement.in_world() ? surface.p : placement.to_local().point(surface.p)) - own_point;
        surface.uv = Vec2(glm::dot(own, s), glm::dot(own, t));
        return surface;
    }
};

template <>
struct SurfaceOf<Box> {
    Placement placement;
    Vec3d lo, hi;
    Vec3d scale{1};  ///< A step along an axis of the box is so long in the world.

    SurfaceOf(const Box& own, const Affine& to_world) : placement(to_world, world_box(own, to_world).has_value()) {
        const Box box = world_box(own, to_world).value_or(own);
        lo = Vec3d(box.min);
        hi = Vec3d(box.max);
        if (placement.in_world()) return;
        for (int axis = 0; axis < 3; ++axis) scale[axis] = glm::length(placement.to_world().linear[axis]);
    }

    Surface at(const Ray& ray, const Hit& hit, bool) const {
        const int axis = static_cast<int>(hit.primitive / 2);
        const bool max_side = hit.primitive % 2 == 1;
        Vec3d p = placement.ray(ray).at(hit.t);
        const double margin = margin_at(RayD(ray).at(hit.t));
        for (int k = 0; k < 3; ++k) {
            const double inward = glm::min(margin / scale[k], 0.5 * (hi[k] - lo[k]));
            p[k] = glm::clamp(p[k], lo[k] + inward, hi[k] - inward);
        }
        p[axis] = max_side ? hi[axis] : lo[axis];
        Vec3d n(0);
        n[axis] = max_side ? 1 : -1;

        Surface surface;
        surface.p = placement.point(p);
        surface.ng = unit(placement.normal(n));
        surface.size = max_abs(surface.p) + max_abs(placement.to_world().translation) +
                       max_abs(placement.in_world() ? p : placement.to_world().vector(p));
        const auto across = [&](int k) { return hi[k] > lo[k] ? (p[k] - lo[k]) / (hi[k] - lo[k]) : 0.0; };
        surface.uv = Vec2(across((axis + 1) % 3), across((axis + 2) % 3));
        return surface;
    }
};

/// A triangle in the world.
struct Flat {
    Vec3d a, e1, e2;
    double extent, size;

    Flat(const Vec3d& corner, const Vec3d& b, const Vec3d& c)
        : a(corner),
          e1(b - a),
          e2(c - a),
          extent(glm::max(max_abs(e1), max_abs(e2))),
          size(max_abs(a) + max_abs(b) + max_abs(c)) {}

    /// With positive `sign` counter-clockwise seen from the front.
    Vec3d normal(double sign) const { return sign * glm::cross(e1, e2); }
    /// Moved towards the centroid by as much as the margin asks for in a triangle whose height is an eighth of its extent.
    Vec3d point(double b1, double b2) const {
        const double inward = glm::min(1.0, 24 * margin_at(a + b1 * e1 + b2 * e2) / extent);
        return a + glm::mix(b1, 1.0 / 3, inward) * e1 + glm::mix(b2, 1.0 / 3, inward) * e2;
    }
};

/// Corners are taken to the world, and a transform that mirrors turns them round.
double front_sign(const Affine& to_world) {
    return glm::determinant(glm::dmat3(to_world.linear)) < 0 ? -1 : 1;
}

template <>
struct SurfaceOf<Triangle> {
    Flat flat;
    Vec3 ng;

    SurfaceOf(const TriangleCorners& c, double sign)
        : flat(Vec3d(c[0]), Vec3d(c[1]), Vec3d(c[2])), ng(unit(flat.normal(sign))) {}
    SurfaceOf(const Triangle& own, const Affine& to_world)
        : SurfaceOf(world_triangle(own, to_world), front_sign(to_world)) {}

    Surface at(const Ray&, const Hit& hit, bool) const {
        return {.p = flat.point(hit.u, hit.v), .size = flat.size, .ng = ng, .uv = Vec2(hit.u, hit.v)};
    }
};

/// The half that was hit decides the plane: rounded corners need not lie in one.
template <>
struct SurfaceOf<Quad> {
    SurfaceOf<Triangle> first, second;

    SurfaceOf(const QuadCorners& c, double sign) : first({c[0], c[1], c[2]}, sign), second({c[0], c[2], c[3]}, sign) {}
    SurfaceOf(const Quad& own, const Affine& to_world) : SurfaceOf(world_quad(own, to_world), front_sign(to_world)) {}

    Surface at(const Ray&, const Hit& hit, bool) const {
        const double u = hit.u, v = hit.v;
        const bool in_first = u >= v;
        const SurfaceOf<Triangle>& half = in_first ? first : second;
        return {.p = in_first ? half.flat.point(u - v, v) : half.flat.point(u, v - u),
                .size = half.flat.size,
                .ng = half.ng,
                .uv = Vec2(hit.u, hit.v)};
    }
};

template <>
struct SurfaceOf<std::shared_ptr<const TriangleMesh>> {
    Placement placement;
    std::shared_ptr<const TriangleMesh> mesh;
    double sign, offset;

    SurfaceOf(std::shared_ptr<const TriangleMesh> own, const Affine& to_world)
        : placement(to_world, to_world.is_identity()),
          mesh(std::move(own)),
          sign(front_sign(to_world)),
          offset(max_abs(Vec3d(to_world.translation))) {}

    Surface at(const Ray&, const Hit& hit, bool with_uv) const {
        const glm::uvec3 t = mesh->triangles[hit.primitive];
        const auto corner = [&](std::uint32_t i) { return placement.point(Vec3d(mesh->positions[i])); };
        const Flat flat(corner(t.x), corner(t.y), corner(t.z));
        Surface surface{.p = flat.point(hit.u, hit.v), .size = flat.size + offset, .ng = unit(flat.normal(sign))};
        if (!mesh->normals.empty()) surface.ns = shading_normal(t, hit);
        if (with_uv) surface.uv = uv(t, hit);
        return surface;
    }

    /// Zero where the interpolated normal has no direction.
    Vec3 shading_normal(const glm::uvec3& t, const Hit& hit) const {
        const double b1 = hit.u, b2 = hit.v;
        const auto normal = [&](std::uint32_t i) { return Vec3d(mesh->normals[i]); };
        const Vec3d n = placement.normal((1 - b1 - b2) * normal(t.x) + b1 * normal(t.y) + b2 * normal(t.z));
        const double length = glm::length(n);
        return length > 0 && std::isfinite(length) ? Vec3(n / length) : Vec3(0);
    }
    Vec2 uv(const glm::uvec3& t, const Hit& hit) const {
        if (mesh->uvs.empty()) return {hit.u, hit.v};
        const auto b0 = static_cast<float>(1 - double{hit.u} - double{hit.v});
        return b0 * mesh->uvs[t.x] + hit.u * mesh->uvs[t.y] + hit.v * mesh->uvs[t.z];
    }
};

template <typename List>
struct SurfacesOf;
template <typename... Shapes>
struct SurfacesOf<std::variant<Shapes...>> {
    using type = std::tuple<std::vector<SurfaceOf<Shapes>>...>;
};

constexpr std::size_t kMeshKind = std::variant_size_v<TracedShape> - 1;
static_assert(std::is_same_v<std::variant_alternative_t<kMeshKind, TracedShape>, std::shared_ptr<const TriangleMesh>>);

SurfacePoint rounded(const Surface& surface) {
    SurfacePoint point;
    point.p = Vec3(surface.p);
    point.p_error =
        Vec3(glm::abs(surface.p) * kSurfaceRounding + (kSurfaceDoubleError * surface.size + kSurfaceSmallestError));
    point.ng = surface.ng;
    point.ns = surface.ns == Vec3(0) ? surface.ng : surface.ns;
    point.uv = surface.uv;
    return point;
}

}  // namespace

struct Surfaces::Tables {
    /// Those of each kind of shape side by side.
    SurfacesOf<TracedShape>::type kinds;
    std::vector<SphereD> spheres;  ///< Those of the first kind again.

    /// The surface of the kind, one of the alternatives of TracedShape, with the index.
    template <std::size_t kKind = 0>
    Surface at(const Entry& entry, const Ray& ray, const Hit& hit, bool with_uv) const {
        if (entry.kind == kKind) return std::get<kKind>(kinds)[entry.index].at(ray, hit, with_uv);
        if constexpr (kKind + 1 < std::variant_size_v<TracedShape>) return at<kKind + 1>(entry, ray, hit, with_uv);
        return {};
    }
};

Surfaces::Surfaces(std::span<const GeometryInstance> instances) : tables_(std::make_unique<Tables>()) {
    entries_.reserve(instances.size());
    for (const GeometryInstance& instance : instances) {
        std::visit(
            [&]<typename Shape>(const Shape& shape) {
                auto& table = std::get<std::vector<SurfaceOf<Shape>>>(tables_->kinds);
                entries_.push_back({static_cast<std::uint32_t>(instance.shape.index()),
                                    static_cast<std::uint32_t>(table.size()), false});
                table.emplace_back(shape, instance.to_world);
                has_meshes_ |= instance.shape.index() == kMeshKind;
                if constexpr (std::is_same_v<Shape, Sphere>) {
                    tables_->spheres.push_back(table.back().sphere);
                    entries_.back().together = table.back().placement.in_world();
                }
            },
            instance.shape);
    }
}

Surfaces::~Surfaces() = default;

/// Null for other shapes.
const TriangleMesh* Surfaces::mesh_of(const Hit& hit) const {
    if (!hit.valid() || entries_[hit.object].kind != kMeshKind) return nullptr;
    return std::get<kMeshKind>(tables_->kinds)[entries_[hit.object].index].mesh.get();
}

/// The vertices can be asked for only once the triangle is there.
void Surfaces::prefetch_meshes(std::span<const Hit> hits, std::size_t i) const {
    constexpr std::size_t kTriangle = 8, kVertices = 4;
    if (i + kTriangle >= hits.size()) return;
    if (const TriangleMesh* mesh = mesh_of(hits[i + kTriangle]))
        __builtin_prefetch(&mesh->triangles[hits[i + kTriangle].primitive]);
    const TriangleMesh* mesh = mesh_of(hits[i + kVertices]);
    if (!mesh) return;
    const glm::uvec3 t = mesh->triangles[hits[i + kVertices].primitive];
    for (int corner = 0; corner < 3; ++corner) {
        __builtin_prefetch(&mesh->positions[t[corner]]);
        if (!mesh->normals.empty()) __builtin_prefetch(&mesh->normals[t[corner]]);
    }
}

SurfacePoint Surfaces::point(const Ray& ray, const Hit& hit, bool with_uv) const {
    return rounded(tables_->at(entries_[hit.object], ray, hit, with_uv));
}

void Surfaces::points(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const std::uint8_t> with_uv,
                      std::span<SurfacePoint> points) const {
    constexpr std::size_t kTogether = 64;
    SphereHit spheres[kTogether];
    std::size_t count = 0;
    const auto finish_spheres = [&] {
        sphere_points(tables_->spheres, std::span(spheres, count), rays, hits, points);
        count = 0;
    };
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (has_meshes_) prefetch_meshes(hits, i);
        if (!hits[i].valid()) continue;
        const Entry& entry = entries_[hits[i].object];
        const bool uv = !with_uv.empty() && with_uv[i] != 0;
        if (entry.together && !uv) {
            spheres[count++] = {static_cast<std::uint32_t>(i), entry.index};
            if (count == kTogether) finish_spheres();
        } else {
            points[i] = point(rays[i], hits[i], uv);
        }
    }
    finish_spheres();
}

std::uint64_t Surfaces::memory_bytes() const {
    const auto bytes = [](const auto&... table) {
        return (std::uint64_t{0} + ... + (table.capacity() * sizeof(table[0])));
    };
    return entries_.capacity() * sizeof(Entry) + bytes(tables_->spheres) + std::apply(bytes, tables_->kinds);
}

SurfacePoint surface_point(std::span<const GeometryInstance> instances, const Ray& ray, const Hit& hit) {
    Hit only = hit;
    only.object = 0;
    return Surfaces(instances.subspan(hit.object, 1)).point(ray, only);
}

}  // namespace rayuela
