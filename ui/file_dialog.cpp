#include "ui/file_dialog.h"

#include "ui/icons.h"
#include "ui/theme.h"
#include "ui/widgets.h"

#include <fmt/format.h>
#include <imgui.h>
#include <misc/cpp/imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace rayuela {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPopup = "###file_dialog";
constexpr std::size_t kMaxItems = 10000;

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::string size_text(std::uintmax_t bytes) {
    constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
    double size = static_cast<double>(bytes);
    std::size_t unit = 0;
    for (; size >= 1000 && unit + 1 < std::size(kUnits); ++unit) size /= 1000;
    return unit == 0 ? fmt::format("{:.0f} {}", size, kUnits[unit]) : fmt::format("{:.1f} {}", size, kUnits[unit]);
}

fs::path expanded(const std::string& text) {
    const char* home = std::getenv("HOME");
    if (home && (text == "~" || text.starts_with("~/")))
        return fs::path(home) / fs::path(text.substr(std::min<std::size_t>(2, text.size())));
    return text;
}

bool has_extension(const fs::path& file, const std::vector<std::string>& extensions) {
    const std::string name = lower(file.filename().string());
    return std::ranges::any_of(extensions, [&](const std::string& extension) { return name.ends_with(extension); });
}

}  // namespace

void FileDialog::open(Request request, const fs::path& folder) {
    request_ = std::move(request);
    name_ = request_.name;
    filter_.clear();
    open_ = opening_ = true;
    ask_overwrite_ = false;
    std::error_code error;
    fs::path start = folder.empty() ? folder_ : fs::absolute(folder, error);
    while (!start.empty() && !fs::is_directory(start, error) && start != start.parent_path())
        start = start.parent_path();
    enter(start.empty() ? fs::current_path(error) : start);
}

bool FileDialog::matches(const fs::path& file) const {
    return request_.extensions.empty() || has_extension(file, request_.extensions);
}

void FileDialog::enter(fs::path folder) {
    std::error_code error;
    fs::directory_iterator entries(folder, fs::directory_options::skip_permission_denied, error);
    if (error) {
        error_ = fmt::format("Cannot open {}: {}", folder.string(), error.message());
        return;
    }
    error_.clear();
    items_.clear();
    folder_ = folder.lexically_normal();
    for (; entries != fs::directory_iterator() && items_.size() < kMaxItems; entries.increment(error)) {
        const bool is_folder = entries->is_directory(error);
        const std::string name = entries->path().filename().string();
        if (!is_folder && !matches(entries->path())) continue;
        if (!show_hidden_ && name.starts_with('.')) continue;
        items_.push_back({entries->path(), name, is_folder ? "" : size_text(entries->file_size(error)), is_folder});
    }
    std::ranges::sort(items_, {}, [](const Item& item) { return std::pair(!item.folder, lower(item.name)); });
}

fs::path FileDialog::typed_path() const {
    const fs::path typed = expanded(name_);
    fs::path path = (typed.is_absolute() ? typed : folder_ / typed).lexically_normal();
    if (request_.save && !request_.extensions.empty() && !matches(path)) path += request_.extensions.front();
    return path;
}

void FileDialog::accept() {
    std::error_code error;
    if (name_.empty()) return;
    const fs::path typed = folder_ / expanded(name_);
    if (fs::is_directory(typed, error)) {
        enter(typed);
        name_ = request_.save ? request_.name : "";
        return;
    }
    const fs::path path = typed_path();
    if (!request_.save && !fs::is_regular_file(path, error)) {
        error_ = fmt::format("There is no file {}", path.string());
        return;
    }
    if (request_.save && !fs::is_directory(path.parent_path(), error)) {
        error_ = fmt::format("There is no folder {}", path.parent_path().string());
        return;
    }
    if (request_.save && !ask_overwrite_ && fs::exists(path, error)) {
        ask_overwrite_ = true;
        return;
    }
    const auto chosen = std::move(request_.chosen);
    close();
    if (chosen) chosen(path);
}

void FileDialog::close() {
    open_ = ask_overwrite_ = false;
    request_ = {};
    ImGui::CloseCurrentPopup();
}

void FileDialog::draw(const std::vector<Place>& places) {
    if (!open_) return;
    if (opening_) ImGui::OpenPopup(kPopup);
    const float font = ImGui::GetFontSize();
    const ImVec2 window = ImGui::GetMainViewport()->WorkSize;
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize({std::min(52 * font, 0.95f * window.x), std::min(34 * font, 0.92f * window.y)},
                             ImGuiCond_Appearing);
    if (!ImGui::BeginPopupModal(fmt::format("{}{}", request_.title, kPopup).c_str(), nullptr,
                                ImGuiWindowFlags_NoCollapse)) {
        if (!opening_) open_ = false;
        opening_ = false;
        return;
    }
    draw_path();
    const float footer = 2 * ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    if (ImGui::BeginChild("places", {12 * font, -footer}, ImGuiChildFlags_Borders)) draw_places(places);
    ImGui::EndChild();
    ImGui::SameLine();
    if (ImGui::BeginChild("items", {0, -footer}, ImGuiChildFlags_Borders)) draw_items();
    ImGui::EndChild();
    draw_footer();
    ImGui::EndPopup();
    opening_ = false;
}

