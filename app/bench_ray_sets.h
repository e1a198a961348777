#pragma once

#include "app/bench_meshes.h"
#include "core/accel/accelerator.h"

#include <array>

namespace rayuela {

/// Rays as paths through a scene make them. Shadow rays ask only whether something is in the way.
enum class RayKind { primary, bounce, bounce_shuffled, shadow, shadow_from_bounce };

struct RaySet {
    RayKind kind;
    std::string_view name;
    std::vector<Ray> rays;

    bool any_hit() const { return kind == RayKind::shadow || kind == RayKind::shadow_from_bounce; }
    /// Whether neighbours go the same way.
    bool coherent() const { return kind == RayKind::primary || kind == RayKind::shadow; }
};

/// Camera rays of `side` x `side` pixels in blocks of 16 x 16 and squares of 4 x 4, as the renderer has them, diffuse bounces
/// and shadow rays from where they arrive.
std::vector<RaySet> make_ray_sets(const Accelerator& scene, const BenchMesh& view, int side);

}  // namespace rayuela
