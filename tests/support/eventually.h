#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace rayuela::test {

/// A minute, or as many as ctest says that sanitizers need.
inline std::chrono::minutes patience() {
    const char* const factor = std::getenv("RAYUELA_PATIENCE");
    return std::chrono::minutes(factor ? std::max(1, std::atoi(factor)) : 1);
}

/// Polls until `condition`, for as long as patience lasts: a machine under load is slow, a hang is a failure.
template <typename Condition>
::testing::AssertionResult eventually(Condition&& condition) {
    const auto deadline = std::chrono::steady_clock::now() + patience();
    while (!condition()) {
        if (std::chrono::steady_clock::now() > deadline)
            return ::testing::AssertionFailure() << "not within " << patience().count() << " minutes";
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return ::testing::AssertionSuccess();
}

}  // namespace rayuela::test
