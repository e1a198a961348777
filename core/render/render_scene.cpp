#include "core/render/render_scene.h"

#include "core/accel/parallel.h"
#include "core/accel/traced_object.h"
#include "core/materials/textures.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace rayuela {

namespace {

PackedMaterial pack(const Material& material) {
    bool textured = false;
    for_each_texture(material, [&](const auto& texture) { textured |= texture != nullptr; });
    const bool emissive = is_emissive(material);
    return {.material = material,
            .bsdf = make_bsdf(material, Vec2(0)),
            .textured = textured,
            .emissive = emissive,
            .smooth = !is_specular_only(material),
            .transmits = transmits(material),
            .delta = has_delta_lobe(material),
            .packed = emissive ? std::nullopt : packed_bsdf(material, Vec2(0))};
}

bool same_ids(const Scene& a, const Scene& b) {
    return std::ranges::equal(a.materials, b.materials, {}, &MaterialEntry::id, &MaterialEntry::id);
}

/// The shape as rays meet it, unless it is a group or its file is missing. glTF files are flattened into their parts.
std::optional<TracedShape> traced_shape(const Shape& shape) {
    return std::visit(
        [](const auto& s) -> std::optional<TracedShape> {
            using T = std::decay_t<decltype(s)>;
            if constexpr (std::is_constructible_v<TracedShape, const T&>) {
                return s;
            } else if constexpr (std::is_same_v<T, Mesh>) {
                if (s.data) return s.data;
            }
            return std::nullopt;
        },
        shape);
}

/// Order in which objects are numbered: ties of distance go to the lowest. Where a body stands on a surface the surface
/// is met, in whatever order the scene lists them: light that left the body there would start beyond the surface.
int tie_rank(const GeometryInstance& instance) {
    if (std::holds_alternative<Sphere>(instance.shape) || std::holds_alternative<Box>(instance.shape)) return 2;
    return std::holds_alternative<std::shared_ptr<const TriangleMesh>>(instance.shape) ? 1 : 0;
}

/// A ball that holds the instance, if it is anywhere.
std::optional<Ball> ball_around(const GeometryInstance& instance) {
    if (std::holds_alternative<Plane>(instance.shape)) return Ball{Vec3(0), kInfinity};
    if (const auto* sphere = std::get_if<Sphere>(&instance.shape)) {
        if (const auto world = world_sphere(*sphere, instance.to_world)) {
            return Ball{Vec3(world->center), static_cast<float>(world->radius)};
        }
    }
    const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape);
    const Bounds3 bounds = world_bounds(TracedObject(instance), instance, mesh ? (*mesh)->bounds : Bounds3());
    if (bounds.empty() || !is_finite(bounds.lo) || !is_finite(bounds.hi)) return std::nullopt;
    return Ball{bounds.center(), 0.5f * glm::length(bounds.extent())};
}

std::uint64_t bytes(const TriangleMesh& mesh) {
    return mesh.memory_bytes();
}

std::uint64_t bytes(const Image& image) {
    return image.pixels.size() * sizeof(Vec4) + (image.encoded ? image.encoded->source_bytes() : 0);
}

/// The middle of the objects where they are many times their extent away from 0 and can be moved there without rounding.
Vec3 origin_near(std::span<const GeometryInstance> instances) {
    constexpr float kFar = 16;
    Bounds3 bounds;
    for (const GeometryInstance& instance : instances) {
        const TracedObject object(instance);
        const TriangleMesh* mesh = object.mesh();
        bounds.extend(world_bounds(object, instance, mesh ? mesh->bounds : Bounds3()));
    }
    const Vec3 middle = bounds.center();
    if (bounds.empty() || !is_finite(middle)) return Vec3(0);
    if (!(max_component(glm::abs(middle)) > kFar * max_component(bounds.extent()))) return Vec3(0);
    const auto moves_exactly = [&](const GeometryInstance& instance) {
        const Vec3& t = instance.to_world.translation;
        return Vec3d(t - middle) == Vec3d(t) - Vec3d(middle);
    };
    return std::ranges::all_of(instances, moves_exactly) ? middle : Vec3(0);
}

}  // namespace

Camera RenderScene::camera() const {
    Camera camera = scene_->camera;
    camera.position -= origin_;
    camera.target -= origin_;
    return camera;
}

