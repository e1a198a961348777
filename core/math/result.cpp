#include "core/math/result.h"

namespace rayuela {

std::string Problem::message() const {
    std::string text;
    for (const std::string* part : {&file, &place, &cause}) {
        if (part->empty()) continue;
        if (!text.empty()) text += ": ";
        text += *part;
    }
    return text;
}

std::string to_string(const Problems& problems) {
    std::string text;
    for (const Problem& problem : problems) text += (text.empty() ? "" : "\n") + problem.message();
    return text;
}

}  // namespace rayuela
