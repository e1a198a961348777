#pragma once

#include "core/math/vec.h"

namespace rayuela {

/// Share of the light that a GGX surface reflects after one bounce (height-correlated masking), in two parts from which
/// it follows for facets of any Schlick reflectance.
struct GgxAlbedo {
    float total = 1;    ///< Where facets reflect all light.
    float grazing = 0;  ///< Where facets reflect schlick_weight(cos).

    float with_facets(float f0) const { return f0 * (total - grazing) + grazing; }
    Color with_facets(const Color& f0) const { return f0 * (total - grazing) + Color(grazing); }
};

/// For light that arrives at cosine `mu` in [0, 1]. Interpolated in tables (see GgxTables); within
/// 0.0004 of `total` and 0.001 of `grazing`, and not below them by more than 0.0002: what is given back stays below what is
/// lost. Exact for smooth surfaces (alpha < kSmoothAlpha).
GgxAlbedo ggx_albedo(float mu, float alpha);

/// Mean over the hemisphere, weighted by the cosine.
GgxAlbedo ggx_average_albedo(float alpha);

/// Of what one bounce between facets of mean reflectance `facets` loses, the share that comes out after more bounces:
/// the series of Kulla & Conty 2017 in the form of Fdez-Aguera, JCGT 8(1), 2019.
inline Color lost_reflectance(const Color& facets, float average) {
    return facets * facets * average / (1.0f - facets * (1 - average));
}

/// Factor of a cosine lobe that gives back what another lobe of directional albedo E loses, reciprocally and exactly:
/// (1 - E(wo)) (1 - E(wi)) / (1 - E_average). Kulla & Conty, "Revisiting Physically Based Shading at Imageworks", 2017.
inline float energy_lobe(float albedo_o, float albedo_i, float average) {
    return average < 1 ? (1 - albedo_o) * (1 - albedo_i) / (1 - average) : 0.0f;
}

}  // namespace rayuela
