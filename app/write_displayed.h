#pragma once

#include "core/math/image.h"
#include "core/math/result.h"

#include <filesystem>

namespace rayuela {

/// Writes an image whose values are as displayed (sRGB).
Result<void> write_displayed(const std::filesystem::path& file, Image image);

}  // namespace rayuela
