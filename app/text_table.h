#pragma once

#include "core/math/statistics.h"

#include <string>
#include <vector>

namespace rayuela {

/// Rows of text in columns as wide as they need: the first ones, of names, flush left, the others flush right.
class TextTable {
public:
    TextTable(std::size_t name_columns, std::vector<std::string> header)
        : name_columns_(name_columns), rows_{std::move(header)} {}

    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    /// Header, a line, rows; each ends a line.
    std::string text() const;

private:
    std::size_t name_columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// With two digits after the point, or two that say something where that is more.
std::string short_number(double value);
/// "low - high".
std::string interval_text(const Interval& interval);

}  // namespace rayuela
