#include "app/write_text.h"

#include <fstream>

namespace rayuela {

Result<void> write_text(const std::filesystem::path& file, std::string_view text) {
    if (file.empty()) return {};
    std::ofstream stream(file);
    stream << text;
    if (!stream.flush()) return fail(file.string(), "", "cannot be written");
    return {};
}

}  // namespace rayuela
