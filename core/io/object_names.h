#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rayuela {

struct ObjectName {
    std::string_view label;  ///< Of the object's shape: "Sphere".
    std::string name;
};

/// Names those that have no name after their label, numbered in their order: "Sphere", "Sphere 2"... without a name
/// that another has.
void fill_in_names(std::vector<ObjectName>& objects);

/// Which names `fill_in_names` would give again if they were left out: for all objects or, where one name would change,
/// for none. So a file that was written without names is saved without them.
std::vector<bool> names_to_leave_out(const std::vector<ObjectName>& objects);

}  // namespace rayuela
