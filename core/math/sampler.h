#pragma once

#include "core/math/vec.h"

#include <cstdint>

namespace rayuela {

enum class SamplerKind : std::uint8_t {
    independent,  ///< Hashed, without any structure: error falls as 1 / sqrt(N).
    sobol,        ///< Owen-scrambled Sobol pairs: any 2^k consecutive samples from a multiple of 2^k are stratified.
};

/// Finalizer of splitmix64 (Stafford's mix 13): every input bit flips each output bit with probability 1/2.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// Owen's nested uniform scrambling in base 2 of a number whose bits are in reverse order (bit 0 is 1/2): a bit is
/// flipped by a hash of the bits below it. Laine & Karras 2011, with Vegdahl's constants (2021).
constexpr std::uint32_t owen_scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Second dimension of the Sobol sequence at `index`, bits in reverse order: the product with Pascal's triangle mod 2
/// (Ahmed, "An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact", EGSR 2024). The first
/// dimension, likewise reversed, is the index itself.
constexpr std::uint32_t sobol_second_reversed(std::uint32_t index) {
    index ^= index >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    return index ^ ((index & 0xaaaaaaaau) >> 1);
}

/// The largest multiple of 2^-24 below 1 that `bits` / 2^32 reaches; in [0, 1 - 2^-24].
constexpr float to_unit_float(std::uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24f;
}

/// Random numbers of one sample of one pixel. They depend on nothing but (kind, seed, pixel, sample, dimension), so that
/// any sample can be replayed alone and in any order. A dimension names one draw, of one number or of a pair, and must
/// not be used for two: different dimensions of a sample are independent of each other. All values in [0, 1 - 2^-24].
///
/// sobol: each dimension is a (0, 2)-sequence over the samples of the pixel, Owen-scrambled, its index shuffled by the
/// same scrambling so that dimensions can be padded (Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020).
class Sampler {
public:
    Sampler() = default;
    Sampler(SamplerKind kind, std::uint32_t seed, std::uint32_t pixel_index, std::uint32_t sample_index)
        : key_(mix_bits(mix_bits((std::uint64_t{seed} << 32) | pixel_index) + 0x9e3779b97f4a7c15u)), kind_(kind) {
        if (kind == SamplerKind::independent) {
            key_ = mix_bits(key_ + sample_index);
        } else {
            reversed_index_ = reverse_bits(sample_index);
        }
    }

    float get_1d(std::uint32_t dimension) const {
        const std::uint64_t hash = dimension_hash(dimension);
        const std::uint32_t low = static_cast<std::uint32_t>(hash), high = static_cast<std::uint32_t>(hash >> 32);
        if (kind_ == SamplerKind::independent) return to_unit_float(high);
        return to_unit_float(reverse_bits(owen_scramble_reversed(shuffled_index(low), high)));
    }

    Vec2 get_2d(std::uint32_t dimension) const {
        const std::uint64_t hash = dimension_hash(dimension);
        const std::uint32_t low = static_cast<std::uint32_t>(hash), high = static_cast<std::uint32_t>(hash >> 32);
        if (kind_ == SamplerKind::independent) return {to_unit_float(high), to_unit_float(low)};
        const std::uint32_t index = shuffled_index(low);
        const std::uint32_t third = static_cast<std::uint32_t>((hash * 0xd1342543de82ef95u) >> 32);
        return {to_unit_float(reverse_bits(owen_scramble_reversed(index, high))),
                to_unit_float(reverse_bits(owen_scramble_reversed(sobol_second_reversed(index), third)))};
    }

private:
    std::uint64_t dimension_hash(std::uint32_t dimension) const {
        return mix_bits(key_ + std::uint64_t{dimension} * 0x9e3779b97f4a7c15u);
    }
    std::uint32_t shuffled_index(std::uint32_t seed) const {
        return reverse_bits(owen_scramble_reversed(reversed_index_, seed));
    }

    std::uint64_t key_ = 0;  ///< Of seed and pixel; for independent samples of the sample as well.
    std::uint32_t reversed_index_ = 0;
    SamplerKind kind_ = SamplerKind::independent;
};

}  // namespace rayuela
