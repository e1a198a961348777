#include "core/io/file_bytes.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace rayuela {

namespace fs = std::filesystem;

Result<std::string> read_file(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) return fail(path.string(), "", "no such file");
    if (fs::is_directory(status)) return fail(path.string(), "", "is a folder, not a file");
    if (!fs::is_regular_file(status)) return fail(path.string(), "", "is not a regular file");
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) return fail(path.string(), "", error.message());
    if (size > kMaxFileBytes) return fail(path.string(), "", "is larger than 4 GiB");

    std::ifstream file(path, std::ios::binary);
    if (!file) return fail(path.string(), "", std::strerror(errno));
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    if (file.bad()) return fail(path.string(), "", "cannot be read");
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

Result<void> write_file(const fs::path& path, std::string_view bytes) {
    static std::atomic<unsigned> counter{0};
    fs::path temporary = path;
    temporary += ".tmp" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    {
        std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
        if (!file) return fail(path.string(), "", std::string("cannot be written: ") + std::strerror(errno));
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) {
            const std::string cause = std::strerror(errno);
            std::error_code ignored;
            fs::remove(temporary, ignored);
            return fail(path.string(), "", "cannot be written: " + cause);
        }
    }
    std::error_code error;
    fs::rename(temporary, path, error);
    if (error) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        return fail(path.string(), "", "cannot be written: " + error.message());
    }
    return {};
}

std::string lower_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    return extension;
}

}  // namespace rayuela
