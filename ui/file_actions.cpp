#include "ui/file_actions.h"

#include "ui/assets_path.h"

#include <algorithm>
#include <cstdlib>

namespace rayuela {
namespace fs = std::filesystem;
namespace {

const std::vector<std::string> kModelExtensions{".obj", ".ply", ".gltf", ".glb"};
const std::vector<std::string> kImageExtensions{".png", ".jpg", ".jpeg", ".hdr", ".exr", ".pfm"};

/// Where the current scene lies, else where the last one did, else the examples.
fs::path start_folder(const Editor& editor) {
    if (!editor.file().empty()) return editor.file().parent_path();
    if (!editor.preferences.recent_files.empty())
        return fs::path(editor.preferences.recent_files.front()).parent_path();
    return assets_folder() / "scenes";
}

std::string stem(const Editor& editor) {
    std::string name = editor.file().filename().string();
    name = name.substr(0, name.find('.'));
    return name.empty() ? "scene" : name;
}

void ask_for_scene_file(Editor& editor, std::function<void(Editor&)> then) {
    editor.file_dialog.open({.title = "Save scene as",
                             .action = "Save",
                             .extensions = {".scene.json"},
                             .name = stem(editor) + ".scene.json",
                             .save = true,
                             .chosen =
                                 [&editor, then = std::move(then)](const fs::path& file) {
                                     if (editor.save_as(file) && then) then(editor);
                                 }},
                            start_folder(editor));
}

}  // namespace

void open_dialog(Editor& editor) {
    FileDialog::Request request{.title = "Open scene", .action = "Open"};
    request.extensions = {".scene.json", ".json"};
    request.extensions.insert(request.extensions.end(), kModelExtensions.begin(), kModelExtensions.end());
    request.chosen = [&editor](const fs::path& file) {
        editor.after_asking_to_save([file](Editor& e) { e.open(file); });
    };
    editor.file_dialog.open(std::move(request), start_folder(editor));
}

void save_as_dialog(Editor& editor) {
    ask_for_scene_file(editor, {});
}

void save_and_then(Editor& editor, std::function<void(Editor&)> then) {
    if (editor.file().extension() != ".json") {
        ask_for_scene_file(editor, std::move(then));
    } else if (editor.save() && then) {
        then(editor);
    }
}

void save_or_ask(Editor& editor) {
    save_and_then(editor, {});
}

void import_dialog(Editor& editor) {
    editor.file_dialog.open({.title = "Import into the scene",
                             .action = "Import",
                             .extensions = kModelExtensions,
                             .chosen = [&editor](const fs::path& file) { editor.import(file); }},
                            start_folder(editor));
}

void save_image_dialog(Editor& editor) {
    editor.file_dialog.open({.title = "Save image",
                             .action = "Save",
                             .extensions = {".png", ".exr", ".hdr", ".pfm"},
                             .name = stem(editor) + ".png",
                             .save = true,
                             .chosen = [&editor](const fs::path& file) { editor.save_image(file); }},
                            start_folder(editor));
}

void object_file_dialog(Editor& editor, ObjectId id) {
    const Object* object = editor.scene().find(id);
    const bool is_gltf = object && std::holds_alternative<Gltf>(object->shape);
    editor.file_dialog.open(
        {.title = is_gltf ? "Choose a glTF file" : "Choose a mesh",
         .action = "Choose",
         .extensions = is_gltf ? std::vector<std::string>{".gltf", ".glb"} : std::vector<std::string>{".obj", ".ply"},
         .chosen = [&editor, id](const fs::path& file) { editor.load_object_data(id, file); }},
        start_folder(editor));
}

void texture_dialog(Editor& editor, MaterialId id, std::string key) {
    editor.file_dialog.open(
        {.title = "Choose a texture",
         .action = "Choose",
         .extensions = kImageExtensions,
         .chosen = [&editor, id, key](const fs::path& file) { editor.load_texture(id, key, file); }},
        start_folder(editor));
}

void environment_dialog(Editor& editor) {
    editor.file_dialog.open({.title = "Choose a panorama",
                             .action = "Choose",
                             .extensions = {".hdr", ".exr", ".pfm", ".png", ".jpg", ".jpeg"},
                             .chosen = [&editor](const fs::path& file) { editor.load_environment(file); }},
                            start_folder(editor));
}

void draw_file_dialog(Editor& editor) {
    if (!editor.file_dialog.is_open()) return;
    std::vector<FileDialog::Place> places;
    if (const char* home = std::getenv("HOME")) places.push_back({"Home", home});
    if (const fs::path assets = assets_folder(); !assets.empty()) places.push_back({"Examples", assets / "scenes"});
    for (const std::string& file : editor.preferences.recent_files) {
        const fs::path folder = fs::path(file).parent_path();
        if (std::ranges::find(places, folder, &FileDialog::Place::folder) != places.end()) continue;
        places.push_back({folder.filename().string(), folder});
    }
    editor.file_dialog.draw(places);
}

}  // namespace rayuela
