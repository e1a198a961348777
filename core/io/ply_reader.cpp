#include "core/io/ply_reader.h"

#include "core/io/file_bytes.h"
#include "core/io/mesh_builder.h"
#include "core/io/ply_header.h"

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

/// Reads numbers one after another from the body; every number of a PLY file fits a double exactly.
class Body {
public:
    Body(std::string_view bytes, PlyEncoding encoding) : bytes_(bytes), encoding_(encoding) {}

    std::size_t left() const { return bytes_.size(); }
    /// The next `count` records of `size` bytes as they stand, numbers in the machine's order, and goes on behind them where
    /// `take` does; nothing where they are not there in this form.
    template <typename Take>
    bool take_records(std::uint64_t count, std::size_t size, const Take& take) {
        constexpr PlyEncoding kNative =
            std::endian::native == std::endian::little ? PlyEncoding::little : PlyEncoding::big;
        if (encoding_ != kNative || count > bytes_.size() / size || !take(bytes_.data())) return false;
        bytes_.remove_prefix(count * size);
        return true;
    }

    bool read(PlyType type, double& value) {
        if (encoding_ == PlyEncoding::ascii) return read_word(value);
        switch (type) {
            case PlyType::i8:
                return read_binary<std::int8_t>(value);
            case PlyType::u8:
                return read_binary<std::uint8_t>(value);
            case PlyType::i16:
                return read_binary<std::int16_t>(value);
            case PlyType::u16:
                return read_binary<std::uint16_t>(value);
            case PlyType::i32:
                return read_binary<std::int32_t>(value);
            case PlyType::u32:
                return read_binary<std::uint32_t>(value);
            case PlyType::f32:
                return read_binary<float>(value);
            case PlyType::f64:
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
        if ((encoding_ == PlyEncoding::little) != (std::endian::native == std::endian::little))
            std::ranges::reverse(raw);
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
    PlyEncoding encoding_;
};

/// Where each property of a vertex goes: x, y, z, nx, ny, nz, u, v, or nowhere.
class VertexSlots {
public:
    static constexpr std::size_t kCount = 8;

    explicit VertexSlots(const PlyElement& element) : of_property_(element.properties.size(), kCount) {
        constexpr std::array<std::array<std::string_view, 3>, kCount> kNames{
            {{"x"}, {"y"}, {"z"}, {"nx"}, {"ny"}, {"nz"}, {"u", "s", "texture_u"}, {"v", "t", "texture_v"}}};
        for (std::size_t p = 0; p < of_property_.size(); ++p) {
            if (element.properties[p].count_type) continue;
            for (std::size_t slot = 0; slot < kCount; ++slot) {
                if (std::ranges::find(kNames[slot], element.properties[p].name) == kNames[slot].end()) continue;
                of_property_[p] = slot;
                present_[slot] = true;
            }
        }
    }

    /// kCount for a property that goes nowhere.
    std::size_t operator[](std::size_t property) const { return of_property_[property]; }
    bool positions() const { return present_[0] && present_[1] && present_[2]; }
    bool normals() const { return present_[3] && present_[4] && present_[5]; }
    bool uvs() const { return present_[6] && present_[7]; }

private:
    std::vector<std::size_t> of_property_;
    std::array<bool, kCount> present_{};
};

class Parser {
public:
    Parser(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

    MeshResult run(Problems* warnings) {
        const Result<PlyHeader> header = read_ply_header(rest_, name_);
        if (!header) return tl::unexpected(header.error());
        Body body(rest_, header->encoding);
        for (const PlyElement& element : header->elements) {
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
    Result<void> read_vertices(const PlyElement& element, Body& body);
    Result<void> read_faces(const PlyElement& element, Body& body);
    bool take_plain_vertices(const PlyElement& element, const VertexSlots& slots, Body& body);
    bool take_plain_faces(const PlyElement& element, Body& body);
    Result<void> skip(const PlyElement& element, Body& body);
    Result<void> build_triangles();
    template <typename Visit>
    Result<void> read_elements(const PlyElement& element, Body& body, const Visit& visit);

    std::string_view rest_;
    const std::string& name_;
    TriangleMesh mesh_;
    std::vector<std::uint32_t> corners_;  ///< Of all faces.
    std::vector<std::size_t> face_ends_;  ///< Where each face's corners end.
};

/// Calls visit(element index, property index, items) for each property of each element, in the file's order.
template <typename Visit>
Result<void> Parser::read_elements(const PlyElement& element, Body& body, const Visit& visit) {
    std::vector<double> items;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        const auto place = [&] { return fmt::format("{} {}", element.name, i); };
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
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

Result<void> Parser::skip(const PlyElement& element, Body& body) {
    return read_elements(element, body, [](std::size_t, const std::vector<double>&) { return Cause{}; });
}

/// Vertices of floats, as nearly all binary files have them. False, and nothing is taken, where there is anything else.
bool Parser::take_plain_vertices(const PlyElement& element, const VertexSlots& slots, Body& body) {
    std::array<std::size_t, VertexSlots::kCount> offset{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (property.count_type || property.type != PlyType::f32) return false;
        if (slots[p] < VertexSlots::kCount) offset[slots[p]] = p * sizeof(float);
    }
    const std::size_t size = element.properties.size() * sizeof(float);
    return body.take_records(element.count, size, [&](const char* records) {
        const auto values = [&](auto& of_vertices, std::size_t first_slot, bool present) {
            using Value = typename std::decay_t<decltype(of_vertices)>::value_type;
            if (!present) return;
            of_vertices.resize(element.count);
            for (std::size_t i = 0; i < element.count; ++i) {
                for (int k = 0; k < Value::length(); ++k) {
                    const char* const at = records + i * size + offset[first_slot + static_cast<std::size_t>(k)];
                    std::memcpy(&of_vertices[i][k], at, sizeof(float));
                }
            }
        };
        values(mesh_.positions, 0, true);
        if (!std::ranges::all_of(mesh_.positions, [](const Vec3& p) { return is_finite(p); })) {
            mesh_.positions.clear();
            return false;
        }
        values(mesh_.normals, 3, slots.normals());
        values(mesh_.uvs, 6, slots.uvs());
        return true;
    });
}

Result<void> Parser::read_vertices(const PlyElement& element, Body& body) {
    const VertexSlots slots(element);
    if (!slots.positions()) return fail(name_, "vertex", "has no property x, y or z");
    if (mesh_.positions.empty() && take_plain_vertices(element, slots, body)) return {};

    std::array<float, VertexSlots::kCount + 1> values{};
    const std::size_t last = element.properties.size() - 1;
    return read_elements(element, body, [&](std::size_t p, const std::vector<double>& items) -> Cause {
        if (!items.empty()) values[slots[p]] = static_cast<float>(items[0]);
        if (p != last) return {};
        if (!is_finite({values[0], values[1], values[2]})) return "is not finite";
        mesh_.positions.emplace_back(values[0], values[1], values[2]);
        if (slots.normals()) mesh_.normals.emplace_back(values[3], values[4], values[5]);
        if (slots.uvs()) mesh_.uvs.emplace_back(values[6], values[7]);
        return {};
    });
}

/// Triangles of 32-bit indices over vertices that are there, with nothing beside them, as nearly all binary files have them.
/// False, and nothing is taken, where there is anything else.
bool Parser::take_plain_faces(const PlyElement& element, Body& body) {
    constexpr std::size_t kSize = 1 + sizeof(glm::uvec3);
    const PlyProperty& indices = element.properties[0];
    if (element.properties.size() > 1 || indices.count_type != PlyType::u8) return false;
    if (indices.type != PlyType::i32 && indices.type != PlyType::u32) return false;
    if (indices.name != "vertex_indices" && indices.name != "vertex_index") return false;
    return body.take_records(element.count, kSize, [&](const char* records) {
        mesh_.triangles.resize(element.count);
        for (std::size_t i = 0; i < element.count; ++i) {
            glm::uvec3& t = mesh_.triangles[i];
            std::memcpy(&t, records + i * kSize + 1, sizeof(t));
            if (records[i * kSize] == 3 && std::max({t.x, t.y, t.z}) < mesh_.positions.size()) continue;
            mesh_.triangles.clear();
            return false;
        }
        return true;
    });
}

Result<void> Parser::read_faces(const PlyElement& element, Body& body) {
    if (face_ends_.empty() && mesh_.triangles.empty() && take_plain_faces(element, body)) return {};
    return read_elements(element, body, [&](std::size_t p, const std::vector<double>& items) -> Cause {
        const PlyProperty& property = element.properties[p];
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
    mesh_.triangles.reserve(mesh_.triangles.size() + face_ends_.size());
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
