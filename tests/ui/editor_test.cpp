#include "ui/editor.h"
#include "tests/ui/temporary_folder.h"
#include "ui/object_actions.h"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <thread>

namespace rayuela {
namespace {

using testing::HasSubstr;

void set_radius(Editor& editor, ObjectId id, float radius) {
    Object object = *editor.scene().find(id);
    std::get<Sphere>(object.shape).radius = radius;
    editor.edit(SetObject{object}, "Change radius");
}

float radius(const Editor& editor, ObjectId id) {
    return std::get<Sphere>(editor.scene().find(id)->shape).radius;
}

ObjectId add_sphere(Editor& editor) {
    add_object(editor, Sphere{});
    return *editor.selection;
}

/// Runs the editor's frames until the condition holds, at most 10 seconds.
template <typename Condition>
bool wait_until(Editor& editor, const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < end) {
        editor.begin_frame(0);
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

std::string last_log(const Editor& editor, LogLevel level) {
    std::string text;
    for (const LogEntry& entry : editor.log.entries())
        if (entry.level == level) text = entry.text;
    return text;
}

TEST(Editor, ADragIsOneStepOfUndo) {
    Editor editor({}, 1);
    const ObjectId id = add_sphere(editor);
    for (int drag = 0; drag < 2; ++drag) {
        for (int move = 1; move <= 10; ++move) {
            editor.begin_frame(42);
            set_radius(editor, id, static_cast<float>(10 * drag + move));
        }
        editor.begin_frame(0);
    }
    EXPECT_EQ(radius(editor, id), 20);
    editor.undo();
    EXPECT_EQ(radius(editor, id), 10) << "the same control held again is another drag";
    editor.undo();
    EXPECT_EQ(radius(editor, id), 1);
    editor.redo();
    editor.redo();
    EXPECT_EQ(radius(editor, id), 20);
    EXPECT_FALSE(editor.can_redo());
}

TEST(Editor, ARefusedEditChangesNothingAndSaysWhy) {
    Editor editor({}, 1);
    const ObjectId id = add_sphere(editor);
    const Scene before = editor.scene();
    Object object = *before.find(id);
    std::get<Sphere>(object.shape).radius = -1;
    EXPECT_FALSE(editor.edit(SetObject{object}, "Change radius"));
    EXPECT_EQ(editor.scene(), before);
    EXPECT_THAT(last_log(editor, LogLevel::error), HasSubstr("radius"));
    EXPECT_THAT(last_log(editor, LogLevel::error), HasSubstr("> 0"));
}

TEST(Editor, AnEditWithoutEffectIsNoStep) {
    Editor editor({}, 1);
    EXPECT_TRUE(editor.edit(SetCamera{editor.scene().camera}, "Change camera"));
    EXPECT_FALSE(editor.can_undo());
    EXPECT_FALSE(editor.is_modified());
}

TEST(Editor, TheFilmTakesTheWindowsSizeWithoutBeingEdited) {
    Editor editor({}, 1);
    const FilmSettings own = editor.scene().film;
    editor.resize_film(321, 123);
    EXPECT_EQ(editor.shown().film.width, 321);
    EXPECT_EQ(editor.shown().film.height, 123);
    EXPECT_EQ(editor.scene().film, own);
    EXPECT_FALSE(editor.can_undo());
    EXPECT_FALSE(editor.is_modified());
    editor.view.match_window = false;
    editor.begin_frame(0);
    EXPECT_EQ(editor.shown().film, own);
    editor.resize_film(50, 50);
    EXPECT_EQ(editor.shown().film, own);
}

TEST(Editor, SelectionEndsWithItsObject) {
    Editor editor({}, 1);
    const ObjectId id = add_sphere(editor);
    EXPECT_EQ(editor.selection, id);
    delete_selection(editor);
    EXPECT_FALSE(editor.selection);
    editor.undo();
    editor.selection = id;
    editor.undo();
    EXPECT_FALSE(editor.selection) << "undoing the addition takes the selection along";
}

TEST(Editor, SavedAndOpenedAgainTheSceneIsTheSame) {
    const TemporaryFolder folder;
    Editor editor({}, 1);
    add_sphere(editor);
    add_object(editor, Quad{});
    add_material(editor, "gold", Metal{});
    EXPECT_TRUE(editor.is_modified());
    const auto file = folder.path() / "a.scene.json";
    ASSERT_TRUE(editor.save_as(file)) << last_log(editor, LogLevel::error);
    EXPECT_FALSE(editor.is_modified());
    EXPECT_EQ(editor.title(), "a.scene.json");

    Editor other({}, 1);
    other.open(file);
    EXPECT_TRUE(other.is_loading());
    ASSERT_TRUE(wait_until(other, [&] { return !other.is_loading(); }));
    EXPECT_EQ(other.file(), file);
    EXPECT_FALSE(other.is_modified());
    ASSERT_EQ(other.scene().objects.size(), 2u);
    // Ids are given anew by a reader; everything else is what was saved.
    const Scene &saved = editor.scene(), &read = other.scene();
    EXPECT_EQ(read.camera, saved.camera);
    EXPECT_EQ(read.environment, saved.environment);
    EXPECT_EQ(read.render, saved.render);
    ASSERT_EQ(read.materials.size(), 1u);
    EXPECT_EQ(read.materials[0].name, "gold");
    EXPECT_EQ(read.materials[0].material, saved.materials[0].material);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read.objects[i].name, saved.objects[i].name);
        EXPECT_EQ(read.objects[i].shape, saved.objects[i].shape);
        EXPECT_EQ(read.objects[i].transform, saved.objects[i].transform);
    }
}

TEST(Editor, AFileThatCannotBeOpenedLeavesTheScene) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "broken.scene.json";
    std::ofstream(file) << R"({"rayuela": 1, "objects": [{"type": "sphere", "radius": -1}]})";
    Editor editor({}, 1);
    add_sphere(editor);
    const Scene before = editor.scene();
    for (const auto& path : {file, folder.path() / "missing.scene.json"}) {
        editor.open(path);
        ASSERT_TRUE(wait_until(editor, [&] { return !editor.is_loading(); }));
        EXPECT_EQ(editor.scene(), before);
        EXPECT_TRUE(editor.file().empty());
    }
    std::string errors;
    for (const LogEntry& entry : editor.log.entries())
        if (entry.level == LogLevel::error) errors += entry.text + "\n";
    EXPECT_THAT(errors, HasSubstr("objects[0].radius"));
    EXPECT_THAT(errors, HasSubstr("missing.scene.json"));
}

