#include "core/materials/bsdf.h"

#include "tests/property/direction_histogram.h"
#include "tests/property/material_cases.h"
#include "tests/statistics.h"
#include "tests/stress/stress.h"

#include <fmt/format.h>

#include <array>
#include <random>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

constexpr std::array kAngles{0.0,  5.0,  15.0, 25.0, 35.0, 45.0, 55.0,  62.0,  70.0,  75.0,
                             80.0, 84.0, 87.0, 89.0, 89.9, 93.0, 110.0, 130.0, 150.0, 177.0};

constexpr double kFurnaceLimit = 4.9;

/// Azimuth pi, so that what is mirrored leaves at azimuth 0, in the middle of a histogram.
Vec3 direction(double degrees) {
    const double theta = glm::radians(degrees);
    return Vec3(glm::dvec3(-std::sin(theta), 0, std::cos(theta)));
}

float unit(Random& random) {
    return to_unit_float(random.bits());
}

struct Pair {
    const MaterialCase* material;
    double angle;

    std::string describe() const { return fmt::format("{} at {} degrees", material->name, angle); }
};

/// A choice of `count` of all pairs of a material and an angle.
std::vector<Pair> choose_pairs(const std::vector<MaterialCase>& materials, std::uint64_t count) {
    std::vector<Pair> pairs;
    for (const MaterialCase& material : materials) {
        for (const double angle : kAngles) pairs.push_back({&material, angle});
    }
    std::shuffle(pairs.begin(), pairs.end(), std::mt19937(34));
    pairs.resize(std::min<std::size_t>(pairs.size(), count));
    return pairs;
}

std::vector<Vec3> draw(const Bsdf& bsdf, const Vec3& wo, std::uint64_t count, Random& random) {
    std::vector<Vec3> drawn;
    for (std::uint64_t i = 0; i < count; ++i) {
        const float lobe = unit(random), x = unit(random), y = unit(random);
        const auto s = bsdf.sample(wo, lobe, Vec2(x, y));
        if (s && !s->specular) drawn.push_back(s->wi);
    }
    return drawn;
}

