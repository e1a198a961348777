#include "core/render/skips.h"

#include "core/render/skip_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace rayuela {

namespace {

Skip samples_of_finished_pixels(const RenderStatistics& statistics) {
    const SampleSpread& spread = statistics.spread;
    const bool active = spread.finished_pixels > 0;
    return {.name = "Samples of finished pixels",
            .state = active                ? SkipState::skipped
                     : statistics.adaptive ? SkipState::absent
                                           : SkipState::needed,
            .why = !statistics.adaptive ? "Adaptive sampling is off: all pixels get the same number."
                   : active ? fmt::format("{:.1f} % of the pixels are as the target error asks: the others go on.",
                                          100 * spread.finished_pixels)
                            : "No pixel is finished yet.",
            .saved = spread.saved,
            .unit = "samples"};
}

std::vector<Skip> all_rows(const RenderScene& scene, const RenderStatistics& statistics) {
    std::vector<Skip> skips = skips_of_light(scene);
    std::ranges::move(skips_of_work(scene, statistics), std::back_inserter(skips));
    std::ranges::move(skips_of_memory(scene), std::back_inserter(skips));
    return skips;
}

}  // namespace

std::string_view name_of(SkipState state) {
    constexpr std::string_view kNames[] = {"skipped", "put back", "needed", "absent"};
    return kNames[static_cast<std::size_t>(state)];
}

std::vector<Skip> skips_of(const RenderScene& scene) {
    return all_rows(scene, {});
}

std::vector<Skip> skips_of(const Frame& frame) {
    std::vector<Skip> skips = all_rows(*frame.render_scene, frame.statistics);
    for (Skip& skip : skips) {
        if (!skip.shortcut || frame.statistics.shortcuts.*skip.shortcut->member) continue;
        if (skip.state == SkipState::skipped) skip.state = SkipState::put_back;
        skip.why = skip.shortcut->put_back;
    }
    skips.push_back(samples_of_finished_pixels(frame.statistics));
    return skips;
}

}  // namespace rayuela
