#include "app/subcommands.h"
#include "app/write_displayed.h"
#include "ui/application.h"
#include "ui/assets_path.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

Problems errors_of(const Log& log) {
    Problems problems;
    for (const LogEntry& entry : log.entries()) {
        if (entry.level == LogLevel::error) problems.push_back({"", "", entry.text});
    }
    return problems;
}

}  // namespace

Result<void> run_window(const WindowOptions& options) {
    auto context = make_window_context("Rayuela", {1600, 900});
    if (!context) return tl::unexpected(context.error());
    Application application(std::move(*context), load_preferences(default_config_folder()), options.threads);
    application.editor().open(options.scene.empty() ? assets_folder() / "scenes" / "final.scene.json" : options.scene);
    application.run();
    return {};
}

Result<void> run_screenshot(const ScreenshotOptions& options) {
    if (auto writable = check_output(options.output); !writable) return writable;
    auto context = make_offscreen_context(options.size, options.scale);
    if (!context) return tl::unexpected(context.error());
    Application application(std::move(*context), Preferences{.first_start = false}, options.threads);
    Editor& editor = application.editor();
    editor.open(options.scene);
    while (editor.is_loading()) application.draw_frame();
    if (editor.file() != options.scene) return tl::unexpected(errors_of(editor.log));
    return write_displayed(options.output, application.screenshot(options.spp));
}

}  // namespace rayuela
