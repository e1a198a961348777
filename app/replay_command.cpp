#include "app/subcommands.h"
#include "core/render/replay.h"

#include <fmt/format.h>

namespace rayuela {

Result<void> run_replay(const RenderOptions& options) {
    auto loaded = load_scene(options.scene, options.overrides);
    if (!loaded) return tl::unexpected(loaded.error());
    const FilmSettings film = loaded->film;
    const ReplayedSample& at = *options.replay;
    if (at.x < 0 || at.y < 0 || at.x >= film.width || at.y >= film.height || at.sample < 0) {
        return fail(
            "", "--replay",
            fmt::format("{},{},{} is no sample of a film of {} x {}", at.x, at.y, at.sample, film.width, film.height));
    }
    BuildControl control;
    const auto scene =
        RenderScene::update(nullptr, std::make_shared<const Scene>(std::move(*loaded)), all_changes(), control);
    const PathId id{static_cast<std::uint32_t>(at.y * film.width + at.x), static_cast<std::uint32_t>(at.sample)};
    fmt::print("pixel {},{} sample {}\n{}", at.x, at.y, at.sample, to_text(replay(*scene, id)));
    return {};
}

}  // namespace rayuela
