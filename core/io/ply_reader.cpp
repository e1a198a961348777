#include "core/io/ply_reader.h"

#include "core/io/file_bytes.h"
#include "core/io/mesh_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <span>

namespace rayuela {

namespace {

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class Encoding : std::uint8_t { ascii, little, big };

struct TypeName {
    std::string_view name;
    Type type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", Type::i8},
                                               {"int8", Type::i8},
                                               {"uchar", Type::u8},
                                               {"uint8", Type::u8},
                                               {"short", Type::i16},
                                               {"int16", Type::i16},
                                               {"ushort", Type::u16},
                                               {"uint16", Type::u16},
                                               {"int", Type::i32},
                                               {"int32", Type::i32},
                                               {"uint", Type::u32},
                                               {"uint32", Type::u32},
                                               {"float", Type::f32},
                                               {"float32", Type::f32},
                                               {"double", Type::f64},
                                               {"float64", Type::f64}}};

struct Property {
    std::string name;
    Type type;
    std::optional<Type> count_type;  ///< Of a list.
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
};

/// Reads numbers one after another from the body; every number of a PLY file fits a double exactly.
class Body {
public:
    Body(std::string_view bytes, Encoding encoding) : bytes_(bytes), encoding_(encoding) {}

    std::size_t left() const { return bytes_.size(); }

    bool read(Type type, double& value) {
        if (encoding_ == Encoding::ascii) return read_word(value);
        switch (type) {
            case Type::i8:
                return read_binary<std::int8_t>(value);
            case Type::u8:
                return read_binary<std::uint8_t>(value);
            case Type::i16:
                return read_binary<std::int16_t>(value);
            case Type::u16:
                return read_binary<std::uint16_t>(value);
            case Type::i32:
                return read_binary<std::int32_t>(value);
            case Type::u32:
                return read_binary<std::uint32_t>(value);
            case Type::f32:
                return read_binary<float>(value);
            case Type::f64:
                return read_binary<double>(value);
        }
        return false;
    }

private:
    template <typename T>
    bool read_binary(double& value) {
        if (bytes_.size() < sizeof(T)) return false;
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes_.data(), sizeof(T));
        bytes_.remove_prefix(sizeof(T));
        if ((encoding_ == Encoding::little) != (std::endian::native == std::endian::little)) std::ranges::reverse(raw);
        value = static_cast<double>(std::bit_cast<T>(raw));
        return true;
    }

    bool read_word(double& value) {
        const auto is_blank = [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
        const auto first = std::ranges::find_if_not(bytes_, is_blank);
        const auto last = std::find_if(first, bytes_.end(), is_blank);
        std::string_view word(first, last);
        bytes_.remove_prefix(static_cast<std::size_t>(last - bytes_.begin()));
        if (word.starts_with('+')) word.remove_prefix(1);
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        return error == std::errc() && end == word.data() + word.size();
    }

    std::string_view bytes_;
    Encoding encoding_;
};

class Parser {
public:
    Parser(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

    MeshResult run(Problems* warnings) {
        const Result<Header> header = read_header();
        if (!header) return tl::unexpected(header.error());
        Body body(rest_, header->encoding);
        for (const Element& element : header->elements) {
            if (element.properties.empty()) continue;
            Result<void> done = element.name == "vertex" ? read_vertices(element, body)
                                : element.name == "face" ? read_faces(element, body)
                                                         : skip(element, body);
            if (!done) return tl::unexpected(done.error());
        }
        if (Result<void> done = build_triangles(); !done) return tl::unexpected(done.error());
        return finish_mesh(std::move(mesh_), name_, warnings);
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

    Result<Header> read_header();
    Result<void> read_vertices(const Element& element, Body& body);
    Result<void> read_faces(const Element& element, Body& body);
    Result<void> skip(const Element& element, Body& body);
    Result<void> build_triangles();
    template <typename Visit>
    Result<void> read_elements(const Element& element, Body& body, const Visit& visit);

    std::string_view rest_;
    std::size_t line_ = 0;
    const std::string& name_;
    TriangleMesh mesh_;
    std::vector<std::uint32_t> corners_;  ///< Of all faces.
    std::vector<std::size_t> face_ends_;  ///< Where each face's corners end.
};

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (line.empty()) return words;
        words.push_back(line.substr(0, line.find_first_of(" \t")));
        line.remove_prefix(words.back().size());
    }
}

std::optional<Type> find_type(std::string_view name) {
    const auto found = std::ranges::find(kTypeNames, name, &TypeName::name);
    return found == kTypeNames.end() ? std::nullopt : std::optional(found->type);
}

Result<Header> Parser::read_header() {
    Header header;
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
                header.encoding = Encoding::ascii;
            } else if (words[1] == "binary_little_endian") {
                header.encoding = Encoding::little;
            } else if (words[1] == "binary_big_endian") {
                header.encoding = Encoding::big;
            } else {
                return bad_header(fmt::format("unknown format '{}'", words[1]));
            }
        } else if (words[0] == "element" && words.size() == 3) {
            Element element{std::string(words[1]), 0, {}};
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
            if (!type || (is_list && (words[1] != "list" || !count_type))) return bad_header("unknown property type");
            header.elements.back().properties.push_back({std::string(words.back()), *type, count_type});
        } else {
            return bad_header(fmt::format("'{}' is not understood", words[0].substr(0, 32)));
        }
    }
    return bad_header("the header has no end");
}

