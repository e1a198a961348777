#include "core/render/accumulation.h"

#include "core/accel/parallel.h"
#include "core/render/clamp.h"

#include <algorithm>
#include <climits>
#include <utility>

namespace rayuela {

namespace {

/// Tiles have at least this side where the film is large enough, and less than twice of it.
constexpr int kTileSide = 32;
/// Of the tiles that are blocks of adaptive sampling: smaller ones follow the noise more closely, but know it less well.
constexpr int kAdaptiveTileSide = 16;
/// Paths in flight that the intersection kernels want: where as many samples are asked for, tiles carry several at once.
constexpr std::size_t kBatchPaths = 4096;
/// Paths from lamps that are traced together.
constexpr std::uint32_t kLightPaths = 4096;

/// Calls use(x, y) for the pixels of a tile, square by square, and so within the squares: rays that the kernels take together
/// are close to each other, be they of 8 x 8 pixels, of 4 x 4 or four each of 2 x 2.
template <typename Tile, typename Use>
void for_each_pixel(const Tile& tile, const Use& use) {
    constexpr int kSquare = 8;
    for (int top = tile.y0; top < tile.y1; top += kSquare) {
        for (int left = tile.x0; left < tile.x1; left += kSquare) {
            for (int i = 0; i < kSquare * kSquare; ++i) {
                const int x = left + (i & 1) + (i >> 1 & 2) + (i >> 2 & 4);
                const int y = top + (i >> 1 & 1) + (i >> 2 & 2) + (i >> 3 & 4);
                if (x < tile.x1 && y < tile.y1) use(x, y);
            }
        }
    }
}

std::uint64_t rays_of(const auto& batches) {
    std::uint64_t rays = 0;
    for (const auto& batch : batches) rays += batch.counts.rays + batch.counts.shadow_rays;
    return rays;
}

}  // namespace

Accumulation::Accumulation(int width, int height)
    : film_(width, height), object_ids_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    make_tiles();
}

void Accumulation::make_tiles() {
    const int side = adapts() ? kAdaptiveTileSide : kTileSide;
    const int columns = std::max(1, film_.width() / side), rows = std::max(1, film_.height() / side);
    if (tiles_.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) return;
    tiles_.clear();
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            Tile tile{.x0 = column * film_.width() / columns,
                      .y0 = row * film_.height() / rows,
                      .x1 = (column + 1) * film_.width() / columns,
                      .y1 = (row + 1) * film_.height() / rows};
            tile.adaptive = AdaptiveBlock(tile.pixels());
            tiles_.push_back(std::move(tile));
        }
    }
}

std::vector<RejectedPixel> Accumulation::rejected_pixels() const {
    std::vector<RejectedPixel> found;
    for (const Tile& tile : tiles_) {
        if (tile.samples == 0) continue;
        for_each_pixel(tile, [&](int x, int y) {
            const auto pixel = static_cast<std::uint32_t>(y * film_.width() + x);
            const std::uint64_t missing =
                static_cast<std::uint64_t>(tile.adaptive.shown(0) + tile.adaptive.shown(1)) - film_.count(pixel);
            if (missing > 0) found.push_back({pixel, static_cast<std::uint32_t>(missing)});
        });
    }
    std::ranges::sort(found, {}, &RejectedPixel::pixel);
    return found;
}

int Accumulation::samples() const {
    int least = INT_MAX, most = 0;
    for (const Tile& tile : tiles_) {
        if (!is_finished(tile)) least = std::min(least, tile.samples);
        most = std::max(most, tile.samples);
    }
    if (adapts() && wants_rounds()) least = std::min(least, static_cast<int>(film_.rounds()));
    return least < INT_MAX ? least : most;
}

double Accumulation::unfinished() const {
    return wants_rounds() ? 1 : 1 - spread().finished_pixels;
}

