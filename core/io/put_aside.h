#pragma once

#include "core/math/lazy.h"

#include <memory>
#include <vector>

namespace rayuela {

/// Texture coordinates that take less stay in memory: a file costs more than it saves.
inline constexpr std::size_t kSmallestAside = std::size_t{1} << 20;

/// The values in a file of their own that has no name and is gone with them, to be read when somebody asks. Null where
/// there is no room for one. Where the file cannot be read back it gives null.
template <typename T>
std::shared_ptr<const Lazy<std::vector<T>>> put_aside(const std::vector<T>& values);

}  // namespace rayuela
