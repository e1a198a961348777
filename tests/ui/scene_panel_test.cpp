#include "tests/ui/panel_testing.h"
#include "ui/object_actions.h"
#include "ui/variants.h"

#include <algorithm>

namespace rayuela {
namespace {

TEST_F(PanelTest, EveryShapeOfTheListCanBeAdded) {
    for_each_type<Shape>([&]<typename T>() {
        if (needs_file<T>()) return;
        const std::size_t count = scene().objects.size();
        run([&](ImGuiTestContext* script) {
            script->ItemClick("//Scene/###add");
            script->ItemClick(("//$FOCUSED/###" + std::string(T::kType)).c_str());
        });
        ASSERT_EQ(scene().objects.size(), count + 1) << T::kLabel;
        const Object& added = scene().objects.back();
        EXPECT_TRUE(std::holds_alternative<T>(added.shape)) << T::kLabel;
        EXPECT_EQ(editor().selection, added.id);
        editor().selection.reset();
    });
    ASSERT_TRUE(draw_until_rendered());
}

TEST_F(PanelTest, OutlinerSelectsHidesRenamesDuplicatesAndDeletes) {
    const ObjectId id = ball().id;
    run([&](ImGuiTestContext* script) { script->ItemClick(row(script, id)); });
    EXPECT_EQ(editor().selection, id);

    run([&](ImGuiTestContext* script) { script->ItemClick(row(script, id, "###visible")); });
    EXPECT_FALSE(ball().visible);
    ASSERT_TRUE(draw_until_rendered());
    EXPECT_EQ(std::ranges::count(editor().frame()->object_ids, id.value), 0) << "a hidden object is not rendered";
    run([&](ImGuiTestContext* script) { script->ItemClick(row(script, id, "###visible")); });
    EXPECT_TRUE(ball().visible);

    run([&](ImGuiTestContext* script) {
        script->KeyPress(ImGuiKey_F2);
        script->Yield(2);
        script->KeyCharsReplaceEnter("Marble");
        script->Yield(2);
    });
    EXPECT_EQ(ball().name, "Marble");

    run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiMod_Ctrl | ImGuiKey_D); });
    ASSERT_EQ(scene().objects.size(), 3u);
    const ObjectId copy = *editor().selection;
    EXPECT_NE(copy, id);
    EXPECT_EQ(scene().find(copy)->shape, scene().find(id)->shape);

    run([&](ImGuiTestContext* script) { script->KeyPress(ImGuiKey_X); });
    EXPECT_FALSE(scene().find(copy));
    EXPECT_FALSE(editor().selection);
}

TEST_F(PanelTest, AnObjectDroppedOnAListGoesIntoIt) {
    editor().selection.reset();
    add_object(editor(), ObjectList{});
    const ObjectId list = *editor().selection, id = ball().id;
    run([&](ImGuiTestContext* script) { script->ItemDragAndDrop(row(script, id), row(script, list)); });
    EXPECT_EQ(scene().find(id)->parent, list);
}

TEST_F(PanelTest, SearchShowsOnlyWhatMatches) {
    editor().panels.scene_filter = "bAl";
    run([&](ImGuiTestContext* script) {
        script->Yield(2);
        EXPECT_TRUE(script->ItemExists(row(script, ball().id)));
        EXPECT_FALSE(script->ItemExists(row(script, scene().objects[0].id)));
    });
}

}  // namespace
}  // namespace rayuela