/// Where samples fall against the integral of the density; and its whole against the share of draws that give one.
/// Figure: the level of all tests together, 0.01, shared by Sidak, over the smallest p-value.
Outcome chi_square(double scale) {
    constexpr std::uint64_t kPilot = 32'768;
    const std::uint64_t samples = scaled(4e5, scale, 16'384);
    const std::vector<MaterialCase> materials = material_cases();
    const std::vector<Pair> pairs =
        choose_pairs(materials, scaled(double(materials.size() * kAngles.size()), std::sqrt(scale), 40));
    const double level = sidak(0.01, static_cast<int>(pairs.size()));
    return for_batches(pairs.size(), 34, 1, [&](Random& random, std::uint64_t number, std::uint64_t, Outcome& outcome) {
        const Pair& pair = pairs[number];
        const Bsdf bsdf = make_bsdf(pair.material->material, Vec2(0));
        if (!bsdf.has_smooth_lobe()) return;
        const Vec3 wo = direction(pair.angle);
        const std::vector<Vec3> pilot = draw(bsdf, wo, kPilot, random);
        const DirectionHistogram histogram(pilot, 512);
        std::vector<double> observed(histogram.size()), expected(histogram.size());
        double integral = 0;
        for (std::size_t cell = 0; cell < histogram.size(); ++cell)
            integral += expected[cell] = histogram.integrate(
                cell, [&](const Vec3& wi) { return double(bsdf.pdf(wo, wi)); }, 2e-8);
        const std::vector<Vec3> drawn = draw(bsdf, wo, samples, random);
        outcome.cases += samples - 1;
        for (const Vec3& wi : drawn) {
            ++observed[histogram.cell(wi)];
            outcome.expect(bsdf.pdf(wo, wi) > 0, [&] { return pair.describe() + ": a sample of density 0"; });
        }
        const double kept = static_cast<double>(drawn.size()) / static_cast<double>(samples);
        const double spread = std::sqrt(std::max(0.0, kept * (1 - kept)) / static_cast<double>(samples));
        outcome.expect(std::fabs(integral - kept) <= 1e-3 + 5 * spread, [&] {
            return fmt::format("{}: the pdf integrates to {}, {} of the draws give a sample", pair.describe(), integral,
                               kept);
        });
        for (double& e : expected) e *= static_cast<double>(drawn.size()) / integral;
        const double p = chi_square_test(observed, expected);
        outcome.measure(level / p);
        outcome.expect(p > level, [&] { return fmt::format("{}: p {:g}", pair.describe(), p); });
    });
}

/// Every sample: its weight is eval / pdf, its pdf the pdf.
Outcome weights(double scale) {
    const std::vector<MaterialCase> materials = material_cases();
    return for_cases(scaled(1e7, scale), 35, [&](Random& random, Outcome& outcome) {
        const MaterialCase& material = materials[random.bits() % materials.size()];
        const Bsdf bsdf = make_bsdf(material.material, Vec2(0));
        const Vec3 wo = random.direction();
        const float lobe = unit(random), x = unit(random), y = unit(random);
        const auto s = bsdf.sample(wo, lobe, Vec2(x, y));
        if (!s) return;
        outcome.measure(std::fabs(glm::length(Vec3d(s->wi)) - 1));
        if (s->specular) {
            outcome.expect(s->pdf > 0 && s->pdf <= 1, [&] { return material.name; });
            return;
        }
        const BsdfValue f = bsdf.evaluate(wo, s->wi);
        outcome.measure(std::fabs(s->pdf / f.pdf - 1));
        const Color expected = f.value / f.pdf;
        outcome.measure(max_component(glm::abs(s->weight - expected)) / std::max(1e-20f, max_component(expected)));
    });
}

double measure_albedo(const Bsdf& bsdf, const Vec3& wo, std::uint64_t samples, Random& random, double& error) {
    Moments albedo;
    for (std::uint64_t i = 0; i < samples; ++i) {
        const float lobe = unit(random), x = unit(random), y = unit(random);
        const auto s = bsdf.sample(wo, lobe, Vec2(x, y));
        albedo.add(s ? double(max_component(s->weight)) : 0);
    }
    error = albedo.error();
    return albedo.mean();
}

/// Lambert and clear glass lose nothing.
Outcome furnace_exact(double scale) {
    const std::uint64_t samples = scaled(1e6, scale, 1000);
    const Material lossless[] = {Diffuse{{Color(1), nullptr}}, Dielectric{}, Dielectric{.ior = 2.4f},
                                 Dielectric{.ior = 0.7f}, Metal{{Color(1), nullptr}, {0, nullptr, 0}}};
    return for_batches(std::size(lossless) * kAngles.size(), 36, 1,
                       [&](Random& random, std::uint64_t number, std::uint64_t, Outcome& outcome) {
                           const Bsdf bsdf = make_bsdf(lossless[number / kAngles.size()], Vec2(0));
                           const double angle = kAngles[number % kAngles.size()];
                           double error = 0;
                           const double albedo = measure_albedo(bsdf, direction(angle), samples, random, error);
                           outcome.cases += samples - 1;
                           outcome.measure(std::fabs(albedo - 1));
                       });
}

/// Rough and compensated: at least 0.99 and at most 1. Figure: how far beyond, in standard errors. Of as many tests as these
/// some lie beyond 3 by chance: the limit is where all together do with the probability that one has at 3.
Outcome furnace_compensated(double scale) {
    const std::uint64_t samples = scaled(1e6, scale, 4000);
    // A lobe that holds less is not drawn at all with the probability of the limit, and then the standard error is too small.
    const double unseen = 15 / static_cast<double>(samples);
    std::vector<MaterialCase> white;
    for (const float roughness : {0.001f, 0.01f, 0.1f, 0.3f, 0.5f, 0.7f, 1.0f}) {
        white.push_back(
            {fmt::format("metal {}", roughness), Metal{{Color(1), nullptr}, {roughness, nullptr, 0}, true}});
        for (const float metallic : {0.0f, 0.5f, 1.0f}) {
            for (const float transmission : {0.0f, 0.5f, 1.0f}) {
                Principled principled{.roughness = {roughness, nullptr, 1}};
                principled.metallic.value = metallic;
                principled.transmission.value = transmission;
                white.push_back(
                    {fmt::format("principled {} metallic {} transmission {}", roughness, metallic, transmission),
                     principled});
                principled.clearcoat = 1;
                principled.clearcoat_roughness = roughness;
                white.push_back(
                    {fmt::format("coated {} metallic {} transmission {}", roughness, metallic, transmission),
                     principled});
            }
        }
    }
    return for_batches(white.size() * kAngles.size(), 37, 1,
                       [&](Random& random, std::uint64_t number, std::uint64_t, Outcome& outcome) {
                           const MaterialCase& material = white[number / kAngles.size()];
                           const double angle = kAngles[number % kAngles.size()];
                           double error = 0;
                           const double albedo = measure_albedo(make_bsdf(material.material, Vec2(0)), direction(angle),
                                                                samples, random, error);
                           outcome.cases += samples - 1;
                           const double beyond = std::max(0.99 - albedo, albedo - 1) - unseen;
                           if (beyond > 0) outcome.measure(beyond / error);
                           outcome.expect(beyond <= kFurnaceLimit * error, [&] {
                               return fmt::format("{} at {} degrees: {} +- {}", material.name, angle, albedo, error);
                           });
                       });
}

/// f(a, b) = f(b, a), through a boundary with the squares of the indices.
Outcome reciprocity(double scale) {
    std::vector<MaterialCase> materials = material_cases();
    // A clear coat takes its share by the direction of view alone.
    std::erase_if(materials, [](const MaterialCase& c) {
        const auto* principled = std::get_if<Principled>(&c.material);
        return principled && principled->clearcoat > 0;
    });
    return for_cases(scaled(1e7, scale), 38, [&](Random& random, Outcome& outcome) {
        const MaterialCase& material = materials[random.bits() % materials.size()];
        const auto* glass = std::get_if<Dielectric>(&material.material);
        const Bsdf bsdf = make_bsdf(material.material, Vec2(0));
        const Vec3 a = random.direction(), b = random.direction();
        const auto index = [&](const Vec3& w) { return glass && w.z < 0 ? double(glass->ior) : 1.0; };
        const Vec3d f = Vec3d(bsdf.eval(a, b)) / (std::fabs(double(b.z)) * index(b) * index(b));
        const Vec3d g = Vec3d(bsdf.eval(b, a)) / (std::fabs(double(a.z)) * index(a) * index(a));
        const double largest = std::max({f.x, f.y, f.z, g.x, g.y, g.z});
        if (largest < 1e-20) return;
        const Vec3d difference = glm::abs(f - g);
        const double relative = std::max({difference.x, difference.y, difference.z}) / largest;
        outcome.measure(relative);
        outcome.expect(relative < 1e-5, [&] {
            return fmt::format("{}: {} {} gives {:g} and {:g}", material.name, describe(a), describe(b), f.x, g.x);
        });
    });
}

/// The corners of the unit cube and its middle, for every sampler and from everywhere.
Outcome extreme_numbers(double scale) {
    constexpr std::array kEdges{0.0f, 0x1p-32f, 0.5f, 1 - 0x1p-24f};
    const std::vector<MaterialCase> materials = material_cases();
    return for_cases(scaled(1e6, scale), 39, [&](Random& random, Outcome& outcome) {
        const MaterialCase& material = materials[random.bits() % materials.size()];
        const Bsdf bsdf = make_bsdf(material.material, Vec2(0));
        Vec3 wo = random.direction();
        if (random.integer(0, 1)) wo.z *= std::exp(random.uniform(-80, 0));
        if (random.integer(0, 3) == 0) wo[random.integer(0, 2)] = 0;
        const float length = glm::length(wo);
        if (length == 0) return;
        wo /= length;
        for (int i = 0; i < 64; ++i) {
            const float lobe = kEdges[static_cast<std::size_t>(i % 4)];
            const Vec2 u(kEdges[static_cast<std::size_t>(i / 4 % 4)], kEdges[static_cast<std::size_t>(i / 16)]);
            const auto s = bsdf.sample(wo, lobe, u);
            ++outcome.cases;
            if (!s) continue;
            outcome.expect(
                is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf) && s->pdf > 0 &&
                    glm::all(glm::greaterThanEqual(s->weight, Vec3(0))),
                [&] { return fmt::format("{} wo {} u {} {} {}", material.name, describe(wo), lobe, u.x, u.y); });
        }
    });
}

}  // namespace

std::vector<StressTest> bsdf_tests() {
    return {{34, "samples follow their density; it integrates to 1", "level / smallest p", 1, chi_square},
            {35, "weights are eval / pdf", "relative error", 1e-5, weights},
            {36, "furnace: Lambert, mirror and clear glass", "|albedo - 1|", 1e-6, furnace_exact},
            {36, "furnace: rough and compensated in [0.99, 1]", "standard errors beyond", kFurnaceLimit,
             furnace_compensated},
            {38, "reciprocity", "relative error", 1e-5, reciprocity},
            {39, "extreme random numbers", "-", 0, extreme_numbers}};
}

}  // namespace rayuela::stress
