#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace rayuela {

/// Identity that survives edits. 0 is "none".
template <typename Tag>
struct Id {
    std::uint32_t value = 0;

    explicit operator bool() const { return value != 0; }
    auto operator<=>(const Id&) const = default;
};

using ObjectId = Id<struct ObjectTag>;
using MaterialId = Id<struct MaterialTag>;

}  // namespace rayuela

template <typename Tag>
struct std::hash<rayuela::Id<Tag>> {
    std::size_t operator()(rayuela::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>()(id.value); }
};
