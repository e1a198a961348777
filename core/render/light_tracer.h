#pragma once

#include "core/render/camera_rays.h"
#include "core/render/path_batch.h"
#include "core/render/render_scene.h"

#include <atomic>
#include <vector>

namespace rayuela {

class Interaction;

/// Light that a path from a lamp brings to a pixel.
struct Splat {
    std::uint32_t pixel = 0;
    Color radiance{0};
};

/// Paths from the lamps on their way; scratch memory kept from batch to batch.
struct LightBatch {
    struct State {
        Color power{1};
        float ratio = 0;  ///< See LightTracer.
        float reach = 0;  ///< Largest component of the power at the start.
        std::uint32_t path = 0;
    };
    std::vector<Splat> splats;  ///< The result.

    std::vector<Sampler> samplers;  ///< One a path.
    // One a path still on its way.
    std::vector<State> states;
    std::vector<Ray> rays;
    std::vector<Hit> hits;
    std::vector<SurfacePoint> points;
    std::vector<std::uint8_t> with_uv;  ///< Whether texture coordinates are asked for; empty where they never are.
    std::vector<Sampler> drawing;       ///< Samplers of the paths.
    std::vector<float> lamp_numbers, target_numbers, lobe_numbers;
    std::vector<Vec2> point_numbers, direction_numbers;
    // One a connection with the camera.
    std::vector<Ray> shadow_rays;
    std::vector<std::uint8_t> blocked;
    struct Connection {
        Vec2 position;  ///< In pixels.
        Color radiance;
    };
    std::vector<Connection> connections;

    RayCounts counts;  ///< Of all batches since the worker set them to 0; paths from lamps are not camera paths.
};

/// The caustics of small lamps: paths that leave a lamp towards a mirror or glass, and whose later points on rough surfaces
/// are connected with the camera ("particle tracing", Veach 1997, 10.1; aimed as Jensen's caustic photons are). Camera
/// paths find the same light by chance. Both are weighed by the balance heuristic; what that needs is carried along as
/// one number, the ratio of the densities with which lamp and camera make a path (as the recursive quantities of
/// Georgiev et al., "Light Transport Simulation with Vertex Connection and Merging", 2012, reduced to two techniques):
///
///     N p(lamp ray) / cos(lamp)  *  product over scattering points of  cos_l p(towards camera) / (cos_c p(towards lamp))
///
/// with 1 for delta lobes, and at the point that the camera sees, where the lamp's path ends, only cos_l / p(towards lamp),
/// over the density of the camera's samples per area. cos_l and cos_c: angles of the geometric normal with the directions
/// to lamp and camera. p: density with which that direction is drawn, seen from the other one.
class LightTracer {
public:
    /// For an image of width x height pixels. Keeps references.
    LightTracer(const RenderScene& scene, const CameraRays& camera, int width, int height);

    /// Whether camera paths leave as much to paths from lamps in one scene as in the other, but for rounding: then samples of
    /// the one and rounds of the other, however many of each, make up an image together.
    static bool shares_alike(const RenderScene& a, const RenderScene& b);

    /// Paths of a round, which is what goes with one sample in every pixel.
    std::uint32_t paths() const { return paths_; }
    /// Whether lamps are so small that camera paths hardly find them by way of a mirror or glass.
    bool lamps_are_small() const { return small_lamps_; }
    /// Traces `count` paths of the round from number `first` on; false, and no result, when `cancelled` became true.
    bool trace(std::uint32_t first, std::uint32_t count, std::uint32_t round, LightBatch& batch,
               const std::atomic<bool>& cancelled) const;

    /// Density per area at `at` of the camera's samples, all pixels together, along a ray of this unit direction.
    float camera_density(const Interaction& at, const Vec3& ray_direction, float distance) const;
    /// What the camera's ratio becomes when a path is scattered at `at` into `wi` with density `pdf`.
    static float scattered_ratio(float ratio, const Interaction& at, const Vec3& wi, const Vec3& wi_local, float pdf);
    /// Share of a camera path that has met a lamp at `at` after a delta lobe. `ratio`: of its scattering points.
    float camera_weight(float ratio, const Hit& hit, const Interaction& at) const;

private:
    void emit(std::uint32_t first, std::uint32_t count, std::uint32_t round, LightBatch& batch) const;
    void surface_points(LightBatch& batch) const;
    void draw_numbers(LightBatch& batch, int depth) const;
    void shade(LightBatch& batch, int depth) const;
    void connect(LightBatch& batch, const LightBatch::State& state, const Interaction& at, int depth) const;
    bool scatter(const LightBatch& batch, LightBatch::State& state, Ray& ray, const Interaction& at,
                 const ScatterNumbers& numbers, int depth) const;
    void splat_unblocked(LightBatch& batch) const;

    const RenderScene& scene_;
    const CameraRays& camera_;
    int width_, height_;
    bool small_lamps_;
    std::uint32_t paths_;
    float pixels_;
};

}  // namespace rayuela
