#pragma once

#include "core/render/skips.h"

#include <fmt/format.h>

#include <string>

// The rows of skips_of, by what is left out. Only for core/render/skips*.cpp.

namespace rayuela {

std::vector<Skip> skips_of_light(const RenderScene& scene);
/// `statistics`: of a render of the scene, or of none.
std::vector<Skip> skips_of_work(const RenderScene& scene, const RenderStatistics& statistics);
std::vector<Skip> skips_of_memory(const RenderScene& scene);

/// Of what every scene asks for that has no reason to do without.
inline SkipState skipped_if(bool condition) {
    return condition ? SkipState::skipped : SkipState::needed;
}

/// Of what is always left out where there is some.
inline SkipState skipped_where(bool present) {
    return present ? SkipState::skipped : SkipState::absent;
}

inline std::string count_of(std::uint64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace rayuela
