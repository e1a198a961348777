#include "core/scene/scene_edit.h"

#include "core/scene/history.h"
#include "core/scene/scene_diff.h"
#include "core/scene/validate.h"
#include "tests/support/random_scene.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace rayuela {
namespace {

using ::testing::HasSubstr;

Scene must_apply(const Scene& scene, const SceneEdit& edit) {
    auto result = rayuela::apply(scene, edit);
    EXPECT_TRUE(result) << (result ? "" : to_string(result.error()));
    return result.value_or(scene);
}

std::string error_of(const Scene& scene, const SceneEdit& edit) {
    const auto result = rayuela::apply(scene, edit);
    return result ? "no error" : to_string(result.error());
}

Object object_of(const Shape& shape, ObjectId parent = {}) {
    Object object;
    object.shape = shape;
    object.parent = parent;
    return object;
}

/// Group (1) with Sphere (2) and Group 2 (3), in which is Box (4); Sphere 2 (5) beside it.
Scene nested_scene() {
    Scene scene = must_apply({}, AddObject{object_of(ObjectList{})});
    scene = must_apply(scene, AddObject{object_of(Sphere{}, ObjectId{1})});
    scene = must_apply(scene, AddObject{object_of(ObjectList{}, ObjectId{1})});
    scene = must_apply(scene, AddObject{object_of(Box{}, ObjectId{3})});
    return must_apply(scene, AddObject{object_of(Sphere{})});
}

std::vector<std::uint32_t> ids(const Scene& scene) {
    std::vector<std::uint32_t> result;
    for (const Object& object : scene.objects) result.push_back(object.id.value);
    return result;
}

TEST(SceneEdit, ObjectsGetIdsAndNames) {
    const Scene scene = nested_scene();
    EXPECT_EQ(ids(scene), (std::vector<std::uint32_t>{1, 2, 3, 4, 5}));
    EXPECT_EQ(scene.next_id, 6u);
    EXPECT_EQ(scene.objects[1].name, "Sphere");
    EXPECT_EQ(scene.objects[2].name, "Object list 2");
    EXPECT_EQ(scene.objects[4].name, "Sphere 2");
    EXPECT_TRUE(validate(scene).empty()) << to_string(validate(scene));
}

TEST(SceneEdit, UniqueNames) {
    const auto name = [](const char* wanted, std::vector<std::string> taken) {
        return unique_name(wanted, [&](const std::string& n) { return std::ranges::find(taken, n) != taken.end(); });
    };
    EXPECT_EQ(name("Sphere", {}), "Sphere");
    EXPECT_EQ(name("Sphere", {"Sphere"}), "Sphere 2");
    EXPECT_EQ(name("Sphere 2", {"Sphere", "Sphere 2", "Sphere 3"}), "Sphere 4");
    EXPECT_EQ(name("m9", {"m9"}), "m9 2");
    EXPECT_EQ(name(" 5", {" 5"}), " 5 2");
}

TEST(SceneEdit, RemovingAListRemovesWhatItHolds) {
    const Scene scene = must_apply(nested_scene(), RemoveObject{ObjectId{1}});
    EXPECT_EQ(ids(scene), (std::vector<std::uint32_t>{5}));
    EXPECT_EQ(ids(must_apply(nested_scene(), RemoveObject{ObjectId{3}})), (std::vector<std::uint32_t>{1, 2, 5}));
    EXPECT_THAT(error_of(scene, RemoveObject{ObjectId{1}}), HasSubstr("does not exist"));
}

TEST(SceneEdit, DuplicatesStandBesideTheOriginalWithTheirMembers) {
    const Scene scene = must_apply(nested_scene(), DuplicateObject{ObjectId{1}});
    EXPECT_EQ(ids(scene), (std::vector<std::uint32_t>{1, 2, 3, 4, 6, 7, 8, 9, 5}));
    EXPECT_EQ(scene.find(ObjectId{6})->name, "Object list 3");
    EXPECT_EQ(scene.find(ObjectId{7})->parent, ObjectId{6});
    EXPECT_EQ(scene.find(ObjectId{8})->parent, ObjectId{6});
    EXPECT_EQ(scene.find(ObjectId{9})->parent, ObjectId{8});
    EXPECT_TRUE(std::holds_alternative<Box>(scene.find(ObjectId{9})->shape));
    EXPECT_TRUE(validate(scene).empty()) << to_string(validate(scene));
}

TEST(SceneEdit, ANewParentComesFirst) {
    Scene scene = nested_scene();
    scene = must_apply(scene, AddObject{object_of(ObjectList{})});  // 6, last.
    Object moved = *scene.find(ObjectId{3});
    moved.parent = ObjectId{6};
    scene = must_apply(scene, SetObject{moved});
    EXPECT_EQ(ids(scene), (std::vector<std::uint32_t>{1, 2, 5, 6, 3, 4}));
    EXPECT_TRUE(validate(scene).empty()) << to_string(validate(scene));
}

TEST(SceneEdit, WhatCannotBeIsRefused) {
    const Scene scene = nested_scene();
    const auto changed = [&](std::uint32_t id, const auto& change) {
        Object object = *scene.find(ObjectId{id});
        change(object);
        return error_of(scene, SetObject{object});
    };
    EXPECT_THAT(changed(2, [](Object& o) { std::get<Sphere>(o.shape).radius = -1; }),
                HasSubstr("radius: must be > 0, is -1"));
    EXPECT_THAT(changed(2, [](Object& o) { std::get<Sphere>(o.shape).center.y = NAN; }),
                HasSubstr("center: must be a finite number"));
    EXPECT_THAT(changed(2, [](Object& o) { o.transform.scale.y = 0; }), HasSubstr("transform.scale: must not be 0"));
    EXPECT_THAT(changed(2, [](Object& o) { o.transform.rotate = Quat(0, 0, 0, 0); }), HasSubstr("unit quaternion"));
    EXPECT_THAT(changed(2,
                        [](Object& o) {
                            o.shape = Plane{};
                            o.transform.scale = Vec3(2);
                        }),
                HasSubstr("a plane takes"));
    EXPECT_THAT(changed(2, [](Object& o) { o.material = MaterialId{2}; }), HasSubstr("material: does not exist"));
    EXPECT_THAT(changed(2, [](Object& o) { o.parent = ObjectId{5}; }), HasSubstr("parent: is no list"));
    EXPECT_THAT(changed(2, [](Object& o) { o.parent = ObjectId{77}; }), HasSubstr("parent: does not exist"));
    EXPECT_THAT(changed(1, [](Object& o) { o.parent = ObjectId{3}; }), HasSubstr("cannot stand below itself"));
    EXPECT_THAT(changed(1, [](Object& o) { o.parent = ObjectId{1}; }), HasSubstr("cannot stand below itself"));
    EXPECT_THAT(changed(1, [](Object& o) { o.shape = Box{}; }), HasSubstr("cannot become another shape"));
    EXPECT_THAT(changed(4,
                        [](Object& o) {
                            o.shape = Box{Vec3(1), Vec3(0)};
                        }),
                HasSubstr("min: must be <= max in x, is 1 > 0"));
    EXPECT_THAT(error_of(scene, SetObject{}), HasSubstr("the object does not exist"));
    EXPECT_THAT(error_of(scene, SetFilm{{0, 5, PixelFilter::box}}), HasSubstr("film.width: must be >= 1, is 0"));
    EXPECT_THAT(error_of(scene, SetFilm{{5, 5, static_cast<PixelFilter>(9)}}), HasSubstr("film.filter"));
    EXPECT_THAT(error_of(scene, SetCamera{{.position = Vec3(1), .target = Vec3(1)}}),
                HasSubstr("camera.target: must differ"));
    EXPECT_THAT(error_of(scene, SetEnvironment{ConstantEnvironment{Color(-1)}}),
                HasSubstr("environment.radiance: must be >= 0"));
    RenderSettings render;
    render.accel.leaf_size = 0;
    EXPECT_THAT(error_of(scene, SetRenderSettings{render}), HasSubstr("render.kd_leaf_size: must be >= 1, is 0"));
    render = {};
    render.rr_start = -1;
    EXPECT_THAT(error_of(scene, SetRenderSettings{render}), HasSubstr("render.rr_start: must be >= 0, is -1"));
    EXPECT_THAT(error_of(scene, DuplicateObject{ObjectId{9}}), HasSubstr("does not exist"));
}

TEST(SceneEdit, MaterialsAreNamedSetAndRemoved) {
    Scene scene = must_apply({}, AddMaterial{"", Metal{}});
    scene = must_apply(scene, AddMaterial{"", Metal{}});
    scene = must_apply(scene, AddMaterial{"clay", Diffuse{}});
    EXPECT_EQ(scene.materials[0].name, "Metal");
    EXPECT_EQ(scene.materials[1].name, "Metal 2");
    EXPECT_EQ(scene.materials[2].id, MaterialId{3});
    EXPECT_THAT(error_of(scene, SetMaterial{{MaterialId{3}, "Metal", Diffuse{}}}),
                HasSubstr("name: 'Metal' is the name of another"));
    EXPECT_THAT(error_of(scene, SetMaterial{{MaterialId{3}, "", Diffuse{}}}), HasSubstr("name: must not be empty"));
    EXPECT_THAT(error_of(scene, SetMaterial{{MaterialId{9}, "x", Diffuse{}}}), HasSubstr("does not exist"));
    EXPECT_THAT(error_of(scene, SetMaterial{{MaterialId{3}, "clay", Diffuse{{Color(2), nullptr}}}}),
                HasSubstr("albedo: must be <= 1, is 2"));
    scene = must_apply(scene, SetMaterial{{MaterialId{3}, "loam", Dielectric{}}});
    EXPECT_EQ(scene.find_material("loam")->id, MaterialId{3});

    Object object = object_of(Sphere{});
    object.material = MaterialId{3};
    scene = must_apply(scene, AddObject{object});
    Object gltf = object_of(Gltf{"a.glb", nullptr, {MaterialId{1}, MaterialId{3}}});
    scene = must_apply(scene, AddObject{gltf});
    scene = must_apply(scene, RemoveMaterial{MaterialId{3}});
    EXPECT_EQ(scene.objects[0].material, MaterialId{});
    EXPECT_EQ(std::get<Gltf>(scene.objects[1].shape).materials, (std::vector{MaterialId{1}, MaterialId{}}));
    EXPECT_TRUE(validate(scene).empty());
}

TEST(Validate, NamesEveryViolation) {
    Scene scene = nested_scene();
    scene.objects[1].id = ObjectId{99};
    scene.objects[3].parent = ObjectId{5};
    std::get<Box>(scene.objects[3].shape).min.x = INFINITY;
    scene.materials = {{MaterialId{1}, "", Diffuse{}}, {MaterialId{1}, "", Diffuse{}}};
    scene.film.height = -1;
    const std::string problems = to_string(validate(scene));
    for (const char* part : {"film.height: must be >= 1, is -1", "materials[0]: has no name",
                             "materials[1]: has the id of another material", "materials[1]: has the name of another",
                             "objects[1]: has an id out of range", "objects[3].parent: does not stand before it",
                             "objects[3].min: must be a finite number"}) {
        EXPECT_THAT(problems, HasSubstr(part));
    }
}

/// Any edit the interface could make, sensible or not.
SceneEdit random_edit(testing::Rng& rng, const Scene& scene) {
    const auto object_id = [&] {
        return scene.objects.empty() || rng() % 20 == 0 ? ObjectId{static_cast<std::uint32_t>(rng() % 30)}
                                                        : scene.objects[rng() % scene.objects.size()].id;
    };
    const auto material_id = [&] {
        return scene.materials.empty() || rng() % 20 == 0 ? MaterialId{static_cast<std::uint32_t>(rng() % 30)}
                                                          : scene.materials[rng() % scene.materials.size()].id;
    };
    const auto random_object = [&] {
        Object object = object_of(testing::random_variant<Shape>(rng), rng() % 3 ? ObjectId{} : object_id());
        if (rng() % 3 == 0) object.shape = ObjectList{};
        object.transform = testing::random_transform(rng, object.shape);
        object.visible = rng() % 4 != 0;
        if (rng() % 2) object.material = material_id();
        if (rng() % 2) object.name = "thing";
        return object;
    };
    switch (rng() % 11) {
        case 0:
            return SetCamera{testing::random_value<Camera>(rng)};
        case 1:
            return SetFilm{{static_cast<int>(rng() % 50), static_cast<int>(rng() % 50), PixelFilter::tent}};
        case 2:
            return SetEnvironment{testing::random_variant<Environment>(rng)};
        case 3: {
            RenderSettings render;
            render.accel.leaf_size = static_cast<int>(rng() % 20);
            render.seed = static_cast<std::uint32_t>(rng());
            return SetRenderSettings{render};
        }
        case 4:
            return AddMaterial{rng() % 2 ? "m" : "", testing::random_variant<Material>(rng)};
        case 5:
            return SetMaterial{{material_id(), rng() % 2 ? "m" : "n", testing::random_variant<Material>(rng)}};
        case 6:
            return RemoveMaterial{material_id()};
        case 7:
            return AddObject{random_object()};
        case 8: {
            Object object = random_object();
            object.id = object_id();
            if (const Object* old = scene.find(object.id); old && rng() % 2)
                object.shape = old->shape, object.transform = old->transform;
            return SetObject{object};
        }
        case 9:
            return rng() % 2 ? SceneEdit(RemoveObject{object_id()}) : SceneEdit(AddObject{random_object()});
        default:
            return scene.objects.size() < 40 ? SceneEdit(DuplicateObject{object_id()})
                                             : SceneEdit(RemoveObject{object_id()});
    }
}

TEST(SceneEdit, AnySequenceKeepsTheInvariantsAndCanBeUndone) {
    testing::Rng rng(5);
    int accepted = 0, refused = 0;
    for (int run = 0; run < 30; ++run) {
        SceneHistory history(std::make_shared<Scene>());
        std::vector<std::shared_ptr<const Scene>> states{history.current()};
        for (int step = 0; step < 100; ++step) {
            const Scene before = *history.current();
            const auto next = rayuela::apply(before, random_edit(rng, before));  // std::apply is found too.
            EXPECT_EQ(*history.current(), before) << "an edit must not touch the scene it is applied to";
            if (!next) {
                ++refused;
                ASSERT_FALSE(next.error().empty());
                continue;
            }
            ++accepted;
            ASSERT_TRUE(validate(*next).empty()) << to_string(validate(*next));
            EXPECT_FALSE(diff(*next, *next).any());
            EXPECT_GE(next->next_id, before.next_id);
            history.push(std::make_shared<Scene>(*next), "step");
            states.push_back(history.current());
        }
        for (std::size_t i = states.size() - 1; i > 0; --i) {
            ASSERT_EQ(*history.current(), *states[i]);
            ASSERT_TRUE(history.undo());
        }
        EXPECT_FALSE(history.undo());
        EXPECT_EQ(*history.current(), Scene{});
        for (std::size_t i = 1; i < states.size(); ++i) {
            ASSERT_TRUE(history.redo());
            ASSERT_EQ(*history.current(), *states[i]);
        }
    }
    EXPECT_GT(accepted, 1000);
    EXPECT_GT(refused, 100);
}

TEST(History, AGestureIsOneStep) {
    SceneHistory history(std::make_shared<Scene>());
    for (int i = 1; i <= 5; ++i) {
        auto next = std::make_shared<Scene>(*history.current());
        next->film.width = i;
        history.push(next, "width", 7);
    }
    EXPECT_EQ(history.undo_label(), "width");
    ASSERT_TRUE(history.undo());
    EXPECT_EQ(history.current()->film.width, Scene{}.film.width);
    ASSERT_TRUE(history.redo());
    EXPECT_EQ(history.current()->film.width, 5);
}

}  // namespace
}  // namespace rayuela
