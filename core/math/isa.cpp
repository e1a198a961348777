#include "core/math/isa.h"

#include <hwy/highway.h>

#include <array>
#include <cstdint>
#include <utility>

namespace rayuela {
namespace {

constexpr std::array kSets{std::pair<std::string_view, std::int64_t>{"avx512", HWY_AVX3},
                           std::pair<std::string_view, std::int64_t>{"avx2", HWY_AVX2},
                           std::pair<std::string_view, std::int64_t>{"sse4", HWY_SSE4},
                           std::pair<std::string_view, std::int64_t>{"neon", HWY_NEON},
                           std::pair<std::string_view, std::int64_t>{"scalar", HWY_SCALAR | HWY_EMU128}};

}  // namespace

std::vector<std::string_view> instruction_sets() {
    std::vector<std::string_view> names;
    for (const auto& [name, bits] : kSets) {
        if ((bits & HWY_TARGETS & hwy::SupportedTargets()) != 0) names.push_back(name);
    }
    return names;
}

void use_instruction_set(std::string_view name) {
    for (const auto& [known, bits] : kSets) {
        if (known == name) hwy::GetChosenTarget().Update(bits & hwy::SupportedTargets());
    }
}

}  // namespace rayuela
