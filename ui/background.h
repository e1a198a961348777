#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>

namespace rayuela {

/// One piece of work at a time, on a thread of its own. Nothing waits but the destructor, for work that has been told to
/// stop.
template <typename T>
class Background {
public:
    using Clock = std::chrono::steady_clock;
    using Work = std::function<T(const std::atomic<bool>& cancelled)>;

    Background() = default;
    ~Background() { cancel(); }
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    bool is_busy() const { return result_.valid(); }
    /// Of the work under way.
    double seconds() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

    /// Not while busy.
    void start(Work work) {
        *cancelled_ = false;
        started_ = Clock::now();
        result_ = std::async(std::launch::async,
                             [work = std::move(work), cancelled = cancelled_] { return work(*cancelled); });
    }
    /// Asks the work to stop; its result, whatever it is, is still to be taken.
    void cancel() { *cancelled_ = true; }
    bool is_cancelled() const { return *cancelled_; }

    /// The result, once it is there.
    std::optional<T> take() {
        if (!is_busy() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
        return result_.get();
    }

private:
    std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
    Clock::time_point started_;
    std::future<T> result_;
};

}  // namespace rayuela
