#pragma once

#include "core/math/sampler.h"

#include <span>

namespace rayuela {

/// numbers[i] becomes samplers[i].get_1d(dimension), many at once. All samplers are of one kind.
void draw_1d(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<float> numbers);

/// numbers[i] becomes samplers[i].get_2d(dimension), many at once. All samplers are of one kind.
void draw_2d(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> numbers);

/// points[i] becomes sample_concentric_disk of the pair that samplers[i] draws.
void draw_disk(std::span<const Sampler> samplers, std::uint32_t dimension, std::span<Vec2> points);

}  // namespace rayuela
