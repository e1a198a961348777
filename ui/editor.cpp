#include "ui/editor.h"

#include "core/io/gltf_reader.h"
#include "core/io/image_io.h"
#include "core/io/mesh_io.h"
#include "core/io/scene_reader.h"
#include "core/io/scene_writer.h"
#include "ui/tone_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>

namespace rayuela {
namespace fs = std::filesystem;
namespace {

constexpr std::chrono::seconds kAutosaveInterval{60};

std::shared_ptr<const Scene> empty_scene() {
    Scene scene;
    scene.environment = GradientEnvironment{};
    return std::make_shared<const Scene>(std::move(scene));
}

bool is_scene_json(const fs::path& file) {
    return file.extension() == ".json";
}

fs::path autosave_file(const Preferences& preferences) {
    return preferences.folder.empty() ? fs::path() : preferences.folder / "autosave.scene.json";
}

/// An autosave found at start, out of the way of those to come.
fs::path lost_file(const Preferences& preferences) {
    return preferences.folder.empty() ? fs::path() : preferences.folder / "lost.scene.json";
}

}  // namespace

/// What a background job has read: how the scene changes by it.
struct Editor::Loaded {
    std::function<Result<Scene>(const Scene&)> change;
    Problems warnings;
};

struct Editor::Load {
    std::string label;
    fs::path opened;  ///< Not empty: it becomes the scene, with a new history.
    std::future<Result<Loaded>> result;
    bool superseded = false;
};

Editor::Editor(Preferences initial, int thread_count)
    : view(initial.view),
      preferences(std::move(initial)),
      threads(thread_count),
      sampling(preferences.sampling),
      history_(empty_scene()),
      saved_(history_.current()),
      shown_(history_.current()),
      cache_(std::make_shared<AssetCache>()),
      autosave_time_(std::chrono::steady_clock::now()),
      session_({.threads = thread_count, .interactive = true, .sampling = sampling.options()}),
      session_threads_(thread_count),
      session_sampling_(sampling.options()) {
    panels.show_quick_start = preferences.first_start && !preferences.folder.empty();
    std::error_code error;
    if (!preferences.folder.empty()) fs::rename(autosave_file(preferences), lost_file(preferences), error);
    panels.show_lost_work = !preferences.folder.empty() && !error;
    show();
}

Editor::~Editor() {
    discard_autosave();
    preferences.view = view;
    preferences.sampling = sampling;
    save_preferences(preferences);
}

void Editor::begin_frame(std::uint64_t gesture) {
    if (gesture != held_) {
        held_ = gesture;
        gesture_ = gesture ? ++gestures_ : 0;
    }
    if (paused != session_paused_) session_.set_paused(session_paused_ = paused);
    if (threads != session_threads_) session_.set_threads(session_threads_ = threads);
    if (sampling.options() != session_sampling_) session_.set_sampling(session_sampling_ = sampling.options());
    if (shortcuts != session_shortcuts_) session_.set_shortcuts(session_shortcuts_ = shortcuts);
    if (film_size_ && !view.match_window) {
        film_size_.reset();
        show();
    }

    // A load may be finished while another one is being started by its result, so the list is taken apart first.
    for (std::size_t i = 0; i < loads_.size();) {
        if (loads_[i]->result.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
            ++i;
            continue;
        }
        const std::unique_ptr<Load> ready = std::move(loads_[i]);
        loads_.erase(loads_.begin() + static_cast<std::ptrdiff_t>(i));
        if (!ready->superseded) finish(*ready);
    }

    const std::shared_ptr<const Frame> shown = std::exchange(frame_, session_.frame());
    if (frame_ && (!shown || shown->render_scene->problems() != frame_->render_scene->problems()))
        log.add(LogLevel::warning, frame_->render_scene->problems());
    if (frame_) convergence_.add(frame_->statistics);
    health.update(frame_, view.map);
    if (std::chrono::steady_clock::now() - autosave_time_ >= kAutosaveInterval) autosave();
}

bool Editor::edit(const SceneEdit& edit, std::string label) {
    Result<Scene> next = apply(scene(), edit);
    if (!next) {
        log.add(LogLevel::error, label + " is not possible: " + to_string(next.error()));
        return false;
    }
    if (*next != scene()) push(std::make_shared<const Scene>(std::move(*next)), std::move(label), gesture_);
    return true;
}

void Editor::undo() {
    if (history_.undo()) show();
}

void Editor::redo() {
    if (history_.redo()) show();
}

void Editor::resize_film(int width, int height) {
    const glm::ivec2 size(std::clamp(width, 1, kMaxFilmSide), std::clamp(height, 1, kMaxFilmSide));
    if (!view.match_window || film_size_ == size) return;
    film_size_ = size;
    show();
}

void Editor::push(std::shared_ptr<const Scene> next, std::string label, std::uint64_t gesture) {
    history_.push(std::move(next), std::move(label), gesture);
    show();
}

void Editor::show() {
    shown_ = history_.current();
    if (film_size_) {
        Scene sized = *shown_;
        sized.film.width = film_size_->x;
        sized.film.height = film_size_->y;
        shown_ = std::make_shared<const Scene>(std::move(sized));
    }
    session_.submit(shown_);
    forget_lost_selection();
}

void Editor::forget_lost_selection() {
    if (selection && !scene().find(*selection)) selection.reset();
    if (selected_material && !scene().find(*selected_material)) selected_material.reset();
}

void Editor::new_scene() {
    for (const auto& load : loads_) load->superseded = true;
    history_ = SceneHistory(empty_scene());
    saved_ = history_.current();
    file_.clear();
    show();
}

void Editor::load(std::string label, fs::path opened, std::function<Result<Loaded>()> read) {
    loads_.push_back(std::make_unique<Load>(
        Load{std::move(label), std::move(opened), std::async(std::launch::async, std::move(read)), false}));
}

std::string Editor::loading_label() const {
    const auto current = std::ranges::find(loads_, false, [](const auto& load) { return load->superseded; });
    return current != loads_.end() ? (*current)->label : "";
}

void Editor::finish(Load& load) {
    Result<Loaded> loaded = load.result.get();
    Result<Scene> next = loaded ? loaded->change(scene()) : tl::unexpected(loaded.error());
    if (!next) {
        log.add(LogLevel::info, load.label + " failed; the scene is unchanged.");
        log.add(LogLevel::error, next.error());
        return;
    }
    log.add(LogLevel::warning, loaded->warnings);
    const std::uint32_t first_new_id = scene().next_id;
    auto current = std::make_shared<const Scene>(std::move(*next));
    if (load.opened.empty()) {
        push(std::move(current), load.label, 0);
        const bool is_new = !scene().objects.empty() && scene().objects.back().id.value >= first_new_id;
        if (is_new) selection = scene().objects.back().id;
    } else {
        const bool recovered = load.opened == lost_file(preferences);
        history_ = SceneHistory(current);
        saved_ = recovered ? nullptr : current;
        file_ = recovered ? fs::path() : load.opened;
        selection.reset();
        selected_material.reset();
        cache_->release_unused();
        if (!recovered) {
            remember_file(preferences, load.opened);
            save_preferences(preferences);
        }
        show();
    }
    log.add(LogLevel::info, load.label + " done.");
}

void Editor::open(const fs::path& file) {
    for (const auto& load : loads_) load->superseded = true;
    load("Opening " + file.filename().string(), file, [file, cache = cache_]() -> Result<Loaded> {
        auto loaded = read_scene(file, cache.get());
        if (!loaded) return tl::unexpected(loaded.error());
        return Loaded{[scene = std::move(loaded->scene)](const Scene&) -> Result<Scene> { return scene; },
                      std::move(loaded->warnings)};
    });
}

void Editor::import(const fs::path& file) {
    load("Import of " + file.filename().string(), {}, [file, cache = cache_]() -> Result<Loaded> {
        auto loaded = load_object_file(file, cache.get());
        if (!loaded) return tl::unexpected(loaded.error());
        Problems warnings = loaded->warnings;
        return Loaded{[object = std::move(*loaded)](const Scene& scene) { return add_to_scene(scene, object); },
                      std::move(warnings)};
    });
}

void Editor::load_object_data(ObjectId id, const fs::path& file) {
    const auto put_in_place = [id](const Scene& scene, const LoadedObject& loaded) -> Result<Scene> {
        auto added = add_to_scene(scene, loaded);
        if (!added) return added;
        const Object carrier = added->objects.back();
        auto without = apply(*added, RemoveObject{carrier.id});
        const Object* object = without ? without->find(id) : nullptr;
        if (!object) return fail("", "", "the object is gone");
        Object changed = *object;
        changed.shape = carrier.shape;
        return apply(*without, SetObject{std::move(changed)});
    };
    load("Reading " + file.filename().string(), {}, [=, cache = cache_]() -> Result<Loaded> {
        auto loaded = load_object_file(file, cache.get());
        if (!loaded) return tl::unexpected(loaded.error());
        Problems warnings = loaded->warnings;
        return Loaded{[=, object = std::move(*loaded)](const Scene& scene) { return put_in_place(scene, object); },
                      std::move(warnings)};
    });
}

void Editor::load_texture(MaterialId id, const std::string& key, const fs::path& file) {
    const MaterialEntry* target = scene().find(id);
    if (!target) return;
    ColorDecoding decoding = ColorDecoding::linear;
    std::visit(
        [&]<typename T>(const T& material) {
            T::visit_fields(material, [&]<typename F>(const F&, const Field& field) {
                if (std::is_same_v<F, ColorValue> && field.key == key) decoding = ColorDecoding::srgb;
            });
        },
        target->material);

    const auto put_in_place = [id, key](const Scene& scene,
                                        const std::shared_ptr<const Image>& image) -> Result<Scene> {
        const MaterialEntry* entry = scene.find(id);
        if (!entry) return fail("", "", "the material is gone");
        MaterialEntry changed = *entry;
        std::visit(
            [&]<typename T>(T& material) {
                T::visit_fields(material, [&]<typename F>(F& member, const Field& field) {
                    if constexpr (requires { member.texture; }) {
                        if (field.key == key) member.texture = image;
                    }
                });
            },
            changed.material);
        return apply(scene, SetMaterial{std::move(changed)});
    };
    load("Texture " + file.filename().string(), {}, [=, cache = cache_]() -> Result<Loaded> {
        auto image = cache->image(file, decoding);
        if (!image) return tl::unexpected(image.error());
        return Loaded{[=, read = *image](const Scene& scene) { return put_in_place(scene, read); }, {}};
    });
}

void Editor::load_environment(const fs::path& file) {
    load("Environment " + file.filename().string(), {}, [file, cache = cache_]() -> Result<Loaded> {
        auto image = cache->panorama(file, ColorDecoding::linear);
        if (!image) return tl::unexpected(image.error());
        return Loaded{[file, read = *image](const Scene& scene) {
                          const auto* present = std::get_if<ImageEnvironment>(&scene.environment);
                          ImageEnvironment environment = present ? *present : ImageEnvironment{};
                          environment.file = file.string();
                          environment.image = read;
                          return apply(scene, SetEnvironment{std::move(environment)});
                      },
                      {}};
    });
}

bool Editor::save() {
    if (!is_scene_json(file_)) {
        log.add(LogLevel::error, "Save needs the name of a .scene.json: use Save as.");
        return false;
    }
    return save_as(file_);
}

bool Editor::save_as(const fs::path& file) {
    if (auto written = write_scene(file, scene(), cache_.get()); !written) {
        log.add(LogLevel::error, written.error());
        return false;
    }
    file_ = file;
    saved_ = history_.current();
    discard_autosave();
    remember_file(preferences, file_);
    save_preferences(preferences);
    log.add(LogLevel::info, "Saved " + file_.string());
    return true;
}

bool Editor::save_image(const fs::path& file) {
    if (!frame_) {
        log.add(LogLevel::error, "There is no image to save yet.");
        return false;
    }
    if (frame_->coarse) log.add(LogLevel::warning, "The image is still a coarse preview and is saved as such.");
    const bool display = file.extension() == ".png";
    const auto written =
        write_image(file, display ? tone_mapped(frame_->image, view.exposure, view.tone_map) : frame_->image);
    if (!written) {
        log.add(LogLevel::error, written.error());
        return false;
    }
    log.add(LogLevel::info, fmt::format("Saved {} ({} x {}, {} samples a pixel)", file.string(), frame_->image.width,
                                        frame_->image.height, frame_->statistics.spp));
    return true;
}

std::string Editor::title() const {
    return file_.empty() ? "Untitled" : file_.filename().string();
}

bool Editor::is_modified() const {
    return history_.current() != saved_ && (!saved_ || scene() != *saved_);
}

void Editor::after_asking_to_save(std::function<void(Editor&)> action) {
    // Looking around changes the camera, but is no work that anybody would miss.
    Scene unmoved = scene();
    if (saved_) unmoved.camera = saved_->camera;
    if (saved_ && unmoved == *saved_) {
        action(*this);
    } else {
        unsaved_action = std::move(action);
    }
}

void Editor::request_quit() {
    if (!unsaved_action) after_asking_to_save([](Editor& editor) { editor.wants_quit = true; });
}

void Editor::autosave() {
    autosave_time_ = std::chrono::steady_clock::now();
    if (preferences.folder.empty() || !is_modified() || autosaved_ == history_.current()) return;
    std::error_code error;
    fs::create_directories(preferences.folder, error);
    if (auto written = write_scene(autosave_file(preferences), scene(), cache_.get()); !written) {
        log.add(LogLevel::warning, "Autosave: " + to_string(written.error()));
    }
    autosaved_ = history_.current();
}

/// What it holds is saved, or not wanted.
void Editor::discard_autosave() {
    std::error_code error;
    if (autosaved_) fs::remove(autosave_file(preferences), error);
    autosaved_.reset();
}

fs::path Editor::lost_work() const {
    std::error_code error;
    const fs::path file = lost_file(preferences);
    return fs::exists(file, error) ? file : fs::path();
}

void Editor::restore_lost_work() {
    if (const fs::path file = lost_work(); !file.empty()) {
        after_asking_to_save([file](Editor& editor) { editor.open(file); });
    }
}

}  // namespace rayuela
