#include "core/materials/bsdf.h"

#include <type_traits>

namespace rayuela {
namespace {

template <typename M>
constexpr bool kEmits = requires(const M& material) {
    material.emission();
};

/// What `function` says of the material's emission, or `otherwise` for a material that has none.
template <typename T, typename Function>
T of_emission(const Material& material, T otherwise, Function&& function) {
    return std::visit(
        [&](const auto& m) -> T {
            if constexpr (kEmits<std::decay_t<decltype(m)>>) {
                return function(m.emission());
            } else {
                return otherwise;
            }
        },
        material);
}

}  // namespace

BsdfValue Bsdf::evaluate(const Vec3& wo, const Vec3& wi) const {
    BsdfValue f = std::visit([&](const auto& lobes) { return lobes.evaluate(wo, wi); }, lobes_);
    if (!std::isfinite(f.pdf)) f = {};
    return f;
}

std::optional<BsdfSample> Bsdf::sample(const Vec3& wo, float u_lobe, const Vec2& u) const {
    using Sample = std::optional<BsdfSample>;
    Sample s = std::abs(wo.z) > 0 ? std::visit([&](const auto& lobes) { return lobes.sample(wo, u_lobe, u); }, lobes_)
                                  : Sample();
    // A density of 0, infinity or NaN comes from directions at the very edge of a lobe: rounding took them outside.
    if (s && (!(s->pdf > 0 && s->pdf < INFINITY) || !is_finite(s->wi) || is_black(s->weight))) s.reset();
    return s;
}

bool Bsdf::has_smooth_lobe() const {
    return std::visit([](const auto& lobes) { return lobes.has_smooth_lobe(); }, lobes_);
}

Bsdf make_bsdf(const Material& material, const Vec2& uv) {
    return std::visit([&](const auto& m) { return Bsdf(Bsdf::Lobes(m.bsdf(uv))); }, material);
}

Color emitted(const Material& material, const Vec2& uv, bool front) {
    return of_emission(material, Color(0), [&](const Emission& e) {
        return front || e.two_sided ? e.strength * evaluate(e.color, uv) : Color(0);
    });
}

Color emission_scale(const Material& material) {
    return of_emission(material, Color(0), [](const Emission& e) { return e.strength * e.color.value; });
}

Material put_out(Material material) {
    std::visit(
        [](auto& m) {
            if constexpr (kEmits<std::decay_t<decltype(m)>>) m.put_out();
        },
        material);
    return material;
}

bool is_emissive(const Material& material) {
    return !is_black(emission_scale(material));
}

bool emits_two_sided(const Material& material) {
    return of_emission(material, false, [](const Emission& e) { return e.two_sided; });
}

bool emits_evenly(const Material& material) {
    return of_emission(material, true, [](const Emission& e) { return e.color.texture == nullptr; });
}

bool is_specular_only(const Material& material) {
    return std::visit([](const auto& m) { return m.is_specular_only(); }, material);
}

bool has_delta_lobe(const Material& material) {
    return std::visit([](const auto& m) { return m.has_delta_lobe(); }, material);
}

bool transmits(const Material& material) {
    return std::visit([](const auto& m) { return m.transmits(); }, material);
}

}  // namespace rayuela