void FileDialog::draw_path() {
    const fs::path folder = folder_;
    if (icon_button(icon::kUp, "up", "To the folder above.", folder.has_relative_path())) enter(folder.parent_path());
    fs::path prefix;
    std::vector<fs::path> crumbs;
    for (const fs::path& part : folder) {
        prefix /= part;
        if (!part.empty() && part != "/") crumbs.push_back(prefix);
    }
    // The last few fit; the rest is reached by the button above.
    const std::size_t first = crumbs.size() > 5 ? crumbs.size() - 5 : 0;
    for (std::size_t i = first; i < crumbs.size(); ++i) {
        ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
        if (ImGui::Button(fmt::format("{}##crumb{}", crumbs[i].filename().string(), i).c_str())) enter(crumbs[i]);
        tooltip(crumbs[i].string());
    }
    ImGui::SameLine();
    const float width = 11 * ImGui::GetFontSize();
    ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetContentRegionMax().x - width));
    ImGui::SetNextItemWidth(-FLT_MIN);
    ImGui::InputTextWithHint("##filter", fmt::format("{}  Filter", icon::kSearch).c_str(), &filter_);
    tooltip("Shows only names that contain this.");
}

void FileDialog::draw_places(const std::vector<Place>& places) {
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Place& place = places[i];
        const std::string label = fmt::format("{}  {}##place{}", icon::kGroup, place.name, i);
        if (ImGui::Selectable(label.c_str(), place.folder == folder_)) enter(place.folder);
        tooltip(place.folder.string());
    }
    ImGui::Separator();
    if (ImGui::Checkbox("Hidden files", &show_hidden_)) enter(folder_);
    tooltip("Shows files whose name begins with a dot.");
}

void FileDialog::draw_items() {
    const std::string wanted = lower(filter_);
    const Item* activated = nullptr;
    bool any = false;
    if (!ImGui::BeginTable("files", 2, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("size", ImGuiTableColumnFlags_WidthFixed);
    for (const Item& item : items_) {
        if (!wanted.empty() && lower(item.name).find(wanted) == std::string::npos) continue;
        any = true;
        ImGui::TableNextColumn();
        const char* symbol = item.folder ? icon::kGroup : icon::kFile;
        const std::string label = fmt::format("{}  {}###{}", symbol, item.name, item.name);
        const ImGuiSelectableFlags flags = ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_SpanAllColumns |
                                           ImGuiSelectableFlags_NoAutoClosePopups;
        ImGui::PushStyleColor(
            ImGuiCol_Text, item.folder ? ImGui::GetColorU32(ImGuiCol_TextDisabled) : ImGui::GetColorU32(ImGuiCol_Text));
        const bool pressed = ImGui::Selectable(label.c_str(), item.name == name_, flags);
        ImGui::PopStyleColor();
        if (pressed) {
            if (!item.folder || !request_.save) name_ = item.name;
            ask_overwrite_ = false;
            const bool by_key = !ImGui::IsMouseReleased(0) && !ImGui::IsMouseClicked(0) && !ImGui::IsMouseDown(0);
            if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) || by_key) activated = &item;
        }
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", item.detail.c_str());
    }
    ImGui::EndTable();
    if (!any) hint(filter_.empty() ? "Nothing here that could be chosen." : "No name contains the filter's text.");
    if (!activated) return;
    if (activated->folder) {
        const fs::path folder = activated->path;
        if (!request_.save) name_.clear();
        enter(folder);
    } else {
        accept();
    }
}

void FileDialog::draw_footer() {
    if (ask_overwrite_) {
        ImGui::TextColored(ImVec4(theme::kWarning.x, theme::kWarning.y, theme::kWarning.z, 1),
                           "%s  %s exists already. Press again to overwrite it.", icon::kWarning,
                           typed_path().filename().string().c_str());
    } else if (!error_.empty()) {
        ImGui::TextColored(ImVec4(theme::kError.x, theme::kError.y, theme::kError.z, 1), "%s  %s", icon::kError,
                           error_.c_str());
    } else {
        std::string kinds;
        for (const std::string& extension : request_.extensions) kinds += (kinds.empty() ? "" : "  ") + extension;
        ImGui::TextDisabled("%s", kinds.c_str());
    }
    const float font = ImGui::GetFontSize();
    ImGui::SetNextItemWidth(-13 * font);
    if (opening_) ImGui::SetKeyboardFocusHere();
    const bool entered =
        ImGui::InputText("##name", &name_, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    tooltip("File name; a path, also one that begins with ~, works too. Enter accepts.");
    if (ImGui::IsItemEdited()) {
        ask_overwrite_ = false;
        error_.clear();
    }
    ImGui::SameLine();
    ImGui::BeginDisabled(name_.empty());
    const std::string action = ask_overwrite_ ? "Overwrite" : request_.action;
    const bool pressed = ImGui::Button(fmt::format("{}###accept", action).c_str(), {6 * font, 0});
    ImGui::EndDisabled();
    tooltip("Takes the file named on the left.");
    ImGui::SameLine();
    const bool cancelled = ImGui::Button("Cancel", {-FLT_MIN, 0});
    tooltip("Closes this without doing anything (Escape).");
    if (cancelled || ImGui::IsKeyPressed(ImGuiKey_Escape)) {
        close();
    } else if (pressed || entered) {
        accept();
    }
}

}  // namespace rayuela
