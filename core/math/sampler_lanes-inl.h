// Compiled once for each set of instructions (Google Highway), hence no plain include guard.
#if defined(RAYUELA_CORE_MATH_SAMPLER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYUELA_CORE_MATH_SAMPLER_LANES_INL_H_
#undef RAYUELA_CORE_MATH_SAMPLER_LANES_INL_H_
#else
#define RAYUELA_CORE_MATH_SAMPLER_LANES_INL_H_
#endif

#include "core/math/sampler.h"
#include "core/math/vec_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

HWY_INLINE Words all_words(std::uint32_t x) {
    return hn::Set(WordTag(), x);
}

HWY_INLINE Words mix_bits_32(Words x) {
    x = hn::Xor(x, hn::ShiftRight<16>(x));
    x = hn::Mul(x, all_words(kMixFactors[0]));
    x = hn::Xor(x, hn::ShiftRight<15>(x));
    x = hn::Mul(x, all_words(kMixFactors[1]));
    return hn::Xor(x, hn::ShiftRight<15>(x));
}

template <int kShift>
HWY_INLINE Words swap_bits(Words x, std::uint32_t low) {
    const Words mask = all_words(low);
    return hn::Or(hn::ShiftLeft<kShift>(hn::And(x, mask)), hn::And(hn::ShiftRight<kShift>(x), mask));
}

HWY_INLINE Words reverse_bits(Words x) {
    x = hn::Or(hn::ShiftLeft<16>(x), hn::ShiftRight<16>(x));
    x = swap_bits<8>(x, 0x00ff00ffu);
    x = swap_bits<4>(x, 0x0f0f0f0fu);
    x = swap_bits<2>(x, 0x33333333u);
    return swap_bits<1>(x, 0x55555555u);
}

HWY_INLINE Words owen_scramble_reversed(Words x, Words seed) {
    x = hn::Xor(x, hn::Mul(x, all_words(kOwenFactors[0])));
    x = hn::Add(x, seed);
    x = hn::Mul(x, hn::Or(hn::ShiftRight<16>(seed), all_words(1)));
    x = hn::Xor(x, hn::Mul(x, all_words(kOwenFactors[1])));
    return hn::Xor(x, hn::Mul(x, all_words(kOwenFactors[2])));
}

HWY_INLINE Floats to_unit_float(Words bits) {
    // Through signed numbers: 24 bits are none too many, and not every set of instructions converts others.
    const auto high = hn::BitCast(hn::RebindToSigned<FloatTag>(), hn::ShiftRight<8>(bits));
    return hn::ConvertTo(FloatTag(), high) * all_lanes(0x1p-24f);
}

/// Many samplers of one kind, one a lane, that draw the same dimension: the bits of Sampler::get_1d and get_2d.
class SamplerLanes {
public:
    HWY_INLINE SamplerLanes(SamplerKind kind, const std::uint32_t* key_0, const std::uint32_t* key_1,
                            const std::uint32_t* reversed_index)
        : kind_(kind),
          key_{hn::Load(WordTag(), key_0), hn::Load(WordTag(), key_1)},
          reversed_index_(hn::Load(WordTag(), reversed_index)) {}

    HWY_INLINE Floats get_1d(std::uint32_t dimension) const {
        const Words hash = hashed(dimension, 0);
        if (kind_ == SamplerKind::independent) return to_unit_float(hash);
        Words first = hn::Zero(WordTag()), second = first;
        sobol_reversed(dimension, first, second);
        return scrambled(first, dimension, hash);
    }

    HWY_INLINE Vec2Lanes get_2d(std::uint32_t dimension) const {
        const Words first_hash = hashed(dimension, 0), second_hash = hashed(dimension, 1);
        if (kind_ == SamplerKind::independent) return {to_unit_float(first_hash), to_unit_float(second_hash)};
        Words first = hn::Zero(WordTag()), second = first;
        sobol_reversed(dimension, first, second);
        return {scrambled(first, dimension, first_hash), scrambled(second, dimension, second_hash)};
    }

private:
    HWY_INLINE Words hashed(std::uint32_t dimension, std::size_t half) const {
        const Words salt = all_words(dimension_salt(dimension));
        return mix_bits_32(hn::Add(mix_bits_32(hn::Xor(key_[half], salt)), key_[1 - half]));
    }

    static HWY_INLINE Floats scrambled(Words x, std::uint32_t dimension, Words seed) {
        Words digits = owen_scramble_reversed(x, seed);
        if (dimension % kSobolPairs == 0) {
            const Words fixed = all_words(kFixedMask);
            digits = hn::Or(hn::AndNot(fixed, digits), hn::And(hn::Xor(x, seed), fixed));
        }
        return to_unit_float(reverse_bits(digits));
    }

    /// Both dimensions of a pair at the shuffled index, whose bits stand in reverse order here.
    HWY_INLINE void sobol_reversed(std::uint32_t dimension, Words& first, Words& second) const {
        const WordTag dw;
        const Words seed = mix_bits_32(hn::Add(mix_bits_32(hn::Xor(key_[0], all_words(set_salt(dimension)))), key_[1]));
        Words index =
            hn::Xor(owen_scramble_reversed(reversed_index_, seed), owen_scramble_reversed(hn::Zero(dw), seed));
        const std::size_t pair = 2 * (dimension % kSobolPairs);
        const hn::RebindToSigned<WordTag> di;
        for (std::size_t bit = 0; !hn::AllTrue(dw, hn::Eq(index, hn::Zero(dw))); ++bit) {
            // The sign bit of the word, spread over all of it.
            const Words set = hn::BitCast(dw, hn::BroadcastSignBit(hn::BitCast(di, index)));
            first = hn::Xor(first, hn::And(set, all_words(kSobolMatrix[pair][bit])));
            second = hn::Xor(second, hn::And(set, all_words(kSobolMatrix[pair + 1][bit])));
            index = hn::ShiftLeft<1>(index);
        }
    }

    SamplerKind kind_;
    Words key_[2];
    Words reversed_index_;
};

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
