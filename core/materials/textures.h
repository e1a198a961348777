#pragma once

#include "core/materials/material.h"

namespace rayuela {

/// Calls use(texture) for every std::shared_ptr<const Image> of the material, which may be null.
template <typename SomeMaterial, typename Use>
void for_each_texture(SomeMaterial& material, Use&& use) {
    const auto visit_field = [&](auto& value, const Field&) {
        if constexpr (requires { value.texture; }) use(value.texture);
    };
    std::visit([&](auto& m) { m.visit_fields(m, visit_field); }, material);
}

/// The material as it can be evaluated: all textures with their pixels. Calls lost(image) for one that has none after all
/// and leaves it out.
template <typename Lost>
Material with_pixels(Material material, Lost&& lost) {
    for_each_texture(material, [&](std::shared_ptr<const Image>& texture) {
        auto seen = with_pixels(texture);
        if (texture && !seen) lost(*texture);
        texture = std::move(seen);
    });
    return material;
}

}  // namespace rayuela
