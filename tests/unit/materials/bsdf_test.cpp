#include "core/materials/bsdf.h"

#include "core/materials/fresnel.h"
#include "core/materials/ggx_albedo.h"
#include "core/materials/microfacet.h"
#include "core/math/sampler.h"

#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

using test::Moments;

constexpr double kAngles[] = {0, 30, 60, 80, 89, 89.9};

Vec3 direction(double degrees) {
    const double theta = degrees * std::numbers::pi / 180;
    return Vec3(glm::dvec3(std::sin(theta), 0, std::cos(theta)));
}

/// Share of light from everywhere that leaves towards wo.
Moments furnace(const Bsdf& bsdf, const Vec3& wo, std::uint32_t samples) {
    Moments albedo;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const Sampler sampler(SamplerKind::independent, 1, 0, i);
        const auto s = bsdf.sample(wo, sampler.get_1d(0), sampler.get_2d(1));
        albedo.add(s ? double(s->weight.x) : 0);
    }
    return albedo;
}

TEST(Furnace, LambertReflectsAllLight) {
    const Bsdf bsdf = make_bsdf(Diffuse{{Color(1), nullptr}}, Vec2(0));
    for (const double angle : kAngles) EXPECT_NEAR(furnace(bsdf, direction(angle), 1000).mean(), 1, 1e-6);
    // And by quadrature of eval, which sampling does not enter.
    double sum = 0;
    for (int i = 0; i < 1000; ++i) {
        const double z = (i + 0.5) / 1000;
        sum += bsdf.eval(direction(30), Vec3(glm::dvec3(std::sqrt(1 - z * z), 0, z))).x * 2 * std::numbers::pi / 1000;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST(Furnace, SmoothGlassKeepsAllLight) {
    for (const float ior : {0.7f, 1.0f, 1.0001f, 1.33f, 1.5f, 2.4f}) {
        const Bsdf bsdf = make_bsdf(Dielectric{.ior = ior}, Vec2(0));
        for (const double angle : {0.0, 30.0, 60.0, 89.9, 95.0, 130.0, 180.0}) {
            EXPECT_NEAR(furnace(bsdf, direction(angle), 1000).mean(), 1, 1e-6) << ior << " " << angle;
        }
    }
}

TEST(Furnace, CompensatedMetalReflectsAllLight) {
    for (const float roughness : {0.05f, 0.1f, 0.3f, 0.5f, 0.7f, 1.0f}) {
        const Bsdf bsdf = make_bsdf(Metal{{Color(1), nullptr}, {roughness, nullptr, 0}, true}, Vec2(0));
        for (const double angle : kAngles) {
            const Moments albedo = furnace(bsdf, direction(angle), 20'000);
            EXPECT_GE(albedo.mean(), 0.99 - 3 * albedo.error()) << roughness << " " << angle;
            EXPECT_LE(albedo.mean(), 1.003 + 3 * albedo.error()) << roughness << " " << angle;
        }
    }
}

TEST(Furnace, WhitePrincipledKeepsAllLight) {
    for (const float roughness : {0.0f, 0.1f, 0.5f, 1.0f}) {
        for (const auto& [metallic, transmission, clearcoat, ior] :
             {std::array{0.0f, 0.0f, 0.0f, 1.5f}, std::array{1.0f, 0.0f, 0.0f, 1.5f},
              std::array{0.0f, 1.0f, 0.0f, 1.5f}, std::array{0.3f, 0.5f, 0.0f, 1.3f},
              std::array{0.0f, 0.0f, 1.0f, 1.5f}, std::array{0.5f, 0.5f, 1.0f, 2.4f}}) {
            Principled material;
            material.metallic.value = metallic;
            material.roughness.value = roughness;
            material.transmission.value = transmission;
            material.clearcoat = clearcoat;
            material.clearcoat_roughness = 0.4f;
            material.ior = ior;
            const Bsdf bsdf = make_bsdf(material, Vec2(0));
            for (const double angle : kAngles) {
                const Moments albedo = furnace(bsdf, direction(angle), 10'000);
                // At 89.9 degrees the interpolated table of Fresnel's share is good to 0.01.
                EXPECT_GE(albedo.mean(), 0.99 - 3 * albedo.error()) << roughness << " " << metallic << " " << angle;
                EXPECT_LE(albedo.mean(), (angle > 85 ? 1.01 : 1.003) + 3 * albedo.error())
                    << roughness << " " << metallic << " " << transmission << " " << clearcoat << " " << angle;
            }
        }
    }
}

TEST(Furnace, PlainMetalLosesWhatSmithsMaskingSays) {
    // The weight of a sample is G1(wi): with separable masking the albedo is its mean over the visible normals. For
    // normal incidence that is an integral over the slope s = alpha tan: E = int 2 t G1 / (1 + t^2)^2 dt with
    // tan(theta_m) = alpha t and wi at twice theta_m.
    for (const double roughness : {0.3, 0.5, 0.7, 1.0}) {
        const double alpha = roughness * roughness;
        double expected = 0;
        const int steps = 200'000;
        for (int i = 0; i < steps; ++i) {
            const double u = (i + 0.5) / steps, t = std::sqrt(u / (1 - u));  // u = t^2 / (1 + t^2) is uniform
            const double theta = 2 * std::atan(alpha * t);
            if (theta >= std::numbers::pi / 2) continue;
            const double tangent = alpha * std::tan(theta);
            expected += 2 / (1 + std::sqrt(1 + tangent * tangent)) / steps;
        }
        const Bsdf bsdf = make_bsdf(Metal{{Color(1), nullptr}, {float(roughness), nullptr, 0}, false}, Vec2(0));
        const Moments albedo = furnace(bsdf, direction(0), 50'000);
        EXPECT_NEAR(albedo.mean(), expected, 4 * albedo.error() + 1e-5) << roughness;
    }
}

TEST(Ggx, NormalsProjectToUnitArea) {
    for (const float alpha : {0.01f, 0.1f, 0.5f, 1.0f}) {
        double sum = 0;
        const int steps = 100'000;
        for (int i = 0; i < steps; ++i) {
            // tan = alpha t, t^2 = u / (1 - u), for which D cos dm is constant.
            const double u = (i + 0.5) / steps, tangent = alpha * std::sqrt(u / (1 - u));
            const double cosine = 1 / std::sqrt(1 + tangent * tangent);
            const Vec3 m(glm::dvec3(std::sqrt(1 - cosine * cosine), 0, cosine));
            // dm = 2 pi d(cos), and d(tan^2) = -2 d(cos) / cos^3 = alpha^2 du / (1 - u)^2.
            const double dm = std::numbers::pi * alpha * alpha / ((1 - u) * (1 - u)) * cosine * cosine * cosine / steps;
            sum += Ggx{alpha}.d(m) * cosine * dm;
        }
        EXPECT_NEAR(sum, 1, 2e-3) << alpha;
    }
}

TEST(Ggx, TabulatedAlbedoAgreesWithSampling) {
    for (const float roughness : {0.02f, 0.15f, 0.4f, 0.77f, 0.95f}) {
        const Ggx ggx{roughness * roughness};
        for (const double angle : {0.0, 45.0, 75.0, 86.0, 89.0, 89.9}) {
            const Vec3 wo = direction(angle);
            Moments total, grazing;
            for (std::uint32_t i = 0; i < 20'000; ++i) {
                const Vec3 m = ggx.sample_visible(wo, Sampler(SamplerKind::independent, 2, 0, i).get_2d(0));
                const Vec3 wi = reflect(wo, m);
                const double weight = wi.z > 0 ? ggx.g2_over_g1(wo, wi) : 0;
                total.add(weight);
                grazing.add(weight * schlick_weight(std::min(1.0f, glm::dot(wo, m))));
            }
            const GgxAlbedo table = ggx_albedo(wo.z, ggx.alpha);
            EXPECT_NEAR(table.total, total.mean(), 0.0004 + 4 * total.error()) << roughness << " " << angle;
            EXPECT_NEAR(table.grazing, grazing.mean(), 0.001 + 4 * grazing.error()) << roughness << " " << angle;
        }
    }
}

TEST(Metal, RoughnessZeroIsAMirror) {
    const Bsdf bsdf = make_bsdf(Metal{{Color(0.9f, 0.5f, 0.2f), nullptr}}, Vec2(0));
    EXPECT_FALSE(bsdf.has_smooth_lobe());
    for (const float side : {1.0f, -1.0f}) {
        const Vec3 wo = glm::normalize(Vec3(0.3f, -0.4f, 0.8f * side));
        const auto s = bsdf.sample(wo, 0.7f, Vec2(0.2f, 0.9f));
        ASSERT_TRUE(s);
        EXPECT_TRUE(s->specular);
        EXPECT_EQ(s->wi, Vec3(-wo.x, -wo.y, wo.z));
        EXPECT_EQ(s->weight, Color(0.9f, 0.5f, 0.2f));
        EXPECT_EQ(bsdf.eval(wo, s->wi), Color(0));
    }
}

TEST(Metal, EvalIsTheTextbookFormula) {
    const float roughness = 0.6f, a2 = roughness * roughness * roughness * roughness;
    const Bsdf bsdf = make_bsdf(Metal{{Color(0.8f), nullptr}, {roughness, nullptr, 0}, false}, Vec2(0));
    const Vec3 wo = direction(40), wi = glm::normalize(Vec3(-0.2f, 0.5f, 0.6f)), h = glm::normalize(wo + wi);
    const auto g1 = [&](const Vec3& w) { return 2 / (1 + std::sqrt(1 + a2 * (1 - w.z * w.z) / (w.z * w.z))); };
    const float c2 = h.z * h.z, k = c2 * (a2 - 1) + 1;
    const float d = a2 / (kPi * k * k);
    EXPECT_NEAR(bsdf.eval(wo, wi).x, 0.8f * d * g1(wo) * g1(wi) / (4 * wo.z * wi.z) * wi.z, 1e-5);
}

TEST(Dielectric, SmoothSnellAndFresnel) {
    const Bsdf bsdf = make_bsdf(Dielectric{.ior = 1.5f, .tint = {Color(0.9f, 0.8f, 0.7f), nullptr}}, Vec2(0));
    for (const double angle : {10.0, 60.0, 150.0, 120.0}) {
        const Vec3 wo = direction(angle);
        const float eta = wo.z > 0 ? 1.5f : 1 / 1.5f;
        const auto r = static_cast<float>(fresnel_dielectric(std::abs(wo.z), eta));
        const auto reflected = bsdf.sample(wo, 0, Vec2(0.5f));
        ASSERT_TRUE(reflected);
        EXPECT_EQ(reflected->weight, Color(0.9f, 0.8f, 0.7f));
        EXPECT_EQ(reflected->pdf, r);
        EXPECT_EQ(reflected->wi.z, wo.z);
        const auto passed = bsdf.sample(wo, 1 - 0x1p-24f, Vec2(0.5f));
        ASSERT_TRUE(passed);
        if (r == 1) {
            EXPECT_EQ(passed->wi.z, wo.z) << "total reflection";
            continue;
        }
        EXPECT_EQ(passed->weight, Color(0.9f, 0.8f, 0.7f));
        EXPECT_FLOAT_EQ(passed->pdf, 1 - r);
        EXPECT_LT(passed->wi.z * wo.z, 0);
        EXPECT_NEAR(passed->wi.x, -wo.x / eta, 1e-6);
        EXPECT_NEAR(glm::length(passed->wi), 1, 1e-6);
    }
}

TEST(Dielectric, RoughGlassApproachesSmoothGlass) {
    const Bsdf bsdf = make_bsdf(Dielectric{.roughness = {0.03f, nullptr, 0}}, Vec2(0));
    ASSERT_TRUE(bsdf.has_smooth_lobe());
    for (const double angle : {20.0, 60.0, 160.0}) {
        const Vec3 wo = direction(angle);
        Moments through, albedo;
        for (std::uint32_t i = 0; i < 20'000; ++i) {
            const Sampler sampler(SamplerKind::sobol, 3, 0, i);
            const auto s = bsdf.sample(wo, sampler.get_1d(0), sampler.get_2d(1));
            albedo.add(s ? double(s->weight.x) : 0);
            through.add(s && s->wi.z * wo.z < 0 ? double(s->weight.x) : 0);
        }
        EXPECT_NEAR(albedo.mean(), 1, 1e-3);
        EXPECT_NEAR(through.mean(), 1 - fresnel_dielectric(std::abs(wo.z), wo.z > 0 ? 1.5f : 1 / 1.5f), 2e-3) << angle;
    }
}

TEST(Dielectric, EqualMediaAreInvisible) {
    for (const float roughness : {0.0f, 0.5f}) {
        const Bsdf bsdf = make_bsdf(Dielectric{.ior = 1, .roughness = {roughness, nullptr, 0}}, Vec2(0));
        const Vec3 wo = direction(70);
        const auto s = bsdf.sample(wo, 0.3f, Vec2(0.1f, 0.8f));
        ASSERT_TRUE(s);
        EXPECT_LT(glm::length(s->wi + wo), 1e-6f);
    }
}

TEST(Emission, FrontBackAndStrength) {
    const Emitter lamp{{Color(3, 2, 1), nullptr}, false};
    EXPECT_EQ(emitted(lamp, Vec2(0), true), Color(3, 2, 1));
    EXPECT_EQ(emitted(lamp, Vec2(0), false), Color(0));
    EXPECT_TRUE(is_emissive(lamp));
    EXPECT_FALSE(emits_two_sided(lamp));
    const Emitter both{{Color(3, 2, 1), nullptr}, true};
    EXPECT_EQ(emitted(both, Vec2(0), false), Color(3, 2, 1));
    EXPECT_TRUE(emits_two_sided(both));
    EXPECT_FALSE(is_emissive(Emitter{{Color(0), nullptr}, false}));
    EXPECT_FALSE(is_emissive(Diffuse{}));

    Principled glowing;
    EXPECT_FALSE(is_emissive(glowing));
    glowing.emissive.value = Color(0.5f);
    glowing.emissive_strength = 4;
    EXPECT_TRUE(is_emissive(glowing));
    EXPECT_EQ(emitted(glowing, Vec2(0), true), Color(2));
    glowing.emissive_strength = 0;
    EXPECT_FALSE(is_emissive(glowing));
}

TEST(Emission, EmittersAbsorb) {
    const Bsdf bsdf = make_bsdf(Emitter{}, Vec2(0));
    EXPECT_FALSE(bsdf.sample(Vec3(0, 0, 1), 0.5f, Vec2(0.5f)));
    EXPECT_EQ(bsdf.eval(Vec3(0, 0, 1), Vec3(0, 0, 1)), Color(0));
    EXPECT_TRUE(is_specular_only(Emitter{}));
}

TEST(SpecularOnly, MirrorsAndClearGlass) {
    EXPECT_TRUE(is_specular_only(Metal{}));
    EXPECT_TRUE(is_specular_only(Dielectric{}));
    EXPECT_FALSE(is_specular_only(Diffuse{}));
    Metal rough;
    rough.roughness.value = 0.3f;
    EXPECT_FALSE(is_specular_only(rough));
    Principled p;
    p.roughness.value = 0;
    EXPECT_FALSE(is_specular_only(p));
    p.metallic.value = 1;
    EXPECT_TRUE(is_specular_only(p));
    p.clearcoat = 1;
    p.clearcoat_roughness = 0.5f;
    EXPECT_FALSE(is_specular_only(p));
}

}  // namespace
}  // namespace rayuela
