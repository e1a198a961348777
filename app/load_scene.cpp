#include "app/subcommands.h"
#include "core/io/image_io.h"
#include "core/io/scene_reader.h"
#include "core/scene/scene_edit.h"

#include <fmt/format.h>

namespace rayuela {

Result<Scene> load_scene(const std::filesystem::path& file, const SceneOverrides& overrides) {
    auto loaded = read_scene(file);
    if (!loaded) return tl::unexpected(loaded.error());
    for (const Problem& warning : loaded->warnings) fmt::print(stderr, "warning: {}\n", warning.message());

    RenderSettings render = loaded->scene.render;
    FilmSettings film = loaded->scene.film;
    const auto replace = [](auto& value, const auto& override) {
        if (override) value = *override;
    };
    replace(render.max_samples, overrides.spp);
    replace(render.max_seconds, overrides.seconds);
    replace(render.seed, overrides.seed);
    replace(render.accel.kind, overrides.accelerator);
    replace(render.accel.leaf_size, overrides.kd_leaf_size);
    replace(render.accel.split, overrides.kd_split);
    replace(render.max_bounces, overrides.max_bounces);
    if (overrides.size) film.width = overrides.size->x, film.height = overrides.size->y;
    return apply(loaded->scene, SetRenderSettings{render}).and_then([&](const Scene& scene) {
        return apply(scene, SetFilm{film});
    });
}

Result<void> check_output(const std::filesystem::path& file) {
    if (!is_writable_image(file)) return fail(file.string(), "", "unknown image type; use .png, .exr, .pfm or .hdr");
    return check_folder(file);
}

Result<void> check_folder(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.parent_path();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::is_directory(folder, error)) {
        return fail(file.string(), "", fmt::format("there is no folder {}", folder.string()));
    }
    return {};
}

}  // namespace rayuela
