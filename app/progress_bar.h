#pragma once

#include <string>

namespace rayuela {

/// One line on standard error that is rewritten in place; nothing where that is no terminal.
class ProgressBar {
public:
    ProgressBar();
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// `fraction` in [0, 1] (shown floored, so that 100% means done), `text` behind the bar.
    void show(double fraction, const std::string& text);

private:
    bool terminal_;
    bool drawn_ = false;
};

}  // namespace rayuela
