#include "ui/assets_path.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace rayuela {
namespace fs = std::filesystem;
namespace {

std::string first_comment(const fs::path& file) {
    std::ifstream stream(file);
    std::string line;
    for (int count = 0; count < 20 && std::getline(stream, line); ++count) {
        const auto start = line.find_first_not_of(" \t");
        if (start == std::string::npos || line.compare(start, 2, "//") != 0) continue;
        const auto text = line.find_first_not_of(" \t/", start);
        return text == std::string::npos ? "" : line.substr(text);
    }
    return "";
}

}  // namespace

fs::path assets_folder() {
    std::error_code error;
    std::vector<fs::path> candidates;
    if (const char* folder = std::getenv("RAYUELA_ASSETS")) candidates.emplace_back(folder);
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) candidates.push_back(program.parent_path().parent_path() / "share" / "rayuela");
#ifdef RAYUELA_ASSETS_DIR
    candidates.emplace_back(RAYUELA_ASSETS_DIR);
#endif
    const auto found =
        std::ranges::find_if(candidates, [&](const fs::path& folder) { return fs::is_directory(folder, error); });
    return found != candidates.end() ? found->lexically_normal() : fs::path();
}

std::vector<Example> example_scenes() {
    constexpr std::string_view kSuffix = ".scene.json";
    std::vector<Example> examples;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(assets_folder() / "scenes", error)) {
        const std::string name = entry.path().filename().string();
        if (!name.ends_with(kSuffix)) continue;
        examples.push_back({entry.path(), name.substr(0, name.size() - kSuffix.size()), first_comment(entry.path())});
    }
    std::ranges::sort(examples, {}, &Example::name);
    return examples;
}

}  // namespace rayuela
