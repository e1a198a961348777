#pragma once

#include "core/math/isa.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace rayuela {

/// "--isa" for one set of instructions or several, by their names.
inline CLI::Option* add_isa(CLI::App& command, std::vector<std::string>& names) {
    const std::vector<std::string_view> sets = instruction_sets();
    return command.add_option("--isa", names, "Instructions that the kernels use; the image is the same with all")
        ->check(CLI::IsMember(std::vector<std::string>(sets.begin(), sets.end())));
}

}  // namespace rayuela
