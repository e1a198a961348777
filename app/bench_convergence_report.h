#pragma once

#include "app/bench_convergence.h"

#include <nlohmann/json_fwd.hpp>

namespace rayuela {

/// Error and cost at every checkpoint.
std::string checkpoint_table(const SceneConvergence& scene);
/// A row a scene and variant: speed, slope, efficiency, bias, seconds to equal error, error after equal time.
std::string summary_table(const std::vector<SceneConvergence>& scenes);
/// What each variant is worth against the one that it is compared with; empty where there is none.
std::string comparison_table(const std::vector<SceneConvergence>& scenes);
/// All of it.
nlohmann::ordered_json convergence_json(const std::vector<SceneConvergence>& scenes);

}  // namespace rayuela
