#pragma once

#include "core/render/path_tracer.h"
#include "tests/render_testing.h"
#include "tests/stress/stress.h"

namespace rayuela::stress {

/// Traces `count` paths of the scene's film in parallel, pixel after pixel, sample after sample, and calls
/// check(id, radiance, outcome) on each. Cases are the rays traced, of both kinds.
template <typename Check>
Outcome trace_paths(const Scene& scene, std::uint64_t count, const PathTracerOptions& options, const Check& check) {
    const auto render_scene = testing::make_render_scene(scene);
    const PathTracer tracer(*render_scene, scene.film.width, scene.film.height, options);
    const std::uint64_t pixels = std::uint64_t(scene.film.width) * std::uint64_t(scene.film.height);
    return for_batches(count, 0, 4096, [&](test::Random&, std::uint64_t first, std::uint64_t n, Outcome& outcome) {
        PathBatch batch;
        for (std::uint64_t i = first; i < first + n; ++i)
            batch.ids.push_back({static_cast<std::uint32_t>(i % pixels), static_cast<std::uint32_t>(i / pixels)});
        tracer.trace(batch, std::atomic<bool>(false));
        for (std::size_t i = 0; i < n; ++i) check(batch.ids[i], batch.radiance[i], outcome);
        outcome.cases += batch.counts.rays + batch.counts.shadow_rays - n;
    });
}

}  // namespace rayuela::stress
