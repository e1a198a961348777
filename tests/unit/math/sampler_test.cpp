#include "core/math/sampler.h"

#include "core/math/sampler_batch.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

namespace rayuela {
namespace {

constexpr SamplerKind kKinds[] = {SamplerKind::independent, SamplerKind::sobol};

TEST(Sampler, AllWordsMapBelowOne) {
    EXPECT_EQ(to_unit_float(0), 0);
    EXPECT_EQ(to_unit_float(0xffffffffu), 1 - 0x1p-24f);
    EXPECT_LT(to_unit_float(0xffffffffu), 1);
}

TEST(Sampler, ReversesBits) {
    for (const std::uint32_t x : {0x1u, 0x80000000u, 0x12345678u, 0xdeadbeefu}) {
        std::uint32_t expected = 0;
        for (int bit = 0; bit < 32; ++bit) expected |= ((x >> bit) & 1u) << (31 - bit);
        EXPECT_EQ(reverse_bits(x), expected);
    }
}

TEST(Sampler, SobolDimensionsFollowTheirRecurrences) {
    // Joe & Kuo's second dimension, of the polynomial x + 1: v_1 = 1/2, v_i = v_(i-1) ^ (v_(i-1) / 2).
    std::uint32_t second[32] = {0x80000000u};
    for (int i = 1; i < 32; ++i) second[i] = second[i - 1] ^ (second[i - 1] >> 1);
    // The fourth, of x^3 + x + 1 with m = 1, 3, 1: v_i = v_(i-2) ^ v_(i-3) ^ (v_(i-3) / 8).
    std::uint32_t fourth[32] = {0x80000000u, 3u << 30, 1u << 29};
    for (int i = 3; i < 32; ++i) fourth[i] = fourth[i - 2] ^ fourth[i - 3] ^ (fourth[i - 3] >> 3);
    const auto combine = [](const std::uint32_t(&v)[32], std::uint32_t index) {
        std::uint32_t x = 0;
        for (int bit = 0; bit < 32; ++bit) {
            if (index >> bit & 1) x ^= v[bit];
        }
        return x;
    };
    // Of the first pair each of the fixed digits has others of higher value added, the rest are as they were.
    const auto with_fixed_digits = [](std::uint32_t x, std::size_t dimension) {
        for (std::uint32_t b = kFixedDigits; b-- > 0;) {
            for (std::uint32_t higher = 0; higher < b; ++higher) {
                if (kFixedRows[dimension][b] >> higher & 1) x ^= (x >> (31 - higher) & 1) << (31 - b);
            }
        }
        return x;
    };
    for (std::uint32_t k = 0; k < 10'000; ++k) {
        const auto index = static_cast<std::uint32_t>(mix_bits(k));
        ASSERT_EQ(reverse_bits(sobol_reversed(index, 0)), with_fixed_digits(reverse_bits(index), 0)) << index;
        ASSERT_EQ(reverse_bits(sobol_reversed(index, 1)), with_fixed_digits(combine(second, index), 1)) << index;
        ASSERT_EQ(reverse_bits(sobol_reversed(index, 3)), combine(fourth, index)) << index;
    }
}

TEST(Sampler, DimensionsOfASetAreStratifiedTogether) {
    // The quality t of a Sobol sequence is the sum of (degree - 1) over its polynomials (Sobol 1967): every box of volume
    // 2^(t - m) holds 2^t of the first 2^m points. Degrees 0, 1, 2, 3: t is 1 for three dimensions and 3 for four.
    struct Case {
        std::size_t dimensions;
        int t;
    };
    for (const auto [dimensions, t] : {Case{3, 1}, Case{4, 3}}) {
        for (const std::uint32_t set : {0u, 4u, 400u}) {
            for (int m = t + 1; m <= 9; ++m) {
                for (std::uint32_t shape = 0; shape < 200; ++shape) {
                    std::array<int, 4> bits{};
                    for (int i = 0; i < m - t; ++i) ++bits[mix_bits(shape * 100 + std::uint32_t(i) + 1) % dimensions];
                    std::map<std::array<int, 4>, int> counts;
                    for (std::uint32_t i = 0; i < (1u << m); ++i) {
                        const Sampler sampler(SamplerKind::sobol, 1, shape, i);
                        const Vec2 a = sampler.get_2d(set), b = sampler.get_2d(set + 1);
                        ++counts[{int(std::ldexp(a.x, bits[0])), int(std::ldexp(a.y, bits[1])),
                                  int(std::ldexp(b.x, bits[2])), int(std::ldexp(b.y, bits[3]))}];
                    }
                    for (const auto& [box, count] : counts) ASSERT_EQ(count, 1 << t) << m << " " << shape;
                }
            }
        }
    }
}

/// A Sobol pair whose digits are flipped at random, each depending on those before it: Owen's scrambling as he defines it.
class RandomPair {
public:
    explicit RandomPair(std::uint64_t seed) : seed_(seed) {}
    Vec2 at(std::uint32_t index) const {
        std::uint32_t second = 0;
        for (std::uint32_t bit = 0, v = 0x80000000u; bit < 32; ++bit, v ^= v >> 1) second ^= index >> bit & 1 ? v : 0;
        return {scrambled(reverse_bits(index), 0), scrambled(second, 1)};
    }

private:
    float scrambled(std::uint32_t x, std::uint32_t dimension) const {
        std::uint32_t result = 0;
        for (int digit = 0; digit < 32; ++digit) {
            const std::uint64_t before = digit == 0 ? 0 : x >> (32 - digit);
            const std::uint64_t flip = mix_bits(mix_bits(seed_ * 64 + 2 * std::uint64_t(digit) + dimension) ^ before);
            result = result << 1 | ((x >> (31 - digit) & 1) ^ (flip & 1));
        }
        return to_unit_float(result);
    }
    std::uint64_t seed_;
};

TEST(Sampler, FirstPairsFindAreasBetterThanRandomScrambling) {
    // Of a x + b y < d in the unit square, with a and b positive: a triangle less those beyond the sides.
    const auto area = [](double a, double b, double d) {
        const auto triangle = [&](double side) { return side > 0 ? side * side / (2 * a * b) : 0; };
        return triangle(d) - triangle(d - a) - triangle(d - b) + triangle(d - a - b);
    };
    constexpr std::uint32_t kPixels = 12'000;
    for (const auto& [samples, least_gain] : std::map<std::uint32_t, double>{{16, 0.05}, {32, 0.05}, {64, 0.15}}) {
        double fixed_error = 0, random_error = 0;
        for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
            const Vec2 place = Sampler(SamplerKind::independent, 5, pixel, samples).get_2d(0);
            const double angle = 1.5707963267948966 * (0.001 + 0.998 * place.x), a = std::cos(angle),
                         b = std::sin(angle), d = place.y * (a + b), exact = area(a, b, d);
            const auto squared_error = [&](const auto& draw) {
                double inside = 0;
                for (std::uint32_t i = 0; i < samples; ++i) {
                    const Vec2 u = draw(i);
                    inside += a * u.x + b * u.y < d ? 1 : 0;
                }
                return (inside / samples - exact) * (inside / samples - exact);
            };
            const RandomPair random(pixel);
            fixed_error +=
                squared_error([&](std::uint32_t i) { return Sampler(SamplerKind::sobol, 3, pixel, i).get_2d(4); });
            random_error += squared_error([&](std::uint32_t i) { return random.at(i); });
        }
        EXPECT_LT(fixed_error, (1 - least_gain) * random_error) << samples;
        RecordProperty("ratio " + std::to_string(samples), std::to_string(fixed_error / random_error));
    }
}

TEST(Sampler, OwenScramblingKeepsElementaryIntervals) {
    // Two numbers that agree in their first bits still agree in them: nested scrambling permutes intervals.
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const auto a = static_cast<std::uint32_t>(mix_bits(i));
        const auto seed = static_cast<std::uint32_t>(mix_bits(~std::uint64_t{i}));
        for (int bits = 1; bits < 32; ++bits) {
            const std::uint32_t b = a ^ (0x9e3779b9u << bits);  // agrees with a in its `bits` low bits
            const std::uint32_t mask = (1u << bits) - 1;
            ASSERT_EQ((owen_scramble_reversed(a, seed) ^ owen_scramble_reversed(b, seed)) & mask, 0u);
        }
    }
}

