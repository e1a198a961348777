#include "ui/preferences.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace rayuela {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

constexpr std::size_t kMaxRecentFiles = 12;
constexpr const char* kFileName = "preferences.json";

/// Values of another type or out of range leave the default.
void read(const json& values, const char* key, bool& value) {
    if (const auto found = values.find(key); found != values.end() && found->is_boolean()) value = found->get<bool>();
}

void read(const json& values, const char* key, float& value, float min, float max) {
    if (const auto found = values.find(key); found != values.end() && found->is_number())
        value = std::clamp(found->get<float>(), min, max);
}

void read(const json& values, const char* key, std::vector<std::string>& value) {
    const auto found = values.find(key);
    if (found == values.end() || !found->is_array()) return;
    for (const json& text : *found) {
        if (text.is_string()) value.push_back(text.get<std::string>());
    }
}

void read_view(const json& values, ViewSettings& view) {
    if (!values.is_object()) return;
    read(values, "exposure", view.exposure, -20, 20);
    read(values, "show_outline", view.show_outline);
    read(values, "match_window", view.match_window);
    if (const auto found = values.find("tone_map"); found != values.end() && found->is_string()) {
        const auto name = std::ranges::find(kToneMapNames, found->get<std::string>());
        if (name != std::end(kToneMapNames)) view.tone_map = static_cast<ToneMap>(name - std::begin(kToneMapNames));
    }
}

void read_sampling(const json& values, SamplingSettings& sampling) {
    if (!values.is_object()) return;
    read(values, "adaptive", sampling.adaptive);
    read(values, "target_error", sampling.target_error, kMinTargetError, kMaxTargetError);
}

}  // namespace

fs::path default_config_folder() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    for (const auto& [base, rest] :
         {std::pair{variable("XDG_CONFIG_HOME"), "rayuela"}, std::pair{variable("HOME"), ".config/rayuela"},
          std::pair{variable("APPDATA"), "rayuela"}}) {
        if (!base.empty()) return base / rest;
    }
    return {};
}

Preferences load_preferences(const fs::path& folder) {
    Preferences preferences;
    preferences.folder = folder;
    std::ifstream stream(folder / kFileName);
    if (folder.empty() || !stream) return preferences;
    const json values = json::parse(stream, nullptr, false);
    if (!values.is_object()) return preferences;

    preferences.first_start = false;
    read(values, "ui_scale", preferences.ui_scale, 0.5f, 4);
    read(values, "recent_files", preferences.recent_files);
    read(values, "closed_panels", preferences.closed_panels);
    if (const auto view = values.find("view"); view != values.end()) read_view(*view, preferences.view);
    if (const auto found = values.find("sampling"); found != values.end()) read_sampling(*found, preferences.sampling);
    return preferences;
}

void save_preferences(const Preferences& preferences) {
    if (preferences.folder.empty()) return;
    const ViewSettings& view = preferences.view;
    const json values{
        {"ui_scale", preferences.ui_scale},
        {"recent_files", preferences.recent_files},
        {"closed_panels", preferences.closed_panels},
        {"view",
         {{"exposure", view.exposure},
          {"tone_map", kToneMapNames[static_cast<std::size_t>(view.tone_map)]},
          {"show_outline", view.show_outline},
          {"match_window", view.match_window}}},
        {"sampling",
         {{"adaptive", preferences.sampling.adaptive}, {"target_error", preferences.sampling.target_error}}}};
    std::error_code error;
    fs::create_directories(preferences.folder, error);
    const fs::path file = preferences.folder / kFileName, partial = preferences.folder / "preferences.json.partial";
    {
        std::ofstream stream(partial);
        stream << values.dump(2, ' ', false, json::error_handler_t::replace) << '\n';
        if (!stream.flush()) return;
    }
    fs::rename(partial, file, error);
}

void remember_file(Preferences& preferences, const fs::path& file) {
    std::error_code error;
    const fs::path absolute = fs::absolute(file, error);
    const std::string name = (error ? file : absolute.lexically_normal()).string();
    std::erase(preferences.recent_files, name);
    preferences.recent_files.insert(preferences.recent_files.begin(), name);
    if (preferences.recent_files.size() > kMaxRecentFiles) preferences.recent_files.resize(kMaxRecentFiles);
}

}  // namespace rayuela