TEST(Editor, OnlyTheFileOpenedLastCounts) {
    const TemporaryFolder folder;
    const auto first = folder.path() / "first.scene.json", second = folder.path() / "second.scene.json";
    std::ofstream(first) << R"({"rayuela": 1, "objects": [{"type": "sphere"}]})";
    std::ofstream(second) << R"({"rayuela": 1})";
    Editor editor({}, 1);
    editor.open(first);
    editor.open(second);
    ASSERT_TRUE(wait_until(editor, [&] { return !editor.is_loading(); }));
    EXPECT_EQ(editor.file(), second);
    EXPECT_TRUE(editor.scene().objects.empty());
}

TEST(Editor, ImportIsOneStepAndSelectsWhatCame) {
    const TemporaryFolder folder;
    const auto mesh = folder.path() / "tri.obj";
    std::ofstream(mesh) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    Editor editor({}, 1);
    editor.import(mesh);
    ASSERT_TRUE(wait_until(editor, [&] { return !editor.is_loading(); }));
    ASSERT_EQ(editor.scene().objects.size(), 1u) << last_log(editor, LogLevel::error);
    EXPECT_EQ(editor.selection, editor.scene().objects[0].id);
    const Mesh* shape = std::get_if<Mesh>(&editor.scene().objects[0].shape);
    ASSERT_TRUE(shape && shape->data);
    EXPECT_EQ(shape->data->triangles.size(), 1u);
    editor.undo();
    EXPECT_TRUE(editor.scene().objects.empty());
    EXPECT_FALSE(editor.can_undo());
}

TEST(Editor, MeshOfAnObjectIsReplacedInPlace) {
    const TemporaryFolder folder;
    const auto one = folder.path() / "one.obj", two = folder.path() / "two.obj";
    std::ofstream(one) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ofstream(two) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
    Editor editor({}, 1);
    editor.import(one);
    ASSERT_TRUE(wait_until(editor, [&] { return !editor.is_loading(); }));
    const ObjectId id = *editor.selection;
    rename_object(editor, id, "tile");
    editor.load_object_data(id, two);
    ASSERT_TRUE(wait_until(editor, [&] { return !editor.is_loading(); }));
    ASSERT_EQ(editor.scene().objects.size(), 1u);
    EXPECT_EQ(editor.scene().objects[0].id, id);
    EXPECT_EQ(editor.scene().objects[0].name, "tile");
    EXPECT_EQ(std::get<Mesh>(editor.scene().objects[0].shape).data->triangles.size(), 2u);
}

TEST(Editor, PauseResumeAndLimits) {
    Editor editor({}, 1);
    editor.sampling.adaptive = false;  // without a limit there is no end
    editor.resize_film(32, 24);
    RenderSettings render = editor.scene().render;
    render.max_samples = 5;
    editor.edit(SetRenderSettings{render}, "Limit");
    ASSERT_TRUE(wait_until(
        editor, [&] { return editor.frame() && editor.frame()->statistics.phase == SessionPhase::finished; }));
    EXPECT_EQ(editor.frame()->statistics.spp, 5);

    // Raising the limit goes on; pausing stops it on the way.
    const std::uint64_t restarts = editor.frame()->statistics.restarts;
    render.max_samples = 0;
    editor.edit(SetRenderSettings{render}, "Limit");
    ASSERT_TRUE(wait_until(editor, [&] { return editor.frame()->statistics.spp > 5; }));
    EXPECT_EQ(editor.frame()->statistics.restarts, restarts);
    editor.paused = true;
    ASSERT_TRUE(wait_until(editor, [&] { return editor.session().status().phase == SessionPhase::paused; }));
    editor.paused = false;
    ASSERT_TRUE(wait_until(editor, [&] { return editor.session().status().phase == SessionPhase::rendering; }));
}

