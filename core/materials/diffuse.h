#pragma once

#include "core/materials/bsdf_sample.h"
#include "core/materials/value.h"
#include "core/math/field.h"

#include <optional>

namespace rayuela {

/// Lambert on the side that wo is on.
struct DiffuseBsdf {
    Color albedo{0};

    BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const;
    std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u) const;
    bool has_smooth_lobe() const { return true; }
};

/// Lambert, two-sided.
struct Diffuse {
    using Bsdf = DiffuseBsdf;

    static constexpr std::string_view kType = "diffuse", kLabel = "Diffuse", kTip = "Matte: scatters light evenly.";

    ColorValue albedo{Color(0.8f), nullptr};

    template <typename Self, typename Visitor>
    static void visit_fields(Self& self, Visitor&& visit) {
        visit(self.albedo, Field{.key = "albedo",
                                 .label = "Albedo",
                                 .tip = "Share of the light that is reflected.",
                                 .role = FieldRole::reflectance,
                                 .min = 0,
                                 .max = 1});
    }
    DiffuseBsdf bsdf(const Vec2& uv) const;
    bool is_specular_only() const { return false; }
    bool transmits() const { return false; }
    bool has_delta_lobe() const { return false; }
    bool operator==(const Diffuse&) const = default;
};

}  // namespace rayuela
