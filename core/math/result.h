#pragma once

#include <tl/expected.hpp>

#include <string>
#include <vector>

namespace rayuela {

/// One thing wrong with an input: the file, the place in it and the cause, each for a person to read.
struct Problem {
    std::string file;   ///< Path as the user gave it; empty for an edit.
    std::string place;  ///< JSON path, line number, "node 3"...; may be empty.
    std::string cause;

    /// "file: place: cause" without the empty parts.
    std::string message() const;

    bool operator==(const Problem&) const = default;
};

using Problems = std::vector<Problem>;

/// A value, or every problem found.
template <typename T>
using Result = tl::expected<T, Problems>;

inline tl::unexpected<Problems> fail(std::string file, std::string place, std::string cause) {
    return tl::unexpected<Problems>({{std::move(file), std::move(place), std::move(cause)}});
}

/// One message a line.
std::string to_string(const Problems& problems);

}  // namespace rayuela
