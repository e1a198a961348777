#pragma once

#include "core/render/path_record.h"
#include "core/render/render_scene.h"

#include <functional>

namespace rayuela {

/// What goes wrong on the ways of light, counted on a number of paths and draws. On demand: the renderer itself does not count,
/// because its rays start beyond their error bounds and need no test.
struct PathHealth {
    std::uint64_t paths = 0;
    std::uint64_t scattered_rays = 0;  ///< That left a surface.
    /// Of these, rays that met the primitive they left: a flat one, or a sphere that they left to the outside.
    std::uint64_t self_hits = 0;
    std::uint64_t inner_rays = 0;   ///< That set off into a sphere or box.
    std::uint64_t left_closed = 0;  ///< Of these, rays that met nothing up to its surface nor the surface itself.

    std::uint64_t draws = 0;        ///< Directions drawn from the scene's materials.
    std::uint64_t without_pdf = 0;  ///< Of these, left out: under the surface, or a density of 0, infinity or NaN.
    std::uint64_t energy_tests =
        0;  ///< Pairs of a material and a direction, of which the mean reflected share was measured.
    std::uint64_t above_one = 0;  ///< Of these, more than 1 by more than four standard errors.
    float highest_share = 0;      ///< Of all pairs; may exceed 1 by chance.
};

/// Counts draws of directions, each from three numbers in [0, 1): draw(u_lobe, u).
using DrawDirection = std::function<std::optional<BsdfSample>(float, const Vec2&)>;
void count_draws(const DrawDirection& draw, PathHealth& health);

/// Counts the ray from one vertex of a path to the next.
void count_ray(std::span<const GeometryInstance> instances, const PathRecord::Vertex& from,
               const PathRecord::Vertex& to, PathHealth& health);

/// Follows sample 0, 1, ... of `paths` pixels spread over the film and draws from each material that scatters, seen under
/// several angles from both sides where light passes. Textured materials are taken at the middle of their texture.
/// What has been counted so far when `cancelled` became true.
PathHealth measure_path_health(const RenderScene& scene, std::uint32_t paths, const std::atomic<bool>& cancelled);

}  // namespace rayuela
