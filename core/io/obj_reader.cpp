#include "core/io/obj_reader.h"

#include "core/io/file_bytes.h"
#include "core/io/mesh_builder.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <istream>
#include <optional>
#include <streambuf>

namespace rayuela {

namespace {

constexpr std::size_t kMaxProblems = 10;

/// A set of characters to search for: the standard library's searches call a function for each character of the text.
class Letters {
public:
    explicit constexpr Letters(std::string_view letters) {
        for (const char c : letters) in_[static_cast<unsigned char>(c)] = true;
    }
    constexpr bool contains(char c) const { return in_[static_cast<unsigned char>(c)]; }
    /// How many characters `text` begins with that are in the set, or that are not.
    std::size_t run(std::string_view text) const { return run(text, true); }
    std::size_t run_of_others(std::string_view text) const { return run(text, false); }

private:
    std::size_t run(std::string_view text, bool wanted) const {
        std::size_t n = 0;
        while (n < text.size() && contains(text[n]) == wanted) ++n;
        return n;
    }
    std::array<bool, 256> in_{};
};

constexpr Letters kBlanks(" \t\r\n"), kDigits("0123456789"), kNumber("0123456789+-.eE"), kIndices("0123456789-/");

/// The text of a file as the parser gets it: without comments, continued lines joined.
class ObjText : public std::streambuf {
public:
    explicit ObjText(std::string text) : text_(std::move(text)) {
        for (std::size_t at = text_.find("\\\n"); at != std::string::npos; at = text_.find("\\\n", at)) {
            text_[at] = text_[at + 1] = ' ';
        }
        for (std::size_t at = text_.find('#'); at != std::string::npos; at = text_.find('#', at)) {
            const std::size_t end = std::min(text_.find('\n', at), text_.size());
            std::fill(text_.data() + at, text_.data() + text_.find_last_not_of('\r', end - 1) + 1, ' ');
        }
        setg(text_.data(), text_.data(), text_.data() + text_.size());
    }

