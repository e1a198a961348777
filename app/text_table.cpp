#include "app/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rayuela {

std::string TextTable::text() const {
    std::vector<std::size_t> widths;
    for (const auto& row : rows_) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        std::string line;
        for (std::size_t i = 0; i < rows_[r].size(); ++i) {
            if (i > 0) line += "  ";
            const std::string& cell = rows_[r][i];
            line += i < name_columns_ ? fmt::format("{:<{}}", cell, widths[i]) : fmt::format("{:>{}}", cell, widths[i]);
        }
        text += line + '\n';
        if (r == 0) text += std::string(line.size(), '-') + '\n';
    }
    return text;
}

std::string short_number(double value) {
    constexpr double kSmall = 0.1;
    return std::fabs(value) < kSmall ? fmt::format("{:.2g}", value) : fmt::format("{:.2f}", value);
}

std::string interval_text(const Interval& interval) {
    return short_number(interval.low) + " - " + short_number(interval.high);
}

}  // namespace rayuela
