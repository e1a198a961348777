#include "core/accel/surface_point.h"

#include "core/accel/flat_points.h"
#include "core/accel/sphere_points.h"
#include "core/accel/surface_of.h"

#include <tuple>

namespace rayuela {
namespace {

template <typename List>
struct SurfacesOf;
template <typename... Shapes>
struct SurfacesOf<std::variant<Shapes...>> {
    using type = std::tuple<std::vector<SurfaceOf<Shapes>>...>;
};

constexpr std::size_t kMeshKind = std::variant_size_v<TracedShape> - 1;
static_assert(std::is_same_v<std::variant_alternative_t<kMeshKind, TracedShape>, std::shared_ptr<const TriangleMesh>>);

template <typename Of>
constexpr bool kFlat = requires(const Of& surface, const Hit& hit) {
    surface.flat(hit);
};

void write_rounded(const Surface& surface, SurfacePoint& point) {
    point.p = Vec3(surface.p);
    point.p_error =
        Vec3(glm::abs(surface.p) * kSurfaceRounding + (kSurfaceDoubleError * surface.size + kSurfaceSmallestError));
    point.ng = surface.ng;
    point.ns = surface.ng;
    point.uv = surface.uv;
}

}  // namespace

struct Surfaces::Tables {
    /// Those of each kind of shape side by side.
    SurfacesOf<TracedShape>::type kinds;
    std::vector<SphereD> spheres;  ///< Those of the first kind again.