    std::string_view text() const { return text_; }
    /// The last character that the parser has read: in a callback, of the line that it tells of.
    std::uint32_t place() const { return static_cast<std::uint32_t>(std::max(gptr() - 1, eback()) - eback()); }
    std::size_t line_of(std::uint32_t place) const {
        return static_cast<std::size_t>(std::count(text_.data(), text_.data() + place, '\n')) + 1;
    }

private:
    std::string text_;
};

struct LineProblem {
    std::size_t line;
    std::string cause;
};
using LineProblems = std::vector<LineProblem>;
using Cause = std::optional<std::string>;

Cause fault_in_words(std::string_view words, const Letters& letters, std::size_t min_count) {
    constexpr std::size_t kMaxLength = 64;
    std::size_t count = 0;
    for (;; ++count) {
        words.remove_prefix(kBlanks.run(words));
        if (words.empty()) break;
        const std::size_t length = letters.run(words);
        if (length == 0 || length > kMaxLength || (length < words.size() && !kBlanks.contains(words[length])))
            return fmt::format("'{}' is no number", words.substr(0, kBlanks.run_of_others(words)).substr(0, 32));
        words.remove_prefix(length);
    }
    if (count >= min_count) return {};
    return fmt::format("has {} numbers where {} are needed", count, min_count);
}

/// The parser's integers wrap round where they overflow.
Cause fault_in_indices(std::string_view words) {
    while (true) {
        words.remove_prefix(kDigits.run_of_others(words));
        if (words.empty()) return {};
        const std::size_t length = kDigits.run(words);
        if (length > 9)
            return fmt::format("the index {} is too large", words.substr(0, std::min<std::size_t>(length, 32)));
        words.remove_prefix(length);
    }
}

Cause fault_in_line(std::string_view line) {
    line.remove_prefix(kBlanks.run(line));
    const std::string_view keyword = line.substr(0, kBlanks.run_of_others(line));
    const std::string_view words = line.substr(keyword.size());
    if (keyword == "v" || keyword == "vn") return fault_in_words(words, kNumber, 3);
    if (keyword == "vt") return fault_in_words(words, kNumber, 1);
    if (keyword != "f") return {};
    Cause cause = fault_in_words(words, kIndices, 3);
    return cause ? cause : fault_in_indices(words);
}

/// What the parser would silently read as another number.
LineProblems find_faults(std::string_view text) {
    LineProblems problems;
    for (std::size_t line = 1; !text.empty() && problems.size() < kMaxProblems; ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
        if (Cause cause = fault_in_line(text.substr(0, end))) problems.push_back({line, *std::move(cause)});
        text.remove_prefix(end);
    }
    return problems;
}

struct Face {
    std::uint32_t place;  ///< In the text.
    std::uint32_t first_corner;
};

/// What the callbacks collect. Indices as in the file: from 1, 0 is absent; relative ones made absolute.
struct ObjData {
    std::vector<Vec3> positions, normals;
    std::vector<Vec2> uvs;
    std::vector<Face> faces;
    std::vector<int> corner_positions;
    std::vector<int> corner_normals, corner_uvs;  ///< Empty where no corner has one.
    std::vector<std::uint32_t> not_finite;        ///< Places of vertices.
};

int absolute(int index, std::size_t count) {
    return index < 0 ? static_cast<int>(static_cast<std::ptrdiff_t>(count) + index + 1) : index;
}

/// Of a normal or uv: one that reaches before the first must not become "absent".
int absolute_or_absent(int index, std::size_t count) {
    const int at = absolute(index, count);
    return index < 0 && at == 0 ? -1 : at;
}

void add_corner(std::vector<int>& of_corners, std::size_t corner, int index) {
    if (index == 0 && of_corners.empty()) return;
    of_corners.resize(corner + 1);
    of_corners.back() = index;
}

struct Reading {
    ObjText text;
    ObjData data;
};

void add_face(void* user, tinyobj::index_t* indices, int count) {
    auto& [text, data] = *static_cast<Reading*>(user);
    data.faces.push_back({text.place(), static_cast<std::uint32_t>(data.corner_positions.size())});
    for (const tinyobj::index_t& index : std::span(indices, static_cast<std::size_t>(count))) {
        const std::size_t corner = data.corner_positions.size();
        data.corner_positions.push_back(absolute(index.vertex_index, data.positions.size()));
        add_corner(data.corner_normals, corner, absolute_or_absent(index.normal_index, data.normals.size()));
        add_corner(data.corner_uvs, corner, absolute_or_absent(index.texcoord_index, data.uvs.size()));
    }
}

Cause parse(Reading& reading) {
    // Memory that stays untouched costs nothing, growing costs copies: no vertex and no triangle is shorter.
    ObjData& all = reading.data;
    const std::size_t most = reading.text.text().size() / std::string_view("v 0 0 0\n").size();
    all.positions.reserve(most);
    all.normals.reserve(most);
    all.uvs.reserve(most);
    all.faces.reserve(most);
    for (auto* of_corners : {&all.corner_positions, &all.corner_normals, &all.corner_uvs})
        of_corners->reserve(3 * most);

    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* user, float x, float y, float z, float) {
        auto& [text, data] = *static_cast<Reading*>(user);
        data.positions.emplace_back(x, y, z);
        if (!is_finite(data.positions.back()) && data.not_finite.size() < kMaxProblems)
            data.not_finite.push_back(text.place());
    };
    callback.normal_cb = [](void* user, float x, float y, float z) {
        static_cast<Reading*>(user)->data.normals.emplace_back(x, y, z);
    };
    callback.texcoord_cb = [](void* user, float x, float y, float) {
        static_cast<Reading*>(user)->data.uvs.emplace_back(x, y);
    };
    callback.index_cb = add_face;
    callback.usemtl_cb = [](void*, const char*, int) {};
    std::istream stream(&reading.text);
    std::string warning, error;
    if (tinyobj::LoadObjWithCallback(stream, callback, &reading, nullptr, &warning, &error)) return {};
    return error;
}

bool exists(int index, std::size_t count) {
    return index >= 1 && static_cast<std::size_t>(index) <= count;
}

Cause fault_in_corner(const ObjData& data, std::size_t corner) {
    const auto missing = [](std::string_view what, int index, std::size_t count) {
        return fmt::format("{} {} does not exist, there are {}", what, index, count);
    };
    const auto index_in = [&](const std::vector<int>& of_corners) {
        return of_corners.empty() ? 0 : of_corners[corner];
    };
    const int position = data.corner_positions[corner];
    const int normal = index_in(data.corner_normals), uv = index_in(data.corner_uvs);
    if (!exists(position, data.positions.size())) return missing("vertex", position, data.positions.size());
    if (normal != 0 && !exists(normal, data.normals.size())) return missing("normal", normal, data.normals.size());
    if (uv != 0 && !exists(uv, data.uvs.size())) return missing("texture coordinate", uv, data.uvs.size());
    return {};
}

std::size_t end_of_face(const ObjData& data, std::size_t face) {
    return face + 1 < data.faces.size() ? data.faces[face + 1].first_corner : data.corner_positions.size();
}

LineProblems find_missing(const Reading& reading) {
    const ObjData& data = reading.data;
    LineProblems problems;
    for (std::size_t face = 0; face < data.faces.size() && problems.size() < kMaxProblems; ++face) {
        const std::size_t end = end_of_face(data, face);
        for (std::size_t corner = data.faces[face].first_corner; corner < end; ++corner) {
            Cause cause = fault_in_corner(data, corner);
            if (!cause) continue;
            problems.push_back({reading.text.line_of(data.faces[face].place), *std::move(cause)});
            break;
        }
    }
    return problems;
}

/// One vertex for each tuple of position, uv and normal. The tuples of one position form a chain.
class VertexTable {
public:
    explicit VertexTable(const ObjData& data) : data_(data), first_(data.positions.size(), kNone) {
        mesh.positions.reserve(data.positions.size());
        if (has_normals_) mesh.normals.reserve(data.positions.size());
        if (has_uvs_) mesh.uvs.reserve(data.positions.size());
        if (!is_plain_) tuples_.reserve(data.positions.size());
        mesh.triangles.reserve(data.faces.size());
    }