void RenderScene::flatten(std::vector<GeometryInstance>& instances, FlatObjects& objects) const {
    struct Placement {
        Affine to_world;
        bool visible;
    };
    std::vector<std::pair<GeometryInstance, FlatObject>> found;
    std::unordered_map<ObjectId, Placement> lists;  // Parents come before their children.
    std::unordered_map<MaterialId, std::uint32_t> material_index{{MaterialId{}, 0}};
    for (const MaterialEntry& entry : scene_->materials) {
        material_index.emplace(entry.id, static_cast<std::uint32_t>(material_index.size()));
    }
    for (const Object& object : scene_->objects) {
        Placement placement{object.transform.affine(), object.visible};
        if (object.parent) {
            const Placement& parent = lists.at(object.parent);
            placement = {parent.to_world * placement.to_world, parent.visible && placement.visible};
        }
        if (std::holds_alternative<ObjectList>(object.shape)) lists.emplace(object.id, placement);
        if (!placement.visible) continue;
        if (const auto* gltf = std::get_if<Gltf>(&object.shape); gltf && gltf->geometry) {
            for (const GltfPart& part : gltf->geometry->parts) {
                const MaterialId own =
                    part.material < gltf->materials.size() ? gltf->materials[part.material] : MaterialId{};
                found.push_back({{part.mesh, placement.to_world * part.to_file},
                                 {object.id, material_index.at(object.material ? object.material : own)}});
            }
        } else if (auto shape = traced_shape(object.shape)) {
            found.push_back({{*std::move(shape), placement.to_world}, {object.id, material_index.at(object.material)}});
        }
    }
    std::ranges::stable_sort(found, {}, [](const auto& one) { return tie_rank(one.first); });
    for (auto& [instance, object] : found) {
        instances.push_back(std::move(instance));
        objects.push_back(object);
    }
}

std::shared_ptr<const RenderScene> RenderScene::update(const RenderScene* previous, std::shared_ptr<const Scene> scene,
                                                       const SceneChanges& changes, BuildControl& control,
                                                       const Shortcuts& shortcuts, bool draft) {
    auto next = previous ? std::make_shared<RenderScene>(*previous) : std::make_shared<RenderScene>();
    next->scene_ = std::move(scene);
    const bool materials = !previous || changes.materials;
    const bool geometry = !previous || changes.geometry;
    const bool trees = geometry || changes.accel;
    const bool objects = trees || changes.assignment || (materials && !same_ids(*previous->scene_, *next->scene_));

    if (objects) {
        std::vector<GeometryInstance> instances;
        FlatObjects flat;
        next->flatten(instances, flat);
        if (geometry) next->origin_ = origin_near(instances);
        for (GeometryInstance& instance : instances) instance.to_world.translation -= next->origin_;
        next->objects_ = std::make_shared<const FlatObjects>(std::move(flat));
        if (trees) {
            AccelSettings settings = next->scene_->render.accel;
            settings.few_objects = shortcuts.few_objects;
            settings.draft = draft;
            next->accelerator_ = Accelerator::build(std::move(instances), settings,
                                                    previous ? &previous->accelerator() : nullptr, control);
            if (!next->accelerator_) return nullptr;
        }
    }
    if (materials || (objects && next->used_materials() != previous->used_materials())) next->pack_materials();
    if (geometry || next->textured_objects() != previous->textured_objects()) next->find_surfaces();
    if (!previous || changes.environment) next->environment_ = EnvironmentLight(next->scene_->environment);
    const bool may_shine = materials || objects || changes.environment || changes.sampling;
    const bool same_lights = !may_shine || next->update_lights(previous);
    next->features_ = next->find_features();
    if (may_shine) next->update_emission(previous, same_lights);
    return next;
}

/// The same objects by other settings, in the trees of `better` (may be null) for the meshes that are there.
std::shared_ptr<const Accelerator> RenderScene::rebuilt(const AccelSettings& settings, const Accelerator* better,
                                                        BuildControl& control) const {
    const auto instances = accelerator_->instances();
    return Accelerator::build({instances.begin(), instances.end()}, settings, accelerator_.get(), control, better);
}

std::shared_ptr<const Accelerator> RenderScene::without_drafts(BuildControl& control) const {
    AccelSettings settings = accelerator_->settings();
    settings.draft = false;
    return rebuilt(settings, nullptr, control);
}

std::shared_ptr<const RenderScene> RenderScene::with_trees(const Accelerator& known) const {
    BuildControl control;
    auto next = std::make_shared<RenderScene>(*this);
    next->accelerator_ = rebuilt(accelerator_->settings(), &known, control);
    return next;
}

/// Of all materials, whether a visible object has it.
std::vector<bool> RenderScene::used_materials() const {
    std::vector<bool> used(scene_->materials.size() + 1, false);
    for (const FlatObject& object : *objects_) used[object.material] = true;
    return used;
}

/// Images are decoded for the materials in use.
void RenderScene::pack_materials() {
    const std::vector<MaterialEntry>& entries = scene_->materials;
    const std::vector<bool> used = used_materials();
    std::vector<Problems> problems(entries.size());
    PackedMaterials packed(entries.size() + 1, pack(kDefaultMaterial));
    parallel_ranges(entries.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto lost = [&](const Image& image) {
                problems[i].push_back({image.source, "", "cannot be decoded: shown without this image"});
            };
            packed[i + 1] = pack(used[i + 1] ? with_pixels(entries[i].material, lost) : entries[i].material);
        }
    });
    materials_ = std::make_shared<const PackedMaterials>(std::move(packed));
    problems_.clear();
    for (const Problems& found : problems) problems_.insert(problems_.end(), found.begin(), found.end());
}

