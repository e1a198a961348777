#include "core/io/put_aside.h"

#include "core/math/vec.h"

#include <stdlib.h>
#include <unistd.h>

#include <cstdio>

namespace rayuela {

namespace {

struct FileClose {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileClose>;

/// Where it does not lie in memory, as /tmp does on many systems.
File open_nameless() {
    char name[] = "/var/tmp/rayuela-XXXXXX";
    const int descriptor = ::mkstemp(name);
    if (descriptor < 0) return File(std::tmpfile());
    ::unlink(name);
    File file(::fdopen(descriptor, "w+b"));
    if (!file) ::close(descriptor);
    return file;
}

}  // namespace

template <typename T>
std::shared_ptr<const Lazy<std::vector<T>>> put_aside(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::shared_ptr<std::FILE> file = open_nameless();
    const std::size_t count = values.size();
    if (!file || std::fwrite(values.data(), sizeof(T), count, file.get()) != count || std::fflush(file.get()) != 0)
        return nullptr;
    return std::make_shared<const Lazy<std::vector<T>>>([file, count]() -> std::shared_ptr<const std::vector<T>> {
        auto read = std::make_shared<std::vector<T>>(count);
        std::rewind(file.get());
        if (std::fread(read->data(), sizeof(T), count, file.get()) != count) return nullptr;
        return read;
    });
}

template std::shared_ptr<const Lazy<std::vector<Vec2>>> put_aside(const std::vector<Vec2>&);

}  // namespace rayuela
