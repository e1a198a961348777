#pragma once

#include "core/math/result.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayuela {

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class PlyEncoding : std::uint8_t { ascii, little, big };

struct PlyProperty {
    std::string name;
    PlyType type;
    std::optional<PlyType> count_type;  ///< Of a list.
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;
    std::vector<PlyElement> elements;
};

/// Reads the header at the beginning of `bytes` and leaves what follows it. `name` is the file's, for problems.
Result<PlyHeader> read_ply_header(std::string_view& bytes, const std::string& name);

}  // namespace rayuela
