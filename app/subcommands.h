#pragma once

#include "core/math/result.h"
#include "core/render/sampling_options.h"
#include "core/scene/scene.h"

#include <filesystem>
#include <optional>
#include <string>

namespace rayuela {

/// What the command line may say differently from the scene file. Empty: as the file says.
struct SceneOverrides {
    std::optional<int> spp;
    std::optional<double> seconds;
    std::optional<glm::ivec2> size;
    std::optional<std::uint32_t> seed;
    std::optional<AcceleratorKind> accelerator;
    std::optional<int> kd_leaf_size;
    std::optional<KdSplit> kd_split;
    std::optional<int> max_bounces;
};

/// One sample of the film: column and row of the pixel from the upper left, and its number.
struct ReplayedSample {
    int x = 0, y = 0, sample = 0;
};

struct RenderOptions {
    std::filesystem::path scene, output, stats;  ///< `stats` empty: none is written.
    SceneOverrides overrides;
    SamplingOptions sampling;
    int threads = 0;
    std::vector<std::string> isa;          ///< Instructions to use; empty: the best.
    std::optional<ReplayedSample> replay;  ///< Instead of rendering.
};

struct ScreenshotOptions {
    std::filesystem::path scene, output;
    glm::ivec2 size{1600, 900};
    float scale = 1;
    int spp = 32;
    int threads = 0;
};

struct InfoOptions {
    std::filesystem::path scene;
    bool skips = false;    ///< What the renderer leaves out, instead.
    bool measure = false;  ///< The same, and what that saves.
    bool json = false;
};

struct WindowOptions {
    std::filesystem::path scene;  ///< Empty: the example scene "final".
    int threads = 0;
};

// Each runs one subcommand to its end; a problem is for the person who called.
Result<void> run_render(const RenderOptions& options);
/// Prints the path of options.replay.
Result<void> run_replay(const RenderOptions& options);
Result<void> run_screenshot(const ScreenshotOptions& options);
Result<void> run_info(const InfoOptions& options);
Result<void> run_window(const WindowOptions& options);

/// Reads a scene, prints its warnings to standard error and applies the overrides.
Result<Scene> load_scene(const std::filesystem::path& file, const SceneOverrides& overrides = {});

/// An error unless `file` can be written as an image: a known extension in a folder that exists.
Result<void> check_output(const std::filesystem::path& file);
/// An error where the folder of an output is missing.
Result<void> check_folder(const std::filesystem::path& file);

}  // namespace rayuela
