#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_group.h>

#include <atomic>
#include <utility>

namespace rayuela {

/// Makes what came before `publish` visible after `observe`. TBB does so itself, but inside a library that
/// ThreadSanitizer cannot look into; here it can. Nothing elsewhere. All parallel work starts in this file, for what runs
/// without it in a task of TBB is reported as a race though it is none.
class Handover {
public:
#ifdef RAYUELA_TSAN
    void publish() {
        count_.fetch_add(1, std::memory_order_release);
    }
    void observe() const {
        (void)count_.load(std::memory_order_acquire);
    }

private:
    std::atomic<int> count_{0};
#else
    void publish() {}
    void observe() const {}
#endif
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
template <typename Body, typename Partitioner = tbb::auto_partitioner>
void parallel_ranges(std::size_t count, std::size_t grain, const Body& body, const Partitioner& partitioner = {}) {
    Handover start, end;
    const auto part = [&](const tbb::blocked_range<std::size_t>& range) {
        start.observe();
        body(range.begin(), range.end());
        end.publish();
    };
    start.publish();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), part, partitioner);
    end.observe();
}

/// Runs body(i) for i in [0, count) in any order; each may take long.
template <typename Body>
void parallel_each(std::size_t count, const Body& body) {
    parallel_ranges(
        count, 1, [&](std::size_t i, std::size_t) { body(i); }, tbb::simple_partitioner());
}

/// join(.., ..) of the add(begin, end) over [begin, end) in parts of at most `grain` elements. Parts and the order in which
/// they are joined are the same for any number of threads.
template <typename Add, typename Join>
auto parallel_sum(std::size_t begin, std::size_t end, std::size_t grain, const Add& add, const Join& join)
    -> decltype(add(begin, end)) {
    if (end - begin <= grain) return add(begin, end);
    const std::size_t middle = begin + (end - begin) / 2;
    decltype(add(begin, end)) first, second;
    fork_join([&] { first = parallel_sum(begin, middle, grain, add, join); },
              [&] { second = parallel_sum(middle, end, grain, add, join); });
    return join(std::move(first), std::move(second));
}

}  // namespace rayuela
