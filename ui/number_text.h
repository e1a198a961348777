#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rayuela {

/// "3.2 ms", "12.3 s", "3 min 20 s", "2 h 5 min".
std::string duration_text(double seconds);
/// "980", "12.3k", "4.56M".
std::string count_text(double count);
/// "980 B", "12.3 kB", "4.56 Msamples/s".
std::string quantity_text(double value, const char* unit);
/// All digits, in groups of three: "1 234 567".
std::string grouped_text(std::uint64_t value);
/// "12.3 kB" where the unit is "bytes", else all digits and the unit, a plural: "1 234 objects", "1 object".
std::string amount_text(std::uint64_t value, std::string_view unit);

}  // namespace rayuela
