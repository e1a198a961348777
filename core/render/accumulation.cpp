#include "core/render/accumulation.h"

#include "core/accel/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>

namespace rayuela {

namespace {

/// Tiles have at least this side where the film is large enough, and less than twice of it.
constexpr int kTileSide = 32;
/// Paths in flight that the intersection kernels want; smaller tiles carry several samples at once.
constexpr std::size_t kBatchPaths = 1024;
/// Paths from lamps that are traced together.
constexpr std::uint32_t kLightPaths = 4096;

/// Calls use(x, y) for the pixels of a tile, square by square: rays that the kernels take together are close to each other.
template <typename Tile, typename Use>
void for_each_pixel(const Tile& tile, const Use& use) {
    constexpr int kSquare = 4;
    for (int top = tile.y0; top < tile.y1; top += kSquare) {
        for (int left = tile.x0; left < tile.x1; left += kSquare) {
            for (int y = top; y < std::min(top + kSquare, tile.y1); ++y) {
                for (int x = left; x < std::min(left + kSquare, tile.x1); ++x) use(x, y);
            }
        }
    }
}

}  // namespace

Accumulation::Accumulation(int width, int height)
    : film_(width, height), object_ids_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    const int columns = std::max(1, width / kTileSide), rows = std::max(1, height / kTileSide);
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            tiles_.push_back({.x0 = column * width / columns,
                              .y0 = row * height / rows,
                              .x1 = (column + 1) * width / columns,
                              .y1 = (row + 1) * height / rows});
        }
    }
}

std::vector<RejectedPixel> Accumulation::rejected_pixels() const {
    std::vector<RejectedPixel> found;
    for (const Tile& tile : tiles_) {
        if (tile.samples == 0) continue;
        for_each_pixel(tile, [&](int x, int y) {
            const auto pixel = static_cast<std::uint32_t>(y * film_.width() + x);
            const std::uint64_t missing = static_cast<std::uint64_t>(tile.samples) - film_.count(pixel);
            if (missing > 0) found.push_back({pixel, static_cast<std::uint32_t>(missing)});
        });
    }
    std::ranges::sort(found, {}, &RejectedPixel::pixel);
    return found;
}

int Accumulation::samples() const {
    return std::ranges::min_element(tiles_, {}, &Tile::samples)->samples;
}

void Accumulation::restart() {
    for (Tile& tile : tiles_) tile.samples = 0;
    film_.clear_rejected();
    film_.clear_splats();
}

void Accumulation::clear_unstarted() {
    for (const Tile& tile : tiles_) {
        if (tile.samples == 0) clear(tile);
    }
}

void Accumulation::clear(const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
            const std::size_t pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(film_.width()) + static_cast<std::size_t>(x);
            film_.clear(pixel);
            object_ids_[pixel] = 0;
        }
    }
}

RayCounts Accumulation::add_samples(const PathTracer& tracer, int samples, PassControl& control) {
    for (PathBatch& batch : batches_) batch.counts = {};
    for (LightBatch& batch : light_batches_) batch.counts = {};
    if (const LightTracer* light_tracer = tracer.light_tracer()) {
        while (film_.rounds() < static_cast<std::uint32_t>(samples) && add_round(*light_tracer, control)) {
        }
    }
    const tbb::blocked_range<std::size_t> all(0, tiles_.size(), 1);
    const auto add_to_tiles = [&](const tbb::blocked_range<std::size_t>& range) {
        PathBatch& batch = batches_.local();
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            add_to_tile(tiles_[i], tracer, samples, control, batch);
    };
    tbb::parallel_for(all, add_to_tiles, tbb::simple_partitioner());
    RayCounts counts;
    for (const PathBatch& batch : batches_) counts += batch.counts;
    for (const LightBatch& batch : light_batches_) counts += batch.counts;
    return counts;
}

/// All light paths that go with one sample of every pixel, or none where `control` does not allow.
bool Accumulation::add_round(const LightTracer& tracer, PassControl& control) {
    if (control.cancelled || std::chrono::steady_clock::now() >= control.stop_at) return false;
    const std::uint32_t round = film_.rounds();
    const std::size_t count = (tracer.paths() + kLightPaths - 1) / kLightPaths;
    std::vector<std::vector<Splat>> splats(count);
    parallel_ranges(count, 1, [&](std::size_t begin, std::size_t end) {
        LightBatch& batch = light_batches_.local();
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t first = static_cast<std::uint32_t>(i) * kLightPaths;
            if (!tracer.trace(first, std::min(kLightPaths, tracer.paths() - first), round, batch, control.cancelled)) {
                return;
            }
            splats[i].swap(batch.splats);
        }
    });
    if (control.cancelled) return false;
    // One thread in the order of the paths: sums do not depend on how many there are.
    for (const std::vector<Splat>& batch : splats) {
        for (const Splat& splat : batch) film_.splat(splat.pixel, round, splat.radiance);
    }
    film_.end_round(round);
    return true;
}

void Accumulation::add_to_tile(Tile& tile, const PathTracer& tracer, int samples, PassControl& control,
                               PathBatch& batch) {
    if (tile.samples == 0) clear(tile);
    const int samples_at_once = static_cast<int>(std::max<std::size_t>(1, kBatchPaths / tile.pixels()));
    while (tile.samples < samples) {
        if (control.cancelled || std::chrono::steady_clock::now() >= control.stop_at) return;
        const int end = std::min(samples, tile.samples + samples_at_once);
        batch.ids.clear();
        for (int sample = tile.samples; sample < end; ++sample) {
            for_each_pixel(tile, [&](int x, int y) {
                batch.ids.push_back(
                    {static_cast<std::uint32_t>(y * film_.width() + x), static_cast<std::uint32_t>(sample)});
            });
        }
        if (!tracer.trace(batch, control.cancelled)) return;
        for (std::size_t i = 0; i < batch.ids.size(); ++i) {
            const auto [pixel, sample] = batch.ids[i];
            film_.add(pixel, sample, batch.radiance[i]);
            if (sample == 0) object_ids_[pixel] = tracer.object_id(batch.first_object[i]);
        }
        tile.samples = end;
        control.paths_done += batch.ids.size();
    }
}

}  // namespace rayuela