TEST(Sampler, SobolPairsFillEveryElementaryIntervalOnce) {
    for (const std::uint32_t pixel : {0u, 1u, 77'777u}) {
        for (const std::uint32_t dimension : {0u, 4u, 60u}) {
            for (int m = 1; m <= 8; ++m) {
                for (std::uint32_t block = 0; block < 3; ++block) {
                    for (int a = 0; a <= m; ++a) {
                        std::set<int> cells;
                        for (std::uint32_t i = 0; i < (1u << m); ++i) {
                            const Sampler sampler(SamplerKind::sobol, 9, pixel, (block << m) + i);
                            const Vec2 u = sampler.get_2d(dimension);
                            const int x = static_cast<int>(std::ldexp(u.x, a));
                            const int y = static_cast<int>(std::ldexp(u.y, m - a));
                            cells.insert(x << (m - a) | y);
                        }
                        ASSERT_EQ(cells.size(), std::size_t{1} << m)
                            << pixel << " " << dimension << " " << m << " " << a;
                    }
                }
            }
        }
    }
}

TEST(Sampler, SobolNumbersAreStratified) {
    for (std::uint32_t dimension = 0; dimension < 9; ++dimension) {
        for (int m = 1; m <= 10; ++m) {
            std::set<int> x, y;
            for (std::uint32_t i = 0; i < (1u << m); ++i) {
                const Vec2 u = Sampler(SamplerKind::sobol, 0, 5, i).get_2d(dimension);
                x.insert(static_cast<int>(std::ldexp(u.x, m)));
                y.insert(static_cast<int>(std::ldexp(u.y, m)));
                EXPECT_EQ(u.x, Sampler(SamplerKind::sobol, 0, 5, i).get_1d(dimension));
            }
            EXPECT_EQ(x.size(), std::size_t{1} << m);
            EXPECT_EQ(y.size(), std::size_t{1} << m);
        }
    }
}

TEST(Sampler, ValuesAreUniformOverPixels) {
    constexpr std::size_t kCells = 64;
    const double level = test::sidak(1e-3, 2 * 8);
    for (const SamplerKind kind : kKinds) {
        for (const std::uint32_t dimension : {0u, 1u, 2u, 3u, 17u, 100u, 1000u, 0xffffffffu}) {
            std::vector<double> counts(kCells * kCells), expected(kCells * kCells, 16);
            for (std::uint32_t pixel = 0; pixel < kCells * kCells * 16; ++pixel) {
                const Vec2 u = Sampler(kind, 3, pixel, pixel % 7).get_2d(dimension);
                const auto x = static_cast<std::size_t>(u.x * kCells), y = static_cast<std::size_t>(u.y * kCells);
                ++counts[y * kCells + x];
            }
            EXPECT_GT(test::chi_square_test(counts, expected), level) << static_cast<int>(kind) << " " << dimension;
        }
    }
}

/// Correlation of what two callables draw, in standard errors.
template <typename F, typename G>
double correlation(const F& f, const G& g) {
    const int n = 20'000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += (f(std::uint32_t(i)) - 0.5) * (g(std::uint32_t(i)) - 0.5) * 12;
    return sum / std::sqrt(n);
}

TEST(Sampler, PixelsSeedsAndDimensionsAreIndependent) {
    for (const SamplerKind kind : kKinds) {
        const auto base = [kind](std::uint32_t pixel) { return Sampler(kind, 1, pixel, 4).get_1d(2); };
        const auto other_dimension = [kind](std::uint32_t pixel) { return Sampler(kind, 1, pixel, 4).get_1d(3); };
        const auto other_seed = [kind](std::uint32_t pixel) { return Sampler(kind, 2, pixel, 4).get_1d(2); };
        const auto next_pixel = [kind](std::uint32_t pixel) { return Sampler(kind, 1, pixel + 1, 4).get_1d(2); };
        const auto shifted = [kind](std::uint32_t pixel) { return Sampler(kind, 1, pixel, 5).get_1d(40); };
        EXPECT_LT(std::abs(correlation(base, other_dimension)), 4);
        EXPECT_LT(std::abs(correlation(base, other_seed)), 4);
        EXPECT_LT(std::abs(correlation(base, next_pixel)), 4);
        EXPECT_LT(std::abs(correlation(base, shifted)), 4);
        EXPECT_GT(correlation(base, base), 100);
    }
}

TEST(Sampler, IntegrationError) {
    // Of exp(x y) over the unit square, whose integral is sum 1 / (k! (k + 1)^2). Independent samples must show the error
    // that the variance says, Sobol pairs a far smaller one; a product over two dimensions of the sampler keeps some gain.
    double exact = 0, square = 0, factorial = 1;
    for (int k = 0; k < 20; ++k) {
        if (k > 0) factorial *= k;
        exact += 1 / (factorial * (k + 1) * (k + 1));
        square += std::pow(2.0, k) / (factorial * (k + 1) * (k + 1));
    }
    const double sigma = std::sqrt(square - exact * exact);
    const auto rms = [&](SamplerKind kind, std::uint32_t n) {
        double sum = 0;
        for (std::uint32_t pixel = 0; pixel < 1000; ++pixel) {
            double mean = 0;
            for (std::uint32_t i = 0; i < n; ++i) {
                const Vec2 u = Sampler(kind, 0, pixel, i).get_2d(8);
                mean += std::exp(double(u.x) * u.y) / n;
            }
            sum += (mean - exact) * (mean - exact) / 1000;
        }
        return std::sqrt(sum);
    };
    for (const std::uint32_t n : {16u, 64u}) {
        EXPECT_NEAR(rms(SamplerKind::independent, n) * std::sqrt(n) / sigma, 1, 0.1);
    }
    EXPECT_LT(rms(SamplerKind::sobol, 64), 0.08 * sigma / 8);
    EXPECT_LT(rms(SamplerKind::sobol, 100), 0.2 * sigma / 10) << "between powers of two as well";
}

TEST(Sampler, ManyAtOnceDrawTheSame) {
    for (const SamplerKind kind : kKinds) {
        for (const std::uint32_t dimension : {0u, 1u, 3u, 4u, 18u, 1000003u}) {
            std::vector<Sampler> samplers;
            for (std::uint32_t i = 0; i < 77; ++i) samplers.emplace_back(kind, 5, i % 3, i < 70 ? i * i : ~i);
            std::vector<Vec2> numbers(samplers.size());
            draw_2d(samplers, dimension, numbers);
            for (std::size_t i = 0; i < samplers.size(); ++i) EXPECT_EQ(numbers[i], samplers[i].get_2d(dimension));
        }
    }
}

TEST(Sampler, DifferentSamplesDiffer) {
    for (const SamplerKind kind : kKinds) {
        std::set<float> values;
        for (std::uint32_t i = 0; i < 1000; ++i) values.insert(Sampler(kind, 0, 0, i).get_1d(0));
        EXPECT_GT(values.size(), 995u);
    }
}

}  // namespace
}  // namespace rayuela
