#include "app/progress_bar.h"
#include "app/subcommands.h"
#include "app/write_text.h"
#include "core/io/image_io.h"
#include "core/render/render_scene.h"
#include "core/render/render_session.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <numeric>

namespace rayuela {

namespace {

/// Where neither the command line nor the scene says when to stop.
constexpr int kDefaultSpp = 128;

volatile std::sig_atomic_t interrupted = 0;

struct Usage {
    double cpu_seconds = 0;
    std::uint64_t peak_memory_bytes = 0;
};

Usage process_usage() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

double progress(const RenderSettings& limits, const SessionStatus& status, const RenderStatistics& statistics) {
    double fraction = 0;
    if (limits.max_samples > 0) fraction = (statistics.spp + status.pass_progress) / limits.max_samples;
    if (limits.max_seconds > 0) fraction = std::max(fraction, statistics.render_seconds / limits.max_seconds);
    return fraction;
}

void show(ProgressBar& bar, const RenderSettings& limits, const SessionStatus& status,
          const RenderStatistics& statistics) {
    if (status.phase == SessionPhase::building) return bar.show(status.build_progress, "building");
    bar.show(
        progress(limits, status, statistics),
        fmt::format("{} spp  {:.1f} s  {:.2f} Msamples/s  {:.2f} Mrays/s", statistics.spp, statistics.render_seconds,
                    1e-6 * statistics.samples_per_second, 1e-6 * statistics.rays_per_second));
}

Result<void> write_stats(const std::filesystem::path& file, const RenderStatistics& statistics, double load_seconds) {
    const Usage usage = process_usage();
    const auto rejected = std::accumulate(statistics.rejected.begin(), statistics.rejected.end(), std::uint64_t{0});
    const nlohmann::ordered_json stats = {{"load_seconds", load_seconds},
                                          {"build_seconds", statistics.build_seconds},
                                          {"render_seconds", statistics.render_seconds},
                                          {"cpu_seconds", usage.cpu_seconds},
                                          {"spp", statistics.spp},
                                          {"samples_per_second", statistics.samples_per_second},
                                          {"rays_per_second", statistics.rays_per_second},
                                          {"nodes", statistics.accel.nodes},
                                          {"leaves", statistics.accel.leaves},
                                          {"primitives", statistics.accel.primitives},
                                          {"references", statistics.accel.references},
                                          {"peak_memory_bytes", usage.peak_memory_bytes},
                                          {"rejected_samples", rejected},
                                          {"estimated_error", statistics.estimated_error},
                                          {"mean_spp", statistics.spread.mean},
                                          {"finished_pixels", statistics.spread.finished_pixels},
                                          {"clamp_removed", statistics.clamp_loss.removed},
                                          {"clamp_removed_share", statistics.clamp_loss.share},
                                          {"threads", statistics.threads}};
    return write_text(file, stats.dump(2) + '\n');
}

}  // namespace

Result<void> run_render(const RenderOptions& options) {
    if (auto writable = check_output(options.output); !writable) return writable;
    const auto start = std::chrono::steady_clock::now();
    auto loaded = load_scene(options.scene, options.overrides);
    if (!loaded) return tl::unexpected(loaded.error());
    auto scene = std::make_shared<Scene>(std::move(*loaded));
    // A limit of another kind on the command line stands alone, whatever number of samples the file asks for.
    const bool adaptive = options.sampling.target_error > 0;
    if ((options.overrides.seconds || adaptive) && !options.overrides.spp) scene->render.max_samples = 0;
    if (scene->render.max_samples == 0 && scene->render.max_seconds == 0 && !adaptive)
        scene->render.max_samples = kDefaultSpp;
    const double load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    std::signal(SIGINT, [](int) { interrupted = 1; });
    RenderSession session({.threads = options.threads, .interactive = false, .sampling = options.sampling});
    session.submit(scene);
    std::shared_ptr<const Frame> frame;
    {
        ProgressBar bar;
        frame = session.wait([&](const SessionStatus& status, const RenderStatistics& statistics) {
            show(bar, scene->render, status, statistics);
            return interrupted != 0;
        });
    }
    if (frame && !frame->render_scene->problems().empty())
        fmt::print(stderr, "{}\n", to_string(frame->render_scene->problems()));
    if (!frame || frame->statistics.spp == 0)
        return fail("", "", "interrupted before the first sample: nothing is saved");
    if (auto written = write_image(options.output, frame->image); !written) return written;
    const RenderStatistics& statistics = frame->statistics;
    const std::string spp = adaptive ? fmt::format("{:.1f} (up to {})", statistics.spread.mean, statistics.spp)
                                     : std::to_string(statistics.spp);
    fmt::print("{}: {} x {}, {} spp in {:.2f} s ({:.2f} Msamples/s){}\n", options.output.string(), frame->image.width,
               frame->image.height, spp, statistics.render_seconds, 1e-6 * statistics.samples_per_second,
               interrupted ? ", interrupted" : "");
    if (options.sampling.clamp > 0) {
        fmt::print("The clamp has removed a luminance of {:.3g} a pixel: {:.3g} % of the image's energy.\n",
                   statistics.clamp_loss.removed, 100 * statistics.clamp_loss.share);
    }
    return options.stats.empty() ? Result<void>{} : write_stats(options.stats, statistics, load_seconds);
}

}  // namespace rayuela