TEST(Editor, AsksBeforeUnsavedWorkIsLostButNotForACameraMove) {
    Editor editor({}, 1);
    Camera camera = editor.scene().camera;
    camera.position.x += 1;
    editor.edit(SetCamera{camera}, "Orbit");
    EXPECT_TRUE(editor.is_modified());
    bool done = false;
    editor.after_asking_to_save([&](Editor&) { done = true; });
    EXPECT_TRUE(done);

    add_sphere(editor);
    editor.request_quit();
    EXPECT_FALSE(editor.wants_quit);
    ASSERT_TRUE(editor.unsaved_action);
    editor.unsaved_action(editor);
    EXPECT_TRUE(editor.wants_quit);
}

TEST(Editor, MovingIntoAListKeepsThePlaceInTheWorld) {
    Editor editor({}, 1);
    add_object(editor, ObjectList{});
    const ObjectId list = *editor.selection;
    Object group = *editor.scene().find(list);
    group.transform.translate = {1, 2, 3};
    group.transform.scale = Vec3(2);
    ASSERT_TRUE(editor.edit(SetObject{group}, "Move"));
    editor.selection.reset();
    const ObjectId sphere = add_sphere(editor);
    const Affine before = editor.scene().to_world(sphere);
    move_into(editor, sphere, list);
    ASSERT_EQ(editor.scene().find(sphere)->parent, list);
    const Affine after = editor.scene().to_world(sphere);
    EXPECT_LT(glm::distance(after.translation, before.translation), 1e-5f);
    for (int axis = 0; axis < 3; ++axis) EXPECT_LT(glm::distance(after.linear[axis], before.linear[axis]), 1e-5f);
    move_into(editor, sphere, {});
    EXPECT_FALSE(editor.scene().find(sphere)->parent);
}

TEST(Editor, SavesTheImageAsShownOrLinear) {
    const TemporaryFolder folder;
    Editor editor({}, 1);
    EXPECT_FALSE(editor.save_image(folder.path() / "none.png")) << "there is no image yet";
    editor.resize_film(16, 8);
    ASSERT_TRUE(wait_until(editor, [&] { return editor.frame() && !editor.frame()->coarse; }));
    for (const char* name : {"a.png", "a.exr", "a.pfm"}) {
        EXPECT_TRUE(editor.save_image(folder.path() / name)) << last_log(editor, LogLevel::error);
        EXPECT_TRUE(std::filesystem::exists(folder.path() / name));
    }
    EXPECT_FALSE(editor.save_image(folder.path() / "no such folder" / "a.png"));
}

TEST(Editor, AutosaveLeavesNoTraceWithoutAFolder) {
    EXPECT_TRUE(Preferences{}.folder.empty());
    Editor editor({}, 1);
    add_sphere(editor);
    editor.autosave();
    EXPECT_FALSE(std::filesystem::exists("autosave.scene.json"));
    EXPECT_TRUE(editor.lost_work().empty());
}

TEST(Editor, WhatWasAutosavedBeforeACrashCanBeRestored) {
    const TemporaryFolder clean, crashed;
    const auto autosaved = clean.path() / "autosave.scene.json";
    const Preferences preferences{.folder = clean.path(), .first_start = false};
    {
        Editor editor(preferences, 1);
        editor.autosave();
        EXPECT_FALSE(std::filesystem::exists(autosaved)) << "nothing was changed";
        set_radius(editor, add_sphere(editor), 7);
        editor.autosave();
        ASSERT_TRUE(std::filesystem::exists(autosaved));
        std::filesystem::copy(autosaved, crashed.path() / autosaved.filename());
        ASSERT_TRUE(editor.save_as(clean.path() / "a.scene.json"));
        EXPECT_FALSE(std::filesystem::exists(autosaved)) << "saved";
        add_sphere(editor);
        editor.autosave();
        EXPECT_TRUE(std::filesystem::exists(autosaved));
    }
    EXPECT_FALSE(std::filesystem::exists(autosaved)) << "ended as it should";
    EXPECT_FALSE(Editor(preferences, 1).panels.show_lost_work);

    for (int start = 0; start < 2; ++start) {
        Editor editor({.folder = crashed.path(), .first_start = false}, 1);
        EXPECT_EQ(editor.panels.show_lost_work, start == 0) << "asked once";
        ASSERT_FALSE(editor.lost_work().empty());
        editor.restore_lost_work();
        ASSERT_TRUE(wait_until(editor, [&] { return !editor.is_loading(); }));
        ASSERT_EQ(editor.scene().objects.size(), 1u);
        EXPECT_EQ(std::get<Sphere>(editor.scene().objects[0].shape).radius, 7);
        EXPECT_TRUE(editor.is_modified());
        EXPECT_TRUE(editor.file().empty());
        EXPECT_TRUE(editor.preferences.recent_files.empty());
    }
}

}  // namespace
}  // namespace rayuela
