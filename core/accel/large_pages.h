#pragma once

#include <cstddef>

namespace rayuela {

/// Asks the system for large pages where rays will read here and there: their addresses are translated from fewer entries.
/// Call it before the memory is first touched. Without effect where the system knows none or the memory is small.
void prefer_large_pages(void* data, std::size_t bytes);

}  // namespace rayuela
