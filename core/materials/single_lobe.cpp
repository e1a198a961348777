#include "core/materials/single_lobe.h"

#include <variant>

namespace rayuela {
namespace {

using Kind = SingleLobe::Kind;

std::optional<SingleLobe> lobe_of(const DiffuseBsdf& bsdf) {
    return SingleLobe{Kind::matte, bsdf.albedo};
}

std::optional<SingleLobe> lobe_of(const MetalBsdf& bsdf) {
    if (bsdf.ggx.is_smooth()) return SingleLobe{Kind::mirror, bsdf.reflectance};
    if (bsdf.multiscatter) return std::nullopt;
    return SingleLobe{Kind::facets, bsdf.reflectance, bsdf.ggx.alpha};
}

std::optional<SingleLobe> lobe_of(const DielectricBsdf& bsdf) {
    if (bsdf.has_smooth_lobe()) return std::nullopt;
    return SingleLobe{Kind::glass, bsdf.tint, bsdf.ior};
}

template <typename Other>
std::optional<SingleLobe> lobe_of(const Other&) {
    return std::nullopt;
}

}  // namespace

std::optional<SingleLobe> single_lobe(const Material& material, const Vec2& uv) {
    return std::visit([&](const auto& m) { return lobe_of(m.bsdf(uv)); }, material);
}

}  // namespace rayuela
