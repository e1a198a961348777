#pragma once

#include "core/math/result.h"

#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rayuela {

struct ReferenceOptions {
    std::filesystem::path scene;
    std::vector<std::filesystem::path> outputs;  ///< Of the two halves.
    std::vector<std::string> set;                ///< "name=value", as of `bench convergence`.
    std::optional<glm::ivec2> size;              ///< Instead of the film's.
    bool brute_force = false;
    int spp = 4096;
    int threads = 0;
};

/// Renders the truth that `bench convergence` measures against: twice the scene, independent of each other and of all seeds
/// that are measured.
Result<void> run_reference(const ReferenceOptions& options);

}  // namespace rayuela
