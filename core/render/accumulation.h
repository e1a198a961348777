#pragma once

#include "core/render/adaptive_block.h"
#include "core/render/film.h"
#include "core/render/path_batch.h"
#include "core/render/path_tracer.h"
#include "core/render/sampling_options.h"

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <vector>

namespace rayuela {

/// What a pass over a film heeds and reports, from and to any thread.
struct PassControl {
    const std::atomic<bool>& cancelled;
    std::atomic<std::uint64_t>& paths_done;
    std::chrono::steady_clock::time_point stop_at = std::chrono::steady_clock::time_point::max();

    bool stops() const { return cancelled || std::chrono::steady_clock::now() >= stop_at; }
};

/// A film being filled tile by tile. A pass may be cut short at any point and taken up again: each tile knows how many
/// samples it has, and every sample comes out the same whenever and wherever it is traced. So do paths from lamps, which
/// are shown once their round is complete.
class Accumulation {
public:
    Accumulation(int width, int height);

    const Film& film() const { return film_; }
    /// Scene object (ObjectId::value) that the first sample of each pixel met first.
    const std::vector<std::uint32_t>& object_ids() const { return object_ids_; }
    /// Pixels that lack samples which the film has rejected, ascending.
    std::vector<RejectedPixel> rejected_pixels() const;
    /// Samples that have been traced for every pixel that is to get more; where none is, for those that have most.
    int samples() const;

    /// May change at any time between passes; what is there is kept, but for another `clamp`, which restarts.
    void set_options(const SamplingOptions& options);
    /// All pixels are as the target error asks.
    bool converged() const { return unfinished() == 0; }
    /// Share of the work of another sample of every pixel that is still to be done.
    double unfinished() const;
    /// Camera paths to be traced until every pixel that is not finished has `samples`, if none finishes on the way.
    std::uint64_t paths_to(int samples) const;
    /// How the work is spread so far.
    SampleSpread spread() const;
    /// Samples traced for each pixel, by blocks; none where all have the same.
    std::vector<SampledBlock> sampled_blocks() const;
    /// What the clamp has taken from the image.
    ClampLoss clamp_loss() const;

    /// Light of all sources has changed by this factor, channel by channel: multiplies what is there by it, and goes on
    /// where less noise is asked for now. False, and nothing happens, where what is there is no image yet, or would not have
    /// changed in proportion: the clamp is at work, or samples have been rejected.
    bool scale_light(const Vec3d& factor);
    /// Forgets all samples. Costs nothing now: a tile is cleared when its first sample comes.
    void restart();
    /// Clears the tiles that have no sample since the restart, for a look at an incomplete film.
    void clear_unstarted();
    /// Traces until every pixel that is not finished has `samples`, or as far as `control` allows, on the calling thread's task arena.
    RayCounts add_samples(const PathTracer& tracer, int samples, PassControl& control);

private:
    struct Tile {
        int x0, y0, x1, y1;
        int samples = 0;  ///< Traced for each pixel.
        AdaptiveBlock adaptive;
        std::array<double, 2> clamped{};  ///< Luminance taken from the samples of each half.

        std::size_t pixels() const { return static_cast<std::size_t>(x1 - x0) * static_cast<std::size_t>(y1 - y0); }
    };
    using Batches = tbb::enumerable_thread_specific<PathBatch>;

    bool add_round(const LightTracer& tracer, PassControl& control);
    void add_to_tile(Tile& tile, const PathTracer& tracer, int samples, PassControl& control, PathBatch& batch);
    void add_to_all(const PathTracer& tracer, int samples, PassControl& control);
    void add_to_film(Tile& tile, const PathBatch& batch, const PathTracer& tracer);
    double clamped_a_sample(const Tile& tile) const;
    void clear(const Tile& tile);
    bool adapts() const { return options_.target_error > 0; }
    bool is_finished(const Tile& tile) const { return adapts() && tile.adaptive.stopped(); }
    bool wants_rounds() const { return film_.rounds() > 0 && !(adapts() && rounds_finished_); }
    void make_tiles();
    void stop_where_enough(int samples);
    std::vector<const AdaptiveBlock*> blocks() const;
    std::array<double, 2> luminance_sums(const Tile& tile) const;
    void scale_noise(const std::vector<std::array<double, 2>>& luminances_before);

    SamplingOptions options_;
    std::uint64_t round_rays_ = 0;  ///< Of all rounds.
    bool rounds_finished_ = false;  ///< Light paths bring no noise that matters.
    Film film_;
    /// What each batch of light paths of the round under way brings, once it has been traced; empty between rounds.
    std::vector<std::optional<std::vector<Splat>>> round_;
    std::vector<std::uint32_t> object_ids_;
    std::vector<Tile> tiles_;
    Batches batches_;
    tbb::enumerable_thread_specific<LightBatch> light_batches_;
};

}  // namespace rayuela
