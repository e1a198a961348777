#pragma once

#include "core/render/film.h"
#include "core/render/path_batch.h"
#include "core/render/path_tracer.h"

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <chrono>
#include <vector>

namespace rayuela {

/// What a pass over a film heeds and reports, from and to any thread.
struct PassControl {
    const std::atomic<bool>& cancelled;
    std::atomic<std::uint64_t>& paths_done;
    std::chrono::steady_clock::time_point stop_at = std::chrono::steady_clock::time_point::max();
};

/// A film being filled tile by tile. A pass may be cut short at any point and taken up again: each tile knows how many
/// samples it has, and every sample comes out the same whenever and wherever it is traced.
class Accumulation {
public:
    Accumulation(int width, int height);

    const Film& film() const { return film_; }
    /// Scene object (ObjectId::value) that the first sample of each pixel met first.
    const std::vector<std::uint32_t>& object_ids() const { return object_ids_; }
    /// Pixels that lack samples which the film has rejected, ascending.
    std::vector<RejectedPixel> rejected_pixels() const;
    /// Samples that every pixel has.
    int samples() const;

    /// Forgets all samples. Costs nothing now: a tile is cleared when its first sample comes.
    void restart();
    /// Clears the tiles that have no sample since the restart, for a look at an incomplete film.
    void clear_unstarted();
    /// Traces until every pixel has `samples`, or as far as `control` allows, on the calling thread's task arena.
    RayCounts add_samples(const PathTracer& tracer, int samples, PassControl& control);

private:
    struct Tile {
        int x0, y0, x1, y1;
        int samples = 0;

        std::size_t pixels() const { return static_cast<std::size_t>(x1 - x0) * static_cast<std::size_t>(y1 - y0); }
    };
    using Batches = tbb::enumerable_thread_specific<PathBatch>;

    bool add_round(const LightTracer& tracer, PassControl& control);
    void add_to_tile(Tile& tile, const PathTracer& tracer, int samples, PassControl& control, PathBatch& batch);
    void clear(const Tile& tile);

    Film film_;
    std::vector<std::uint32_t> object_ids_;
    std::vector<Tile> tiles_;
    Batches batches_;
    tbb::enumerable_thread_specific<LightBatch> light_batches_;
};

}  // namespace rayuela
