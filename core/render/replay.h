#pragma once

#include "core/render/path_tracer.h"

#include <array>
#include <string>

namespace rayuela {

/// What a ray of a replayed path met, in words and numbers; a field is empty where there is nothing to say.
struct ReplayRow {
    int bounce = 0;
    std::string object;  ///< What it met, or what it was looking for.
    std::string t;       ///< Of the hit, along the ray.
    std::string point;   ///< In the scene's space.
    std::string error;   ///< Bound on the point, per component.
    std::string material;
    std::string throughput;  ///< On departure.
    std::string pdf;         ///< Density with which scattering chose the direction.
    std::string weight;      ///< Of light found so against light samples (multiple importance sampling).
    std::string light;       ///< Emitted there; of a light sample what it brings, weighed.
    std::string radiance;    ///< Found up to and with this bounce; on its last row.
    std::string ray;         ///< Origin and direction.
    std::string normal;      ///< Geometric, then shading, then uv.
};

/// The fields of a row in the order in which they are shown. Command line and window loop over it.
struct ReplayField {
    const char* name;
    std::string ReplayRow::*text;
    const char* tip;
};
inline constexpr std::array kReplayFields = {
    ReplayField{"object", &ReplayRow::object,
                "What the ray met, with the number of the triangle or face; or what a light sample aimed at."},
    ReplayField{"t", &ReplayRow::t, "Distance along the ray, as the accelerator found it."},
    ReplayField{"point", &ReplayRow::point, "The hit point in the scene's space."},
    ReplayField{"error bound", &ReplayRow::error,
                "Bound on the error of the point, per axis: the next ray starts beyond it, so that it cannot meet the "
                "surface it leaves."},
    ReplayField{"material", &ReplayRow::material, "Kind of the material there."},
    ReplayField{"throughput", &ReplayRow::throughput, "What light that the ray finds is multiplied with."},
    ReplayField{"pdf", &ReplayRow::pdf,
                "Density per solid angle with which scattering chose the ray's direction; delta: a camera, a mirror or "
                "clear glass, which leave no choice."},
    ReplayField{"MIS weight", &ReplayRow::weight,
                "Share of this way to find the light, where light samples find it too (power heuristic)."},
    ReplayField{
        "light", &ReplayRow::light,
        "Radiance emitted there; of a light sample what it brings to the pixel, weight and throughput included."},
    ReplayField{"radiance", &ReplayRow::radiance, "What the path has brought to the pixel so far."},
    ReplayField{"ray", &ReplayRow::ray, "Origin and direction."},
    ReplayField{"normal", &ReplayRow::normal, "Geometric normal, shading normal, texture coordinates."},
};

/// One sample of a film, traced again on its own: the same radiance to the last bit.
struct Replay {
    PathId id;
    std::vector<ReplayRow> rows;
    Color radiance{0};
};

/// id.pixel < width * height of the scene's film.
Replay replay(const RenderScene& scene, const PathId& id);

/// "(x y z)".
std::string to_text(const Vec3& v);
/// The rows, a line a field, then the sample.
std::string to_text(const Replay& replay);

}  // namespace rayuela
