#include "core/io/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace rayuela {

namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", PlyType::i8},
                                               {"int8", PlyType::i8},
                                               {"uchar", PlyType::u8},
                                               {"uint8", PlyType::u8},
                                               {"short", PlyType::i16},
                                               {"int16", PlyType::i16},
                                               {"ushort", PlyType::u16},
                                               {"uint16", PlyType::u16},
                                               {"int", PlyType::i32},
                                               {"int32", PlyType::i32},
                                               {"uint", PlyType::u32},
                                               {"uint32", PlyType::u32},
                                               {"float", PlyType::f32},
                                               {"float32", PlyType::f32},
                                               {"double", PlyType::f64},
                                               {"float64", PlyType::f64}}};

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (line.empty()) return words;
        words.push_back(line.substr(0, line.find_first_of(" \t")));
        line.remove_prefix(words.back().size());
    }
}

std::optional<PlyType> find_type(std::string_view name) {
    const auto found = std::ranges::find(kTypeNames, name, &TypeName::name);
    return found == kTypeNames.end() ? std::nullopt : std::optional(found->type);
}

class HeaderParser {
public:
    HeaderParser(std::string_view& rest, const std::string& name) : rest_(rest), name_(name) {}

    Result<PlyHeader> run() {
        PlyHeader header;
        if (next_line() != "ply") return bad_header("does not begin with 'ply'");
        bool has_format = false;
        while (!rest_.empty()) {
            const std::vector<std::string_view> words = split(next_line());
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "end_header") {
                if (!has_format) return bad_header("names no format");
                return header;
            }
            if (words[0] == "format" && words.size() >= 2) {
                has_format = true;
                if (words[1] == "ascii") {
                    header.encoding = PlyEncoding::ascii;
                } else if (words[1] == "binary_little_endian") {
                    header.encoding = PlyEncoding::little;
                } else if (words[1] == "binary_big_endian") {
                    header.encoding = PlyEncoding::big;
                } else {
                    return bad_header(fmt::format("unknown format '{}'", words[1]));
                }
            } else if (words[0] == "element" && words.size() == 3) {
                PlyElement element{std::string(words[1]), 0, {}};
                const auto [end, error] =
                    std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
                if (error != std::errc() || end != words[2].data() + words[2].size()) {
                    return bad_header(fmt::format("'{}' is no count", words[2]));
                }
                header.elements.push_back(std::move(element));
            } else if (words[0] == "property" && !header.elements.empty() && (words.size() == 3 || words.size() == 5)) {
                const bool is_list = words.size() == 5;
                const auto type = find_type(words[is_list ? 3 : 1]);
                const auto count_type = is_list ? find_type(words[2]) : std::nullopt;
                if (!type || (is_list && (words[1] != "list" || !count_type)))
                    return bad_header("unknown property type");
                header.elements.back().properties.push_back({std::string(words.back()), *type, count_type});
            } else {
                return bad_header(fmt::format("'{}' is not understood", words[0].substr(0, 32)));
            }
        }
        return bad_header("the header has no end");
    }

private:
    std::string_view next_line() {
        const std::size_t end = std::min(rest_.find('\n'), rest_.size());
        std::string_view line = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        ++line_;
        return line;
    }

    tl::unexpected<Problems> bad_header(std::string cause) const {
        return fail(name_, fmt::format("line {}", line_), std::move(cause));
    }

    std::string_view& rest_;
    std::size_t line_ = 0;
    const std::string& name_;
};

}  // namespace

Result<PlyHeader> read_ply_header(std::string_view& bytes, const std::string& name) {
    return HeaderParser(bytes, name).run();
}

}  // namespace rayuela