    std::uint32_t vertex(std::size_t corner) {
        std::uint32_t* link = &first_[static_cast<std::size_t>(data_.corner_positions[corner] - 1)];
        if (is_plain_) {
            if (*link == kNone) *link = add_position(corner);
            return *link;
        }
        const int normal = has_normals_ ? data_.corner_normals[corner] : 0;
        const int uv = has_uvs_ ? data_.corner_uvs[corner] : 0;
        while (*link != kNone) {
            const Tuple& tuple = tuples_[*link];
            if (tuple.normal == normal && tuple.uv == uv) return *link;
            link = &tuples_[*link].next;
        }
        const std::uint32_t vertex = *link = add_position(corner);
        tuples_.push_back({normal, uv, kNone});
        if (has_normals_)
            mesh.normals.push_back(normal ? data_.normals[static_cast<std::size_t>(normal - 1)] : Vec3(0));
        if (has_uvs_) mesh.uvs.push_back(uv ? data_.uvs[static_cast<std::size_t>(uv - 1)] : Vec2(0));
        return vertex;
    }

    TriangleMesh mesh;

private:
    struct Tuple {
        int normal, uv;
        std::uint32_t next;
    };
    std::uint32_t add_position(std::size_t corner) {
        mesh.positions.push_back(data_.positions[static_cast<std::size_t>(data_.corner_positions[corner] - 1)]);
        return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }

    const ObjData& data_;
    const bool has_normals_ = !data_.corner_normals.empty(), has_uvs_ = !data_.corner_uvs.empty();
    const bool is_plain_ = !has_normals_ && !has_uvs_;
    std::vector<std::uint32_t> first_;
    std::vector<Tuple> tuples_;
};

TriangleMesh build(const ObjData& data) {
    VertexTable table(data);
    std::vector<std::uint32_t> polygon;
    std::vector<glm::uvec3> cut;
    for (std::size_t face = 0; face < data.faces.size(); ++face) {
        polygon.clear();
        const std::size_t end = end_of_face(data, face);
        for (std::size_t c = data.faces[face].first_corner; c < end; ++c) polygon.push_back(table.vertex(c));
        cut.clear();
        triangulate(polygon, table.mesh.positions, cut);
        for (const glm::uvec3& t : cut) table.mesh.triangles.emplace_back(polygon[t.x], polygon[t.y], polygon[t.z]);
    }
    return std::move(table.mesh);
}

/// The data of a text without faults.
Result<ObjData> read(std::string text, const std::string& name) {
    Reading reading{ObjText(std::move(text)), {}};
    LineProblems problems = find_faults(reading.text.text());
    if (Cause cause = parse(reading))
        problems.push_back({reading.text.line_of(reading.text.place()), *std::move(cause)});
    for (const std::uint32_t place : reading.data.not_finite)
        problems.push_back({reading.text.line_of(place), "the vertex is not finite"});
    if (problems.empty()) problems = find_missing(reading);
    if (problems.empty()) return std::move(reading.data);
    std::ranges::stable_sort(problems, {}, &LineProblem::line);
    problems.resize(std::min(problems.size(), kMaxProblems));
    Problems named;
    for (LineProblem& problem : problems)
        named.push_back({name, fmt::format("line {}", problem.line), std::move(problem.cause)});
    return tl::unexpected(std::move(named));
}

}  // namespace

MeshResult parse_obj(std::string text, const std::string& name, Problems* warnings) {
    const Result<ObjData> data = read(std::move(text), name);
    if (!data) return tl::unexpected(data.error());
    return finish_mesh(build(*data), name, warnings);
}

MeshResult read_obj(const std::filesystem::path& path, Problems* warnings) {
    Result<std::string> text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    return parse_obj(std::move(*text), path.string(), warnings);
}

}  // namespace rayuela
