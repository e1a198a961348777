#pragma once

#include "core/math/result.h"
#include "core/render/path_tracer.h"
#include "core/render/sampling_options.h"
#include "core/scene/scene.h"

#include <string>
#include <vector>

namespace rayuela {

/// Settings to measure with, over what a scene file says.
struct BenchVariant {
    std::string name;
    std::vector<std::string> settings;  ///< Each "name=value".
    std::size_t base = 0;               ///< Number of the variant that it is compared with; its own where it is none.
};

/// One variant of all `set`, or for each `compare`, "name=value,value...", one of each of its values, compared with the first.
Result<std::vector<BenchVariant>> make_variants(const std::vector<std::string>& set,
                                                const std::vector<std::string>& compare);

struct VariantScene {
    Scene scene;
    PathTracerOptions options;
    SamplingOptions sampling;
};
/// Problems: a name that is no setting, a value that it cannot have.
Result<VariantScene> apply_settings(const Scene& scene, const std::vector<std::string>& settings);

/// Names of the settings, for help and messages.
std::vector<std::string> setting_names();

}  // namespace rayuela
