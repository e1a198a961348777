#include "ui/number_text.h"

#include <fmt/format.h>

namespace rayuela {

namespace {

constexpr const char* kPrefixes[] = {"", "k", "M", "G", "T"};

/// A value below 1000 with three digits, and the prefix that it lacks.
struct Scaled {
    std::string digits;
    const char* prefix;
};

Scaled scaled(double value) {
    std::size_t prefix = 0;
    while (value >= 999.5 && prefix + 1 < std::size(kPrefixes)) {
        value /= 1000;
        ++prefix;
    }
    const int decimals = prefix == 0 || value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return {fmt::format("{:.{}f}", value, decimals), kPrefixes[prefix]};
}

}  // namespace

std::string duration_text(double seconds) {
    if (seconds > 0 && seconds < 1) return fmt::format("{:.1f} ms", seconds * 1000);
    if (seconds < 60) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<long>(seconds);
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string count_text(double count) {
    const auto [digits, prefix] = scaled(count);
    return digits + prefix;
}

std::string quantity_text(double value, const char* unit) {
    const auto [digits, prefix] = scaled(value);
    return fmt::format("{} {}{}", digits, prefix, unit);
}

std::string grouped_text(std::uint64_t value) {
    std::string digits = std::to_string(value);
    for (auto i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3) {
        digits.insert(static_cast<std::size_t>(i), " ");
    }
    return digits;
}

std::string amount_text(std::uint64_t value, std::string_view unit) {
    if (unit == "bytes") return quantity_text(static_cast<double>(value), "B");
    if (value == 1 && unit.ends_with('s')) unit.remove_suffix(1);
    return fmt::format("{} {}", grouped_text(value), unit);
}

}  // namespace rayuela
