#pragma once

#include "core/render/camera_rays.h"
#include "core/render/light_tracer.h"
#include "core/render/passing_rays.h"
#include "core/render/path_batch.h"
#include "core/render/path_record.h"
#include "core/render/render_scene.h"
#include "core/render/shortcuts.h"

#include <atomic>
#include <optional>

namespace rayuela {

class AimedBsdf;
class Interaction;

/// Parts of the algorithm that can be left out; the expected image is the same. For tests and benchmarks.
struct PathTracerOptions {
    bool light_sampling = true;  ///< Else light is found by scattered rays alone.
    bool mis = true;             ///< Else light that can be sampled counts by its samples alone, after smooth lobes.
    bool russian_roulette = true;
    bool light_tracing = true;  ///< Else caustics are found by camera paths alone, and by chance. Needs light_sampling.
    Shortcuts shortcuts;        ///< But for few_objects, which the render scene heeds.
};

/// Unidirectional path tracing with light sampling (Kajiya 1986; combined by multiple importance sampling, Veach & Guibas
/// 1995), many paths at once, stage by stage. What a path finds depends on its PathId alone. Immutable.
class PathTracer {
public:
    /// Of an image of width x height pixels that shows what the scene's film does. Keeps a reference to `scene`.
    PathTracer(const RenderScene& scene, int width, int height, const PathTracerOptions& options = {});
    PathTracer(const PathTracer&) = delete;
    PathTracer& operator=(const PathTracer&) = delete;

    /// Traces the paths named by batch.ids; fills batch.radiance and batch.first_object. False, and no result, when
    /// `cancelled` became true on the way. `record`, where given, is told what a batch of one path does.
    bool trace(PathBatch& batch, const std::atomic<bool>& cancelled, PathRecord* record = nullptr) const;

    /// What has to be traced beside the camera paths; null where there is nothing.
    const LightTracer* light_tracer() const { return light_tracer_ ? &*light_tracer_ : nullptr; }

    /// ObjectId::value of the object that a Hit::object belongs to; 0 for kNone.
    std::uint32_t object_id(std::uint32_t hit_object) const {
        return hit_object == kNone ? 0 : scene_.object_id(hit_object).value;
    }

private:
    // kVaries: materials may have to be worked out at their hits; the other form of a stage does not look.
    template <bool kVaries>
    bool trace_as(PathBatch& batch, const std::atomic<bool>& cancelled, PathRecord* record) const;
    void camera_rays(PathBatch& batch) const;
    void draw_lens(PathBatch& batch) const;
    void end_passing_rays(PathBatch& batch) const;
    void intersect(PathBatch& batch) const;
    template <bool kVaries>
    void surface_interactions(PathBatch& batch) const;
    template <bool kVaries>
    void shade(PathBatch& batch, int bounce) const;
    void add_unblocked_light(PathBatch& batch) const;
    void add_parts(PathBatch& batch) const;

    void leave(PathBatch& batch, const PathState& state, const Vec3& direction) const;
    Color environment_light(const PathState& state, const Vec3& direction) const;
    Color emitted_light(const PathState& state, const Ray& ray, const Hit& hit, const Interaction& at) const;
    void add_surface(PathBatch& batch, std::size_t i, const PackedMaterial& material, bool varies) const;
    void shade_surfaces(PathBatch& batch, int bounce, bool last) const;
    void draw_numbers(PathBatch& batch, int bounce) const;
    bool aims(const PathState& state, int bounce) const;
    void add_light(PathBatch& batch, const PathState& state, const Interaction& at, const AimedBsdf& bsdf,
                   const LightSample& light) const;
    void split(PathBatch& batch, const PathState& state, const Ray& ray, const Interaction& at, const AimedBsdf& bsdf,
               int bounce) const;
    void scatter(PathBatch& batch, const PathState& state, const Ray& ray, const Interaction& at, const AimedBsdf& bsdf,
                 const ScatterNumbers& numbers, int bounce) const;
    template <bool kVaries>
    bool varies(const PackedMaterial& material) const;
    bool in_block(const PathState& state, const PackedMaterial& material, int bounce) const;
    void add_to_block(PathBatch& batch, std::size_t i, const PackedBsdf& lobe, int bounce) const;
    void add_copy_to_block(PathBatch& batch, std::size_t i, const PackedBsdf& lobe, int bounce) const;
    void shade_block(PathBatch& batch, PackedBsdf::Kind kind, int bounce) const;
    void find_light_ratios(PathBatch& batch, const LobeBlock& block, PackedBsdf::Kind kind, int bounce,
                           std::size_t to) const;
    LobeTask lobe_task(PackedBsdf::Kind kind, int bounce) const;
    int roulette_start(bool specular) const;
    float light_ratio(const PathState& state, const Ray& ray, const Interaction& at, const Vec3& wi,
                      const BsdfSample& sample, int bounce) const;
    float scattering_weight(float bsdf_pdf, float light_pdf) const;

    const RenderScene& scene_;
    int width_, height_;
    PathTracerOptions options_;
    CameraRays camera_;
    PassingRays passing_rays_;
    std::uint32_t parts_seed_;
    int rr_start_;
    bool light_sampling_;
    bool sees_sky_;              ///< Rays that leave the scene look up the environment.
    bool may_aim_ = false;       ///< All caustics are left to some of the paths.
    float roulette_throughput_;  ///< Below it paths may be cut, but for those that caustics are left to.
    std::optional<LightTracer> light_tracer_;
};

/// Replays one sample of the scene's film: the same stages on a batch of one, the same radiance to the last bit. What the
/// paths of the light tracer bring to the pixel is not part of any sample.
Color trace_one(const RenderScene& scene, const PathId& id, const PathTracerOptions& options = {},
                PathRecord* record = nullptr);

}  // namespace rayuela