void Accumulation::set_options(const SamplingOptions& options) {
    const SamplingOptions before = std::exchange(options_, options);
    film_.set_equal_halves(adapts());
    if (before.clamp != options.clamp || samples() == 0) return restart();
    if (before.target_error == options.target_error) return;
    rounds_finished_ = false;
    for (Tile& tile : tiles_) {
        // A smaller error needs more samples. Whether a larger one needs fewer is seen at the next decision.
        if (!adapts() || options.target_error < before.target_error) tile.samples = tile.adaptive.resume(tile.samples);
        if (before.target_error == 0) tile.adaptive.start_measuring(tile.samples);
    }
}

void Accumulation::restart() {
    make_tiles();
    rounds_finished_ = false;
    for (Tile& tile : tiles_) {
        tile.samples = 0;
        tile.clamped = {};
        tile.adaptive.restart();
        if (adapts()) tile.adaptive.start_measuring(0);
    }
    film_.clear_rejected();
    film_.clear_splats();
    round_.clear();
    round_rays_ = 0;
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
    for (int now = this->samples(); now < samples && !converged(); now = this->samples()) {
        const int goal = adapts() ? std::min(samples, next_decision(now)) : samples;
        add_to_all(tracer, goal, control);
        if (this->samples() < goal) break;
        if (adapts()) stop_where_enough(goal);
    }
    RayCounts counts;
    for (const PathBatch& batch : batches_) counts += batch.counts;
    for (const LightBatch& batch : light_batches_) counts += batch.counts;
    return counts;
}

void Accumulation::add_to_all(const PathTracer& tracer, int samples, PassControl& control) {
    if (const LightTracer* light_tracer = tracer.light_tracer()) {
        const auto lacks_rounds = [&] {
            return (film_.rounds() == 0 || wants_rounds()) && film_.rounds() < static_cast<std::uint32_t>(samples);
        };
        while (lacks_rounds() && add_round(*light_tracer, control)) {
        }
    }
    parallel_each(tiles_.size(), [&](std::size_t i) {
        if (!is_finished(tiles_[i])) add_to_tile(tiles_[i], tracer, samples, control, batches_.local());
    });
}

/// Stops the halves of tiles that have `samples` and need no more, and the rounds.
void Accumulation::stop_where_enough(int samples) {
    if (next_decision(samples - 1) != samples) return;
    for (Tile& tile : tiles_) {
        if (tile.samples == samples && !is_finished(tile)) tile.adaptive.update_noise(samples);
    }
    // Rounds are one more block, of the whole image.
    const double deviation = wants_rounds() ? film_.splat_deviation() : 0;
    const double cost =
        static_cast<double>(round_rays_) / std::max(1u, film_.rounds()) / static_cast<double>(object_ids_.size());
    std::array<double, 2> mean = mean_burden(blocks());
    for (double& burden : mean) burden += deviation * std::sqrt(cost);
    for (Tile& tile : tiles_) {
        if (tile.samples == samples) tile.adaptive.stop_where_enough(samples, mean, options_.target_error);
    }
    if (!wants_rounds()) return;
    const double wanted = samples_wanted(deviation, cost, (mean[0] + mean[1]) / 2, options_.target_error);
    rounds_finished_ = deviation == 0 || samples >= wanted;
}

std::vector<const AdaptiveBlock*> Accumulation::blocks() const {
    std::vector<const AdaptiveBlock*> blocks;
    for (const Tile& tile : tiles_) blocks.push_back(&tile.adaptive);
    return blocks;
}

bool Accumulation::scale_light(const Vec3d& factor) {
    const auto rejected = film_.rejected();
    const bool all_accepted = std::ranges::all_of(rejected, [](std::uint64_t count) { return count == 0; });
    if (samples() == 0 || options_.clamp > 0 || !all_accepted) return false;
    std::vector<std::array<double, 2>> luminances;
    if (adapts()) {
        for (const Tile& tile : tiles_) luminances.push_back(luminance_sums(tile));
    }
    film_.scale(factor);
    for (auto& splats : round_) {
        if (!splats) continue;
        for (Splat& splat : *splats) splat.radiance *= Color(factor);
    }
    if (adapts()) scale_noise(luminances);
    return true;
}

