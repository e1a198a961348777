#include "core/math/lazy.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace rayuela {
namespace {

TEST(Lazy, IsMadeOnceWhileSomebodyHoldsIt) {
    int made = 0;
    const Lazy<int> lazy([&] { return std::make_shared<const int>(++made); }, 5);
    EXPECT_EQ(lazy.source_bytes(), 5u);
    EXPECT_EQ(lazy.if_made(), nullptr);
    EXPECT_EQ(made, 0);
    auto held = lazy.get();
    EXPECT_EQ(lazy.get(), held);
    EXPECT_EQ(lazy.if_made(), held);
    EXPECT_EQ(made, 1);
    held.reset();
    EXPECT_EQ(lazy.if_made(), nullptr);
    EXPECT_EQ(*lazy.get(), 2);
}

TEST(Lazy, AskingWhetherItIsMadeDoesNotWait) {
    const Lazy<int>* lazy = nullptr;
    const Lazy<int> slow([&] {
        std::jthread([&] { EXPECT_EQ(lazy->if_made(), nullptr); }).join();
        return std::make_shared<const int>(1);
    });
    lazy = &slow;
    EXPECT_EQ(*slow.get(), 1);
}

TEST(Lazy, WhatFailsIsTriedAgain) {
    int tried = 0;
    const Lazy<int> lazy([&] { return ++tried < 2 ? nullptr : std::make_shared<const int>(7); });
    EXPECT_EQ(lazy.get(), nullptr);
    EXPECT_EQ(*lazy.get(), 7);
}

TEST(Lazy, AllThreadsGetTheSame) {
    std::atomic<int> made = 0;
    const Lazy<int> lazy([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return std::make_shared<const int>(++made);
    });
    std::vector<std::shared_ptr<const int>> got(8);
    {
        std::vector<std::jthread> threads;
        for (auto& one : got) threads.emplace_back([&] { one = lazy.get(); });
    }
    EXPECT_EQ(made, 1);
    for (const auto& one : got) EXPECT_EQ(one, got[0]);
}

}  // namespace
}  // namespace rayuela
