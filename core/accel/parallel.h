#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <atomic>

namespace rayuela {

/// Makes what came before `publish` visible after `observe`. TBB does so itself, but inside a library that
/// ThreadSanitizer cannot look into; here it can.
class Handover {
public:
    void publish() { count_.fetch_add(1, std::memory_order_release); }
    void observe() const { (void)count_.load(std::memory_order_acquire); }

private:
    std::atomic<int> count_{0};
};

/// Runs both, at the same time where a thread is free, and returns when both are done.
template <typename First, typename Second>
void fork_join(const First& first, const Second& second) {
    Handover start, end;
    start.publish();
    tbb::task_group group;
    group.run([&] {
        start.observe();
        first();
        end.publish();
    });
    second();
    group.wait();
    end.observe();
}

/// Runs body(begin, end) over parts of [0, count) of about `grain` elements, in any order.
template <typename Body>
void parallel_ranges(std::size_t count, std::size_t grain, const Body& body) {
    Handover start, end;
    start.publish();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
        start.observe();
        body(range.begin(), range.end());
        end.publish();
    });
    end.observe();
}

}  // namespace rayuela