std::vector<std::uint8_t> RenderScene::textured_objects() const {
    std::vector<std::uint8_t> textured;
    for (const FlatObject& object : *objects_) textured.push_back((*materials_)[object.material].textured ? 1 : 0);
    return textured;
}

/// Texture coordinates are in memory where textures read them.
void RenderScene::find_surfaces() {
    surfaces_ = std::make_shared<const Surfaces>(accelerator_->instances(), textured_objects());
}

/// Whether the lights are those of `previous` (may be null), but for the numbers of their objects.
bool RenderScene::update_lights(const RenderScene* previous) {
    const bool panorama = environment_.image() || (previous && previous->environment_.image());
    const bool sky = previous && panorama && scene_->environment != previous->scene_->environment;
    const bool same_choice = previous && scene_->render.light_choice == previous->scene_->render.light_choice;
    const bool same = same_choice && !sky && same_lamps(*previous);
    if (!same) {
        std::vector<const Material*> of_instances;
        for (const FlatObject& object : *objects_) of_instances.push_back(&(*materials_)[object.material].material);
        lights_ = std::make_shared<const LightTable>(accelerator_->instances(), of_instances, scene_->environment,
                                                     scene_->render.light_choice);
        return false;
    }
    const std::vector<std::uint32_t> from = previous->objects_with(&PackedMaterial::emissive);
    const std::vector<std::uint32_t> to = objects_with(&PackedMaterial::emissive);
    if (from != to) lights_ = std::make_shared<const LightTable>(lights_->renumbered(from, to, objects_->size()));
    return true;
}

void RenderScene::update_emission(const RenderScene* previous, bool same_lights) {
    const bool same = previous && same_lights && same_targets(*previous) &&
                      features_.light_sampling() == previous->features_.light_sampling();
    if (!same) {
        emission_ = find_emission();
    } else if (emission_ && lights_ != previous->lights_) {
        emission_ = std::make_shared<const LightEmission>(emission_->renumbered(lights_));
    }
}

std::vector<std::uint32_t> RenderScene::objects_with(bool PackedMaterial::*property) const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < objects_->size(); ++i) {
        if (packed_material(i).*property) found.push_back(i);
    }
    return found;
}

/// Whether the same lamps stand at the same places.
bool RenderScene::same_lamps(const RenderScene& other) const {
    return std::ranges::equal(objects_with(&PackedMaterial::emissive), other.objects_with(&PackedMaterial::emissive),
                              [&](std::uint32_t i, std::uint32_t j) {
                                  return accelerator_->instances()[i] == other.accelerator_->instances()[j] &&
                                         material(i) == other.material(j);
                              });
}

/// Whether the same mirrors and glass stand at the same places.
bool RenderScene::same_targets(const RenderScene& other) const {
    return std::ranges::equal(objects_with(&PackedMaterial::delta), other.objects_with(&PackedMaterial::delta),
                              [&](std::uint32_t i, std::uint32_t j) {
                                  return accelerator_->instances()[i] == other.accelerator_->instances()[j];
                              });
}

std::shared_ptr<const LightEmission> RenderScene::find_emission() const {
    if (!features_.emitters || !features_.light_sampling()) return nullptr;
    std::vector<Ball> targets;
    for (const std::uint32_t i : objects_with(&PackedMaterial::delta)) {
        if (const auto ball = ball_around(accelerator_->instances()[i])) targets.push_back(*ball);
    }
    if (targets.empty()) return nullptr;
    auto emission = std::make_shared<const LightEmission>(lights_, std::move(targets));
    return emission->empty() ? nullptr : emission;
}

Features RenderScene::find_features() const {
    Features features{
        .environment = !environment_.is_black(), .lights = !lights_->empty(), .lens = scene_->camera.lens_radius > 0};
    const std::vector<bool> used = used_materials();
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        features.emitters |= (*materials_)[i].emissive;
        features.smooth_surfaces |= (*materials_)[i].smooth;
        features.textures |= (*materials_)[i].textured;
    }
    return features;
}

std::uint64_t RenderScene::memory_bytes() const {
    const AccelStats trees = accelerator_->stats();
    std::uint64_t total = trees.memory_bytes + trees.kept_bytes + surfaces_->memory_bytes() + lights_->memory_bytes() +
                          (emission_ ? emission_->memory_bytes() : 0);
    std::unordered_set<const void*> seen;
    const auto add = [&](const auto& data) {
        if (seen.insert(&data).second) total += bytes(data);
    };
    for (const GeometryInstance& instance : accelerator_->instances()) {
        if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape)) add(**mesh);
    }
    for (const PackedMaterial& packed : *materials_) {
        for_each_texture(packed.material, [&](const auto& texture) {
            if (texture) add(*texture);
        });
    }
    if (const Image* image = environment_.image()) add(*image);
    return total;
}

}  // namespace rayuela
