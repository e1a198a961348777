#pragma once

#include "tests/support/accel_scenes.h"

#include <bit>

namespace rayuela::test {

inline bool identical(const Hit& a, const Hit& b) {
    return std::bit_cast<std::uint32_t>(a.t) == std::bit_cast<std::uint32_t>(b.t) &&
           std::bit_cast<std::uint32_t>(a.u) == std::bit_cast<std::uint32_t>(b.u) &&
           std::bit_cast<std::uint32_t>(a.v) == std::bit_cast<std::uint32_t>(b.v) && a.object == b.object &&
           a.primitive == b.primitive &&
           std::bit_cast<std::uint32_t>(a.t_rest) == std::bit_cast<std::uint32_t>(b.t_rest);
}

struct Answers {
    std::vector<Hit> hits;
    std::vector<std::uint8_t> blocked;
};

inline Answers trace(const Accelerator& accelerator, const std::vector<Ray>& rays) {
    Answers answers{std::vector<Hit>(rays.size()), std::vector<std::uint8_t>(rays.size())};
    accelerator.intersect(rays, answers.hits);
    accelerator.occluded(rays, answers.blocked);
    return answers;
}

}  // namespace rayuela::test
