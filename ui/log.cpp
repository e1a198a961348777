#include "ui/log.h"

namespace rayuela {

void Log::add(LogLevel level, std::string text) {
    const auto now = std::chrono::system_clock::now();
    if (!entries_.empty() && entries_.back().level == level && entries_.back().text == text) {
        entries_.back().time = now;
        ++entries_.back().count;
        return;
    }
    if (entries_.size() >= kMaxLogEntries) entries_.erase(entries_.begin());
    entries_.push_back({now, level, std::move(text)});
}

void Log::add(LogLevel level, const Problems& problems) {
    for (const Problem& problem : problems) add(level, problem.message());
}

}  // namespace rayuela
