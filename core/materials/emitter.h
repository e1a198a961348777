#pragma once

#include "core/materials/bsdf_sample.h"
#include "core/materials/value.h"
#include "core/math/field.h"

#include <optional>

namespace rayuela {

/// Absorbs everything.
struct BlackBsdf {
    BsdfValue evaluate(const Vec3&, const Vec3&) const { return {}; }
    std::optional<BsdfSample> sample(const Vec3&, float, const Vec2&) const { return std::nullopt; }
    bool has_smooth_lobe() const { return false; }
};

/// Emits from the front (outside) and reflects nothing.
struct Emitter {
    using Bsdf = BlackBsdf;

    static constexpr std::string_view kType = "emitter", kLabel = "Emitter", kTip = "A light source.";

    ColorValue radiance{Color(5), nullptr};
    bool two_sided = false;

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.radiance, Field{.key = "radiance",
                                   .label = "Radiance",
                                   .tip = "Light that leaves the surface.",
                                   .role = FieldRole::radiance,
                                   .min = 0,
                                   .soft_min = 0,
                                   .soft_max = 50});
        visit(self.two_sided, Field{"two_sided", "Two-sided", "Emit from the back as well."});
    }
    BlackBsdf bsdf(const Vec2&) const { return {}; }
    bool is_specular_only() const { return true; }
    bool transmits() const { return false; }
    bool has_delta_lobe() const { return false; }
    Emission emission() const { return {radiance, 1, two_sided}; }
    void put_out() { radiance.value = Color(0); }
    bool operator==(const Emitter&) const = default;
};

}  // namespace rayuela
