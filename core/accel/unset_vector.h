#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace rayuela {

/// Leaves new elements as the memory was.
template <typename T>
struct UnsetAllocator : std::allocator<T> {
    template <typename U>
    struct rebind {
        using other = UnsetAllocator<U>;
    };
    void construct(T*) const noexcept {}
    template <typename... Arguments>
    void construct(T* at, Arguments&&... arguments) const {
        std::construct_at(at, std::forward<Arguments>(arguments)...);
    }
};

/// Of elements that are written before they are read: the threads that write them touch the memory first.
template <typename T>
using UnsetVector = std::vector<T, UnsetAllocator<T>>;

}  // namespace rayuela
