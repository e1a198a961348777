#pragma once

#include "core/accel/accelerator.h"

#include <memory>
#include <span>
#include <vector>

namespace rayuela {

/// A hit point in world space, with what its shape says about the surface there.
struct SurfacePoint {
    Vec3 p{0};        ///< On the surface, independent of the rounding of Hit::t.
    Vec3 p_error{0};  ///< Absolute bound per component on the distance of p to the true surface; positive.
    Vec3 ng{0};       ///< Unit geometric normal of the front, see `Surfaces`.
    Vec3 ns{0};       ///< Unit shading normal: interpolated where a mesh has normals, else ng.
    Vec2 uv{0};       ///< See `Surfaces`.
};

/// The surfaces of a scene's instances, for the points where they were hit. Immutable.
///
/// The front is the outside of a sphere or box, the side the normal of a plane points to, the side from which a
/// triangle runs counter-clockwise and the side of u x v of a quad. Normals follow the inverse transpose, so that a
/// mirroring transform keeps the front where it was on the object (as glTF demands).
/// uv: texture coordinates of a mesh that has them, else barycentrics b1, b2; quad: along u and v; sphere: longitude from
/// +x towards -z over 2 pi and polar angle from +y over pi; box: position across the face in [0, 1]; plane: distances
/// along two tangents of unit length, in the plane's own space.
class Surfaces {
public:
    /// with_uv: one an instance, 0 where nobody will ask for uv; or none. A mesh then keeps its texture coordinates out of
    /// memory, and barycentrics stand for them; those of a sphere may be 0.
    explicit Surfaces(std::span<const GeometryInstance> instances, std::span<const std::uint8_t> with_uv = {});
    ~Surfaces();
    Surfaces(const Surfaces&) = delete;
    Surfaces& operator=(const Surfaces&) = delete;

    /// Derives the surface from a valid `hit` of `ray` with the instances. Nothing here depends on the acceleration
    /// structure. uv may be left at 0 where nobody asks for it.
    SurfacePoint point(const Ray& ray, const Hit& hit, bool with_uv = true) const;
    /// points[i] becomes `point` of rays[i] and hits[i] for all that are valid, to the last bit. with_uv: one a hit, or none
    /// where nobody asks for uv.
    void points(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const std::uint8_t> with_uv,
                std::span<SurfacePoint> points) const;
    /// Whether the shading normal is another than the geometric one anywhere.
    bool interpolate() const { return interpolate_; }
    std::uint64_t memory_bytes() const;
    /// Of transforms that nothing reads: the shape has been taken to the world once and for all.
    std::uint64_t bytes_left_out() const;

private:
    struct Tables;
    // kDetails: some hits may be of meshes or want uv; the other form does not look.
    template <bool kDetails>
    void points_of(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const std::uint8_t> with_uv,
                   std::span<SurfacePoint> points) const;
    const TriangleMesh* mesh_of(std::span<const Hit> hits, std::size_t i) const;
    void add_details(const Hit& hit, bool with_uv, SurfacePoint& point) const;
    /// Where in the tables an instance is.
    struct Entry {
        std::uint32_t kind, index;
        bool flat = false;          ///< Made of triangles, that are worked out many at once.
        bool sphere = false;        ///< So are these, unless uv are asked for.
        bool interpolates = false;  ///< The shading normal.
    };
    std::vector<Entry> entries_;
    std::unique_ptr<Tables> tables_;
    bool has_meshes_ = false, interpolate_ = false;
};

/// The same for a single hit.
SurfacePoint surface_point(std::span<const GeometryInstance> instances, const Ray& ray, const Hit& hit);

}  // namespace rayuela
