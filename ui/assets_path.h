#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rayuela {

/// The folder assets/: $RAYUELA_ASSETS, else <program>/../share/rayuela, else the source tree that was compiled.
/// Empty where none exists.
std::filesystem::path assets_folder();

struct Example {
    std::filesystem::path file;
    std::string name;         ///< File stem.
    std::string description;  ///< First comment line of the file.
};
/// The scenes of assets/scenes by name.
std::vector<Example> example_scenes();

}  // namespace rayuela
