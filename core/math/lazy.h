#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

namespace rayuela {

/// What is made when somebody first asks for it and lives for as long as anyone holds it; meanwhile all get the same. Any
/// thread: while one makes it the others wait.
template <typename T>
class Lazy {
public:
    using Make = std::function<std::shared_ptr<const T>()>;

    /// `make` returns null where it fails, and may be called again. `bytes`: what it keeps in memory to make it from.
    explicit Lazy(Make make, std::uint64_t bytes = 0) : make_(std::move(make)), bytes_(bytes) {}

    std::shared_ptr<const T> get() const {
        const std::lock_guard lock(making_);
        std::shared_ptr<const T> made = if_made();
        if (made) return made;
        made = make_();
        const std::lock_guard writing(mutex_);
        made_ = made;
        return made;
    }
    /// Null where nobody holds it. Does not wait for one who makes it.
    std::shared_ptr<const T> if_made() const {
        const std::lock_guard lock(mutex_);
        return made_.lock();
    }
    std::uint64_t source_bytes() const { return bytes_; }

private:
    Make make_;
    std::uint64_t bytes_;
    mutable std::mutex making_;
    mutable std::mutex mutex_;  ///< Of made_, held but for a moment.
    mutable std::weak_ptr<const T> made_;
};

}  // namespace rayuela
