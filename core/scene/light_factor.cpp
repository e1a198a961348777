#include "core/scene/light_factor.h"

#include "core/materials/bsdf.h"
#include "core/math/float_error.h"

#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace rayuela {

namespace {

/// Of what is scaled. Far from where the samples of the image would leave the range of floats or lose digits there.
constexpr float kDimmest = 0x1p-40f, kBrightest = 0x1p40f;
/// Factors that are the same but for this much are: those of values that have been rounded to floats.
constexpr double kRounding = 4 * kUnitRoundoff;

/// The factor of all sources, as far as they have been seen.
class CommonFactor {
public:
    /// False where this source has another.
    bool add(const Color& before, const Color& after) {
        return add(0, before, after) && add(1, before, after) && add(2, before, after);
    }
    Vec3d value() const { return {factor_[0].value_or(1), factor_[1].value_or(1), factor_[2].value_or(1)}; }

private:
    bool add(int channel, const Color& before, const Color& after) {
        const float a = before[channel], b = after[channel];
        if (a == 0 && b == 0) return true;
        if (a != b && !(in_range(a) && (b == 0 || in_range(b)))) return false;
        const double factor = a == b ? 1 : static_cast<double>(b) / static_cast<double>(a);
        std::optional<double>& common = factor_[static_cast<std::size_t>(channel)];
        if (!common) common = factor;
        return std::abs(factor - *common) <= kRounding * *common;
    }
    static bool in_range(float radiance) { return radiance >= kDimmest && radiance <= kBrightest; }

    std::array<std::optional<double>, 3> factor_;
};

/// Materials that visible objects may show.
std::unordered_set<MaterialId> shown_materials(const Scene& scene) {
    std::unordered_set<MaterialId> shown;
    std::unordered_set<ObjectId> hidden;
    for (const Object& object : scene.objects) {
        if (!object.visible || hidden.contains(object.parent)) {
            hidden.insert(object.id);
        } else if (const auto* gltf = std::get_if<Gltf>(&object.shape); gltf && !object.material) {
            shown.insert(gltf->materials.begin(), gltf->materials.end());
        } else if (!std::holds_alternative<ObjectList>(object.shape)) {
            shown.insert(object.material);
        }
    }
    return shown;
}

bool add_material(CommonFactor& factor, const Material& before, const Material& after) {
    if (before != after && put_out(before) != put_out(after)) return false;
    return factor.add(emission_scale(before), emission_scale(after));
}

bool add_environment(CommonFactor& factor, const Environment& before, const Environment& after) {
    if (before.index() != after.index()) return false;
    return std::visit(
        [&]<typename T>(T a) {
            T b = std::get<T>(after);
            const auto old_light = a.light(), new_light = b.light();
            a.put_out();
            b.put_out();
            bool common = a == b;
            for (std::size_t i = 0; i < old_light.size(); ++i)
                common = common && factor.add(old_light[i], new_light[i]);
            return common;
        },
        before);
}

}  // namespace

std::optional<Vec3d> light_factor(const Scene& before, const Scene& after) {
    CommonFactor factor;
    if (!add_environment(factor, before.environment, after.environment)) return std::nullopt;
    std::unordered_map<MaterialId, const Material*> olds;
    for (const MaterialEntry& entry : before.materials) olds.emplace(entry.id, &entry.material);
    const std::unordered_set<MaterialId> shown = shown_materials(after);
    for (const MaterialEntry& entry : after.materials) {
        if (!shown.contains(entry.id)) continue;
        const auto old = olds.find(entry.id);
        if (old == olds.end() || !add_material(factor, *old->second, entry.material)) return std::nullopt;
    }
    return factor.value();
}

}  // namespace rayuela
