#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace rayuela {

/// A count of at least 1 as people write it: "700", "10k", "1M". Empty: it is none.
std::optional<std::size_t> parse_count(std::string_view text);
/// In the same way, with k and M where nothing is lost.
std::string count_text(std::size_t count);

}  // namespace rayuela
