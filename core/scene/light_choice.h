#pragma once

#include <cstdint>

namespace rayuela {

/// How a path chooses the lamp that it asks for light at a point: all alike, by power, or by what each is estimated to send
/// there. The expected image is the same.
enum class LightChoice : std::uint8_t { uniform, power, arriving };

}  // namespace rayuela