std::array<double, 2> Accumulation::luminance_sums(const Tile& tile) const {
    std::array<double, 2> sums{};
    for_each_pixel(tile, [&](int x, int y) {
        const auto pixel = static_cast<std::size_t>(y * film_.width() + x);
        for (std::size_t half = 0; half < sums.size(); ++half) sums[half] += film_.luminance_sum(pixel, half);
    });
    return sums;
}

/// What is known of the noise is scaled as the film of each half has been, so that halves still judge each other only.
/// Blocks whose noise counts for more now go on.
void Accumulation::scale_noise(const std::vector<std::array<double, 2>>& luminances_before) {
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
        std::array<double, 2> factors = luminance_sums(tiles_[i]);
        for (std::size_t half = 0; half < factors.size(); ++half)
            factors[half] = luminances_before[i][half] > 0 ? factors[half] / luminances_before[i][half] : 1;
        tiles_[i].adaptive.scale(factors);
    }
    const std::array<double, 2> mean = mean_burden(blocks());
    for (Tile& tile : tiles_) {
        if (tile.adaptive.stopped_too_early(mean, options_.target_error))
            tile.samples = tile.adaptive.resume(tile.samples);
    }
    rounds_finished_ = false;
}

/// Goes on with the light paths that go with one more sample of every pixel; false where `control` does not allow all.
bool Accumulation::add_round(const LightTracer& tracer, PassControl& control) {
    const std::uint32_t round = film_.rounds();
    round_.resize((tracer.paths() + kLightPaths - 1) / kLightPaths);
    const std::uint64_t rays_before = rays_of(light_batches_);
    parallel_ranges(round_.size(), 1, [&](std::size_t begin, std::size_t end) {
        LightBatch& batch = light_batches_.local();
        for (std::size_t i = begin; i < end; ++i) {
            if (round_[i]) continue;
            if (control.stops()) return;
            const std::uint32_t first = static_cast<std::uint32_t>(i) * kLightPaths;
            const std::uint32_t count = std::min(kLightPaths, tracer.paths() - first);
            if (!tracer.trace(first, count, round, batch, control.cancelled)) return;
            round_[i].emplace().swap(batch.splats);
        }
    });
    round_rays_ += rays_of(light_batches_) - rays_before;
    if (!std::ranges::all_of(round_, [](const auto& splats) { return splats.has_value(); })) return false;
    // One thread in the order of the paths: sums do not depend on how many there are.
    for (const auto& splats : round_) {
        for (const Splat& splat : *splats) film_.splat(splat.pixel, round, splat.radiance);
    }
    film_.end_round(round);
    round_.clear();
    return true;
}

void Accumulation::add_to_tile(Tile& tile, const PathTracer& tracer, int samples, PassControl& control,
                               PathBatch& batch) {
    if (tile.samples == 0) clear(tile);
    const int samples_at_once = static_cast<int>((kBatchPaths + tile.pixels() - 1) / tile.pixels());
    while (tile.samples < samples) {
        if (control.stops()) return;
        int end = std::min(samples, tile.samples + samples_at_once);
        if (adapts()) end = std::min(end, end_of_half(tile.samples));
        batch.ids.clear();
        for_each_pixel(tile, [&](int x, int y) {
            const auto pixel = static_cast<std::uint32_t>(y * film_.width() + x);
            for (int sample = tile.samples; sample < end; ++sample)
                batch.ids.push_back({pixel, static_cast<std::uint32_t>(sample)});
        });
        const std::uint64_t rays_before = batch.counts.rays + batch.counts.shadow_rays;
        if (!tracer.trace(batch, control.cancelled)) return;
        add_to_film(tile, batch, tracer);
        if (adapts()) {
            tile.adaptive.add_cost(static_cast<std::uint32_t>(tile.samples),
                                   batch.counts.rays + batch.counts.shadow_rays - rays_before);
        }
        tile.samples = end;
        tile.adaptive.set_shown(end);
        control.paths_done += batch.ids.size();
    }
}

