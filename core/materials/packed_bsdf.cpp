#include "core/materials/packed_bsdf.h"

#include <variant>

namespace rayuela {
namespace {

using Kind = PackedBsdf::Kind;

std::optional<PackedBsdf> pack(const Diffuse&, const DiffuseBsdf& b) {
    return PackedBsdf{Kind::matte, {b.albedo.x, b.albedo.y, b.albedo.z}};
}

std::optional<PackedBsdf> pack(const Metal&, const MetalBsdf& b) {
    const Color &facets = b.reflectance, &lost = b.lost_reflectance;
    if (b.ggx.is_smooth()) return PackedBsdf{Kind::mirror, {facets.x, facets.y, facets.z}};
    return PackedBsdf{b.multiscatter ? Kind::dull : Kind::facets,
                      {facets.x, facets.y, facets.z, b.ggx.alpha, lost.x, lost.y, lost.z, b.average_albedo}};
}

std::optional<PackedBsdf> pack(const Dielectric&, const DielectricBsdf& b) {
    return PackedBsdf{b.has_smooth_lobe() ? Kind::frosted : Kind::glass,
                      {b.tint.x, b.tint.y, b.tint.z, b.ior, b.ggx.alpha}};
}

std::optional<PackedBsdf> pack(const Principled& material, const PrincipledBsdf& b) {
    if (b.facets.is_smooth() || (b.coat > 0 && b.coat_facets.is_smooth())) return std::nullopt;
    const Color &f0 = b.facets_f0, &lost = b.metal_lost, &diffuse = b.diffuse, &through = b.transmission;
    return PackedBsdf{material.transmits() ? Kind::see_through : Kind::layered,
                      {b.facets.alpha, b.coat_facets.alpha, b.coat, b.dielectric_f0,  //
                       f0.x, f0.y, f0.z, b.average.total,                             //
                       lost.x, lost.y, lost.z, b.average.grazing,                     //
                       diffuse.x, diffuse.y, diffuse.z, 0,                            //
                       through.x, through.y, through.z}};
}

template <typename M>
std::optional<PackedBsdf> pack(const M&, const typename M::Bsdf&) {
    return std::nullopt;
}

}  // namespace

std::optional<PackedBsdf> packed_bsdf(const Material& material, const Vec2& uv) {
    return std::visit([&](const auto& m) { return pack(m, m.bsdf(uv)); }, material);
}

}  // namespace rayuela
