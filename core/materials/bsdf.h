#pragma once

#include "core/materials/bsdf_sample.h"
#include "core/materials/material.h"
#include "core/math/vec.h"

#include <optional>
#include <variant>

namespace rayuela {

/// A material at one point: textures evaluated, parameters clamped, pure from here on. Directions are unit, in the local
/// frame whose +z is the shading normal on the side of the geometric front, and point away from the surface. Radiance is
/// scaled as basic radiance L / n^2: what passes a surface is not multiplied by a ratio of squared indices, which would
/// cancel wherever light leaves a body again. Bad input (wo in the surface, NaN) gives black, density 0 or nothing.
class Bsdf {
public:
    /// f(wo, wi) * |cos(wi)|; delta lobes contribute nothing.
    Color eval(const Vec3& wo, const Vec3& wi) const { return evaluate(wo, wi).value; }
    /// Density per solid angle with which `sample` draws wi; delta lobes contribute nothing.
    float pdf(const Vec3& wo, const Vec3& wi) const { return evaluate(wo, wi).pdf; }
    /// Both at once, for little more than the price of one.
    BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const;
    /// `u_lobe` in [0, 1) chooses among lobes, `u` in [0, 1)^2 a direction. Nothing where all light is absorbed.
    std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u) const;
    /// Whether any lobe is not a delta: only then can a light sample contribute.
    bool has_smooth_lobe() const;

private:
    friend Bsdf make_bsdf(const Material& material, const Vec2& uv);

    template <typename List>
    struct BsdfsOf;
    template <typename... Materials>
    struct BsdfsOf<std::variant<Materials...>> {
        using type = std::variant<typename Materials::Bsdf...>;
    };
    /// One alternative for each material of the list.
    using Lobes = BsdfsOf<Material>::type;

    explicit Bsdf(const Lobes& lobes) : lobes_(lobes) {}

    Lobes lobes_;
};

/// The material at texture coordinates uv. Which side wo is on decides between entering and leaving.
Bsdf make_bsdf(const Material& material, const Vec2& uv);

/// Radiance leaving the surface towards a viewer on its front or back.
Color emitted(const Material& material, const Vec2& uv, bool front);

/// What `emitted` is in proportion to, channel by channel.
Color emission_scale(const Material& material);
/// The same material where that is 0.
Material put_out(Material material);
/// Whether `emitted` can be other than black.
bool is_emissive(const Material& material);
/// Whether the back emits as well.
bool emits_two_sided(const Material& material);
/// Whether `emitted` is the same for all uv.
bool emits_evenly(const Material& material);
/// Whether no point of it has a smooth lobe: light samples are wasted on it.
bool is_specular_only(const Material& material);
/// Whether every point of it has a delta lobe: a mirror, clear glass, a clear coat.
bool has_delta_lobe(const Material& material);
/// Whether light can pass through it.
bool transmits(const Material& material);

}  // namespace rayuela