void Accumulation::add_to_film(Tile& tile, const PathBatch& batch, const PathTracer& tracer) {
    const bool plain =
        !adapts() && options_.clamp == 0 && tile.adaptive.shows_all_from(static_cast<std::uint32_t>(tile.samples));
    const std::size_t samples = batch.ids.size() / tile.pixels();
    for (std::size_t i = 0; i < batch.ids.size(); ++i) {
        const auto [pixel, sample] = batch.ids[i];
        if (sample == 0) object_ids_[pixel] = tracer.object_id(batch.first_object[i]);
        const Color& traced = batch.radiance[i];
        if (plain) {
            film_.add(pixel, sample, traced);
            continue;
        }
        const Color radiance = options_.clamp > 0 ? clamped(traced, options_.clamp) : traced;
        if (adapts()) tile.adaptive.measure(i / samples, sample, luminance(radiance));
        if (!tile.adaptive.shows(sample)) continue;
        if (radiance != traced && !rejection(traced))
            tile.clamped[sample_half(sample)] += static_cast<double>(luminance(traced) - luminance(radiance));
        film_.add(pixel, sample, radiance);
    }
}

std::uint64_t Accumulation::paths_to(int samples) const {
    std::uint64_t paths = 0;
    for (const Tile& tile : tiles_) {
        if (!is_finished(tile))
            paths += tile.pixels() * static_cast<std::uint64_t>(std::max(0, samples - tile.samples));
    }
    return paths;
}

SampleSpread Accumulation::spread() const {
    const int most = samples();
    double pixels = 0, traced = 0, finished = 0;
    SampleSpread spread;
    for (const Tile& tile : tiles_) {
        const auto size = static_cast<double>(tile.pixels());
        pixels += size;
        traced += size * tile.samples;
        if (!is_finished(tile)) continue;
        finished += size;
        spread.saved += tile.pixels() * static_cast<std::uint64_t>(std::max(0, most - tile.samples));
    }
    spread.mean = traced / pixels;
    spread.finished_pixels = finished / pixels;
    return spread;
}

std::vector<SampledBlock> Accumulation::sampled_blocks() const {
    std::vector<SampledBlock> blocks;
    if (!adapts()) return blocks;
    for (const Tile& tile : tiles_) blocks.push_back({tile.x0, tile.y0, tile.x1, tile.y1, tile.samples});
    return blocks;
}

/// Luminance taken from a pixel of the tile, the sum over its pixels: halves count as they do in the film.
double Accumulation::clamped_a_sample(const Tile& tile) const {
    const double a = tile.adaptive.shown(0), b = tile.adaptive.shown(1);
    if (adapts() && b > 0) return (tile.clamped[0] / a + tile.clamped[1] / b) / 2;
    return (tile.clamped[0] + tile.clamped[1]) / (a + b);
}

ClampLoss Accumulation::clamp_loss() const {
    if (options_.clamp == 0) return {};
    double removed = 0, shown = 0;
    for (const Tile& tile : tiles_) {
        if (tile.samples == 0) continue;
        removed += clamped_a_sample(tile);
        for_each_pixel(tile, [&](int x, int y) {
            shown += static_cast<double>(luminance(Color(film_.mean(static_cast<std::size_t>(y * film_.width() + x)))));
        });
    }
    const double pixels = static_cast<double>(object_ids_.size());
    return {.removed = removed / pixels, .share = removed > 0 ? removed / (removed + shown) : 0};
}

}  // namespace rayuela
