#pragma once

#include "core/math/result.h"

#include <filesystem>
#include <string_view>

namespace rayuela {

/// Writes to a file, or to a device like /dev/stdout. Does nothing where `file` is empty.
Result<void> write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace rayuela
