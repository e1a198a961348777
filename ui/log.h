#pragma once

#include "core/math/result.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace rayuela {

enum class LogLevel : std::uint8_t { info, warning, error };

struct LogEntry {
    std::chrono::system_clock::time_point time;
    LogLevel level = LogLevel::info;
    std::string text;
    int count = 1;  ///< How often in a row it has happened.
};

inline constexpr std::size_t kMaxLogEntries = 5000;

/// What has happened, newest last; the oldest beyond kMaxLogEntries are forgotten. Used by the UI thread only.
class Log {
public:
    void add(LogLevel level, std::string text);
    void add(LogLevel level, const Problems& problems);
    const std::vector<LogEntry>& entries() const { return entries_; }
    void clear() { entries_.clear(); }

private:
    std::vector<LogEntry> entries_;
};

}  // namespace rayuela