/// Calls visit(element index, property index, items) for each property of each element, in the file's order.
template <typename Visit>
Result<void> Parser::read_elements(const Element& element, Body& body, const Visit& visit) {
    std::vector<double> items;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        const auto place = [&] { return fmt::format("{} {}", element.name, i); };
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const Property& property = element.properties[p];
            double count = 1;
            if (property.count_type && !body.read(*property.count_type, count))
                return fail(name_, place(), "is cut off");
            if (!(count >= 0) || count > static_cast<double>(body.left())) {
                return fail(name_, place(), fmt::format("a list of {} items does not fit the file", count));
            }
            items.resize(static_cast<std::size_t>(count));
            for (double& item : items) {
                if (body.read(property.type, item)) continue;
                return fail(name_, place(),
                            body.left() == 0 ? "is cut off" : fmt::format("{} is no number", property.name));
            }
            if (auto cause = visit(p, items)) return fail(name_, place(), *cause);
        }
    }
    return {};
}

using Cause = std::optional<std::string>;

Result<void> Parser::skip(const Element& element, Body& body) {
    return read_elements(element, body, [](std::size_t, const std::vector<double>&) { return Cause{}; });
}

Result<void> Parser::read_vertices(const Element& element, Body& body) {
    // Where each property goes: x, y, z, nx, ny, nz, u, v.
    constexpr std::array<std::array<std::string_view, 3>, 8> kNames{
        {{"x"}, {"y"}, {"z"}, {"nx"}, {"ny"}, {"nz"}, {"u", "s", "texture_u"}, {"v", "t", "texture_v"}}};
    std::vector<std::size_t> slots(element.properties.size(), kNames.size());
    std::array<bool, kNames.size()> present{};
    for (std::size_t p = 0; p < slots.size(); ++p) {
        if (element.properties[p].count_type) continue;
        for (std::size_t slot = 0; slot < kNames.size(); ++slot) {
            if (std::ranges::find(kNames[slot], element.properties[p].name) == kNames[slot].end()) continue;
            slots[p] = slot;
            present[slot] = true;
        }
    }
    if (!present[0] || !present[1] || !present[2]) return fail(name_, "vertex", "has no property x, y or z");
    const bool has_normals = present[3] && present[4] && present[5], has_uvs = present[6] && present[7];

    std::array<float, kNames.size() + 1> values{};
    const std::size_t last = slots.size() - 1;
    return read_elements(element, body, [&](std::size_t p, const std::vector<double>& items) -> Cause {
        if (!items.empty()) values[slots[p]] = static_cast<float>(items[0]);
        if (p != last) return {};
        if (!is_finite({values[0], values[1], values[2]})) return "is not finite";
        mesh_.positions.emplace_back(values[0], values[1], values[2]);
        if (has_normals) mesh_.normals.emplace_back(values[3], values[4], values[5]);
        if (has_uvs) mesh_.uvs.emplace_back(values[6], values[7]);
        return {};
    });
}

Result<void> Parser::read_faces(const Element& element, Body& body) {
    return read_elements(element, body, [&](std::size_t p, const std::vector<double>& items) -> Cause {
        const Property& property = element.properties[p];
        if (!property.count_type || (property.name != "vertex_indices" && property.name != "vertex_index")) return {};
        if (items.size() < 3) return fmt::format("has {} vertices, needs 3", items.size());
        for (const double index : items) {
            if (!(index >= 0) || index >= 4294967295.0) return fmt::format("vertex {} does not exist", index);
            corners_.push_back(static_cast<std::uint32_t>(index));
        }
        face_ends_.push_back(corners_.size());
        return {};
    });
}

Result<void> Parser::build_triangles() {
    std::vector<glm::uvec3> cut;
    mesh_.triangles.reserve(face_ends_.size());
    std::size_t first = 0;
    for (std::size_t face = 0; face < face_ends_.size(); ++face) {
        const std::span corners(corners_.data() + first, face_ends_[face] - first);
        first = face_ends_[face];
        for (const std::uint32_t corner : corners) {
            if (corner < mesh_.positions.size()) continue;
            return fail(name_, fmt::format("face {}", face),
                        fmt::format("vertex {} does not exist, there are {}", corner, mesh_.positions.size()));
        }
        cut.clear();
        triangulate(corners, mesh_.positions, cut);
        for (const glm::uvec3& t : cut) mesh_.triangles.emplace_back(corners[t.x], corners[t.y], corners[t.z]);
    }
    return {};
}

}  // namespace

MeshResult parse_ply(std::string_view bytes, const std::string& name, Problems* warnings) {
    return Parser(bytes, name).run(warnings);
}

MeshResult read_ply(const std::filesystem::path& path, Problems* warnings) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_ply(*bytes, path.string(), warnings);
}

}  // namespace rayuela
