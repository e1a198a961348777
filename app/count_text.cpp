#include "app/count_text.h"

#include <charconv>

namespace rayuela {

std::optional<std::size_t> parse_count(std::string_view text) {
    std::size_t unit = 1;
    if (text.ends_with('k')) unit = 1'000;
    if (text.ends_with('M')) unit = 1'000'000;
    if (unit > 1) text.remove_suffix(1);
    constexpr std::size_t kLargest = 1'000'000'000;
    std::size_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    if (count == 0 || count > kLargest / unit) return {};
    return count * unit;
}

std::string count_text(std::size_t count) {
    if (count % 1'000'000 == 0) return std::to_string(count / 1'000'000) + "M";
    if (count % 1'000 == 0) return std::to_string(count / 1'000) + "k";
    return std::to_string(count);
}

}  // namespace rayuela
