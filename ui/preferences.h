#pragma once

#include "ui/sampling_settings.h"
#include "ui/view_settings.h"

#include <filesystem>
#include <string>
#include <vector>

namespace rayuela {

/// What is remembered between starts, in <config folder>/preferences.json beside ImGui's layout.ini.
struct Preferences {
    std::filesystem::path folder;  ///< Where it is kept; empty: nothing is read or written (tests, screenshots).
    std::vector<std::string> recent_files;  ///< Newest first.
    std::vector<std::string> closed_panels;
    float ui_scale = 1;  ///< Multiplies the display's own scale.
    bool first_start = true;
    ViewSettings view;
    SamplingSettings sampling;
};

/// $XDG_CONFIG_HOME/rayuela, ~/.config/rayuela, or %APPDATA%/rayuela.
std::filesystem::path default_config_folder();
/// Defaults where the file is absent or damaged.
Preferences load_preferences(const std::filesystem::path& folder);
void save_preferences(const Preferences& preferences);
void remember_file(Preferences& preferences, const std::filesystem::path& file);

}  // namespace rayuela
