#include "core/lights/area_light.h"
#include "core/materials/fresnel.h"
#include "core/math/basis.h"
#include "core/math/sampler.h"
#include "tests/stress/stress.h"
#include "tests/support/oracle.h"

#include <fmt/format.h>

#include <atomic>
#include <numbers>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

/// Unit vectors: anywhere, or next to an axis, where the basis has its seam.
Vec3 unit_vector(Random& random) {
    Vec3 n = random.direction();
    if (random.integer(0, 1)) {
        n *= log_uniform(random, 1e-30f, 1);
        n[random.integer(0, 2)] = random.integer(0, 1) ? 1.0f : -1.0f;
    }
    if (random.integer(0, 3) == 0) n[random.integer(0, 2)] = random.integer(0, 1) ? 0.0f : -0.0f;
    return glm::length(n) > 0.5f ? glm::normalize(n) : Vec3(0, 0, -1);
}

/// Figure: mean over the vectors of the sum of squared deviations from orthonormality.
Outcome orthonormal_basis(double scale) {
    std::atomic<std::uint64_t> parts = 0;  // in 2^-80, to be exact in any order
    Outcome outcome =
        for_batches(scaled(1e8, scale), 32, 4096, [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& found) {
            double sum = 0;
            for (std::uint64_t i = 0; i < n; ++i) {
                const Vec3 normal = unit_vector(random);
                const Basis frame(normal);
                const Vec3d s(frame.s), t(frame.t), z(frame.n);
                const double errors[] = {glm::dot(s, s) - 1, glm::dot(t, t) - 1, glm::dot(s, t), glm::dot(s, z),
                                         glm::dot(t, z)};
                double squares = 0;
                for (const double e : errors) squares += e * e;
                const double handed = glm::dot(glm::cross(s, t), z);
                found.expect(squares < 1e-11 && std::fabs(handed - 1) < 1e-5, [&] { return describe(normal); });
                sum += squares;
            }
            parts += static_cast<std::uint64_t>(std::ldexp(sum, 80 - 24));
        });
    outcome.measure(std::ldexp(static_cast<double>(parts), 24 - 80) / static_cast<double>(outcome.cases));
    return outcome;
}

Real exact_fresnel(Real cosine, Real eta) {
    const Real g2 = (eta - 1) * (eta + 1) + cosine * cosine;
    if (g2 <= 0) return 1;
    const Real g = std::sqrt(g2);
    const Real s = (cosine - g) / (cosine + g), p = (eta * eta * cosine - g) / (eta * eta * cosine + g);
    return (s * s + p * p) / 2;
}

/// R of the code and T = 1 - R of the oracle make 1.
Outcome fresnel(double scale) {
    return for_cases(scaled(1e8, scale), 40, [](Random& random, Outcome& outcome) {
        const float close = log_uniform(random, 1e-7f, 0.5f);
        const int kind = random.integer(0, 3);
        const float eta = kind == 0 ? 1 + close : kind == 1 ? 1 - close : log_uniform(random, 1e-3f, 1e3f);
        const float cosine = random.integer(0, 3) ? random.uniform() : log_uniform(random, 1e-20f, 1);
        const double r = fresnel_dielectric(cosine, eta);
        const auto where = [&] { return fmt::format("cosine {:.9g} eta {:.9g}: {:.9g}", cosine, eta, r); };
        outcome.expect(r >= 0 && r <= 1, where);
        const Real t = 1 - exact_fresnel(cosine, eta);
        outcome.measure(static_cast<double>(std::fabs(r + t - 1) / 0x1p-24L));
    });
}

Outcome random_words(double scale) {
    return for_batches(scaled(0x1p32, scale), 41, 1 << 20,
                       [&](Random&, std::uint64_t first, std::uint64_t n, Outcome& outcome) {
                           // Spread over all words, the last one included.
                           const double step = std::max(1.0, 1 / scale);
                           for (std::uint64_t i = first; i < first + n; ++i) {
                               const auto word = ~static_cast<std::uint32_t>(static_cast<double>(i) * step);
                               const float u = to_unit_float(word);
                               outcome.expect(u >= 0 && u < 1, [&] { return fmt::format("word {}", word); });
                           }
                       });
}

/// 2^k consecutive samples from a multiple of 2^k: one in each stratum of either number, and of the first pair of a set one in
/// each elementary interval of that area.
Outcome strata(double scale) {
    return for_cases(scaled(1e6, scale, 100), 41, [](Random& random, Outcome& outcome) {
        const int k = random.integer(0, 9);
        const std::uint32_t count = 1u << k, seed = random.bits(), pixel = random.bits(),
                            dimension = random.bits() % 256;
        const std::uint32_t first = (random.bits() % 64) * count;
        const int columns = dimension % kSobolPairs == 0 ? random.integer(0, k) : random.integer(0, 1) * k;
        std::vector<std::uint8_t> filled(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec2 u = Sampler(SamplerKind::sobol, seed, pixel, first + i).get_2d(dimension);
            const auto x = static_cast<std::uint32_t>(std::ldexp(u.x, columns)),
                       y = static_cast<std::uint32_t>(std::ldexp(u.y, k - columns));
            ++filled[(y << columns) + x];
        }
        outcome.expect(std::ranges::all_of(filled, [](int n) { return n == 1; }), [&] {
            return fmt::format("seed {} pixel {} dimension {} from {}", seed, pixel, dimension, first);
        });
    });
}

/// A sphere seen under half an angle from 1e-6 to pi / 2.
Outcome sphere_cones(double scale) {
    return for_cases(scaled(1e8, scale), 42, [](Random& random, Outcome& outcome) {
        AreaLight sphere{.kind = AreaLight::Kind::sphere};
        sphere.size = log_uniform(random, 1e-3f, 1e3f);
        sphere.origin = random.integer(0, 1) ? Vec3(0) : random.in_cube(10) * sphere.size;
        const float half_angle = log_uniform(random, 1e-6f, 1.5707f);
        const Vec3 p = sphere.origin + random.direction() * (sphere.size / std::sin(half_angle));
        const Vec3l to_center = Vec3l(sphere.origin) - Vec3l(p);
        const Real sin2 = Real(sphere.size) * sphere.size / glm::dot(to_center, to_center);
        if (sin2 >= 1) return;
        const Real expected = (1 + std::sqrt(1 - sin2)) / (2 * std::numbers::pi_v<Real> * sin2);
        const Vec3 wi(glm::normalize(to_center));
        const float pdf = sphere.pdf({p}, wi, p, -wi);
        outcome.measure(static_cast<double>(std::fabs(pdf - expected) / expected));
    });
}

}  // namespace

std::vector<StressTest> sampling_tests() {
    return {{32, "orthonormal basis", "mean square error", 1e-13, orthonormal_basis},
            {40, "Fresnel: R in [0, 1], R + T = 1", "units of 2^-24", 2, fresnel},
            {41, "random words map below 1", "-", 0, random_words},
            {41, "Sobol pairs fill their strata", "-", 0, strata},
            {42, "cones of sphere lights, 1e-6 to pi / 2", "relative error of pdf", 1e-5, sphere_cones}};
}

}  // namespace rayuela::stress