    /// What `function` says of the surface of the kind, one of the alternatives of TracedShape, with the index.
    template <std::size_t kKind = 0, typename Function>
    void with(const Entry& entry, Function&& function) const {
        if (entry.kind == kKind) return function(std::get<kKind>(kinds)[entry.index]);
        if constexpr (kKind + 1 < std::variant_size_v<TracedShape>) with<kKind + 1>(entry, function);
    }
};

Surfaces::Surfaces(std::span<const GeometryInstance> instances, std::span<const std::uint8_t> with_uv)
    : tables_(std::make_unique<Tables>()) {
    entries_.reserve(instances.size());
    for (const GeometryInstance& instance : instances) {
        std::visit(
            [&]<typename Shape>(const Shape& shape) {
                auto& table = std::get<std::vector<SurfaceOf<Shape>>>(tables_->kinds);
                entries_.push_back({.kind = static_cast<std::uint32_t>(instance.shape.index()),
                                    .index = static_cast<std::uint32_t>(table.size())});
                const bool uv = with_uv.empty() || with_uv[entries_.size() - 1] != 0;
                if constexpr (std::is_constructible_v<SurfaceOf<Shape>, const Shape&, const Affine&, bool>) {
                    table.emplace_back(shape, instance.to_world, uv);
                } else {
                    table.emplace_back(shape, instance.to_world);
                }
                if constexpr (std::is_same_v<Shape, std::shared_ptr<const TriangleMesh>>)
                    entries_.back().interpolates = !shape->normals.empty();
                entries_.back().flat = kFlat<SurfaceOf<Shape>>;
                interpolate_ |= entries_.back().interpolates;
                has_meshes_ |= instance.shape.index() == kMeshKind;
                if constexpr (std::is_same_v<Shape, Sphere>) {
                    tables_->spheres.push_back(table.back().sphere);
                    entries_.back().sphere = table.back().placement.in_world();
                }
            },
            instance.shape);
    }
}

Surfaces::~Surfaces() = default;

/// The mesh that hit number i is of; null for other shapes and where there is no such hit.
const TriangleMesh* Surfaces::mesh_of(std::span<const Hit> hits, std::size_t i) const {
    if (i >= hits.size() || !hits[i].valid() || entries_[hits[i].object].kind != kMeshKind) return nullptr;
    return std::get<kMeshKind>(tables_->kinds)[entries_[hits[i].object].index].mesh.get();
}

SurfacePoint Surfaces::point(const Ray& ray, const Hit& hit, bool with_uv) const {
    SurfacePoint point;
    tables_->with(entries_[hit.object], [&]<typename Of>(const Of& surface) {
        if constexpr (kFlat<Of>) {
            write_rounded(flat_surface(surface.flat(hit)), point);
        } else {
            write_rounded(surface.at(ray, hit, with_uv), point);
        }
    });
    add_details(hit, with_uv, point);
    return point;
}

/// What `flat_surface` leaves out.
void Surfaces::add_details(const Hit& hit, bool with_uv, SurfacePoint& point) const {
    tables_->with(entries_[hit.object], [&]<typename Of>(const Of& surface) {
        if constexpr (kFlat<Of>) {
            const Vec3 ns = surface.shading_normal(hit);
            if (ns != Vec3(0)) point.ns = ns;
            if (with_uv) point.uv = surface.uv(hit);
        }
    });
}

void Surfaces::points(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const std::uint8_t> with_uv,
                      std::span<SurfacePoint> points) const {
    has_meshes_ || !with_uv.empty() ? points_of<true>(rays, hits, with_uv, points)
                                    : points_of<false>(rays, hits, with_uv, points);
}

template <bool kDetails>
void Surfaces::points_of(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const std::uint8_t> with_uv,
                         std::span<SurfacePoint> points) const {
    SphereHit spheres[FlatBlock::kSize];
    std::size_t sphere_count = 0;
    FlatBlock flats;
    const auto wants_uv = [&](std::size_t i) { return kDetails && !with_uv.empty() && with_uv[i] != 0; };
    const auto finish_spheres = [&] {
        sphere_points(tables_->spheres, std::span(spheres, sphere_count), rays, hits, points);
        sphere_count = 0;
    };
    const auto finish_flats = [&] {
        flat_points(flats, points);
        for (std::size_t k = 0; kDetails && k < flats.size; ++k) {
            const std::uint32_t i = flats.ray[k];
            if (wants_uv(i) || entries_[hits[i].object].interpolates) add_details(hits[i], wants_uv(i), points[i]);
        }
        flats.size = 0;
    };
    // Triangles of meshes are asked for ahead, and their vertices once these are there. Not in a function of its own: as it
    // would change nothing, the compiler would leave it out.
    constexpr std::size_t kTriangle = 16, kVertices = 8;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (kDetails && has_meshes_) {
            if (const TriangleMesh* mesh = mesh_of(hits, i + kTriangle))
                __builtin_prefetch(&mesh->triangles[hits[i + kTriangle].primitive]);
            if (const TriangleMesh* mesh = mesh_of(hits, i + kVertices)) {
                const glm::uvec3& t = mesh->triangles[hits[i + kVertices].primitive];
                for (int corner = 0; corner < 3; ++corner) {
                    __builtin_prefetch(&mesh->positions[t[corner]]);
                    if (!mesh->normals.empty()) __builtin_prefetch(&mesh->normals[t[corner]]);
                }
            }
        }
        if (!hits[i].valid()) continue;
        const Entry& entry = entries_[hits[i].object];
        if (entry.flat) {
            tables_->with(entry, [&]<typename Of>(const Of& surface) {
                if constexpr (kFlat<Of>) flats.push(surface.flat(hits[i]), i);
            });
            if (flats.size == FlatBlock::kSize) finish_flats();
        } else if (entry.sphere && !wants_uv(i)) {
            spheres[sphere_count++] = {static_cast<std::uint32_t>(i), entry.index};
            if (sphere_count == std::size(spheres)) finish_spheres();
        } else {
            tables_->with(entry, [&]<typename Of>(const Of& surface) {
                if constexpr (!kFlat<Of>) write_rounded(surface.at(rays[i], hits[i], wants_uv(i)), points[i]);
            });
        }
    }
    finish_flats();
    finish_spheres();
}

namespace {

/// Of the surfaces, those that have a way between spaces, and those that do without.
template <typename Of>
std::array<std::uint64_t, 2> ways(const std::vector<Of>& surfaces) {
    std::array<std::uint64_t, 2> count{};
    if constexpr (requires(const Of& surface) { surface.placement; }) {
        for (const Of& surface : surfaces) ++count[surface.placement.has_way() ? 0 : 1];
    }
    return count;
}

}  // namespace

std::uint64_t Surfaces::memory_bytes() const {
    const auto bytes = [](const auto&... table) {
        return (std::uint64_t{0} + ... +
                (table.capacity() * sizeof(table[0]) + ways(table)[0] * Placement::way_bytes()));
    };
    return entries_.capacity() * sizeof(Entry) + bytes(tables_->spheres) + std::apply(bytes, tables_->kinds);
}

std::uint64_t Surfaces::bytes_left_out() const {
    const auto bytes = [](const auto&... table) {
        return (std::uint64_t{0} + ... + (ways(table)[1] * Placement::way_bytes()));
    };
    return std::apply(bytes, tables_->kinds);
}

SurfacePoint surface_point(std::span<const GeometryInstance> instances, const Ray& ray, const Hit& hit) {
    Hit only = hit;
    only.object = 0;
    return Surfaces(instances.subspan(hit.object, 1)).point(ray, only);
}

}  // namespace rayuela
