#include "app/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace rayuela {

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (drawn_) fmt::print(stderr, "\n");
}

void ProgressBar::show(double fraction, const std::string& text) {
    if (!terminal_) return;
    constexpr int kWidth = 30;
    const double clamped = std::clamp(fraction, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(clamped * kWidth);
    fmt::print(stderr, "\r\033[K[{}{}] {:3d}%  {}", std::string(filled, '#'), std::string(kWidth - filled, '.'),
               static_cast<int>(clamped * 100), text);
    std::fflush(stderr);
    drawn_ = true;
}

}  // namespace rayuela
