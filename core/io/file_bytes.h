#pragma once

#include "core/math/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace rayuela {

/// The largest file that is read.
inline constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 32;

/// The whole content of a regular file.
Result<std::string> read_file(const std::filesystem::path& path);

/// Replaces a file: readers see the old content or the new one, never a part (a temporary file beside it is renamed).
Result<void> write_file(const std::filesystem::path& path, std::string_view bytes);

/// ".PNG" -> ".png"; empty without an extension.
std::string lower_extension(const std::filesystem::path& path);

}  // namespace rayuela
