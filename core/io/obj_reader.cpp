#include "core/io/obj_reader.h"

#include "core/io/file_bytes.h"
#include "core/io/mesh_builder.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <istream>
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

/// Hands out a text line by line, so that a callback of the parser can tell its line, and refuses what the parser would
/// silently read as 0.
class ObjLines : public std::streambuf {
public:
    ObjLines(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {
        for (std::size_t at = text_.find("\\\n"); at != std::string::npos; at = text_.find("\\\n", at)) {
            text_[at] = text_[at + 1] = ' ';
        }
    }

    std::size_t line() const { return line_; }

    void problem(std::size_t line, std::string cause) {
        if (problems.size() < kMaxProblems) problems.push_back({name_, fmt::format("line {}", line), std::move(cause)});
    }

    Problems problems;

protected:
    int_type underflow() override {
        if (next_ >= text_.size()) return traits_type::eof();
        const std::size_t end = std::min(text_.find('\n', next_), text_.size() - 1) + 1;
        char* const first = text_.data() + next_;
        setg(first, first, text_.data() + end);
        const std::string_view line(first, end - next_);
        if (const std::size_t comment = line.find('#'); comment != std::string_view::npos) {
            const std::size_t comment_end = line.find_last_not_of("\r\n") + 1;
            std::fill(first + comment, first + comment_end, ' ');
        }
        next_ = end;
        ++line_;
        check(line);
        return traits_type::to_int_type(*gptr());
    }

private:
    void check(std::string_view line) {
        line.remove_prefix(kBlanks.run(line));
        const std::string_view keyword = line.substr(0, kBlanks.run_of_others(line));
        line.remove_prefix(keyword.size());
        if (keyword == "v" || keyword == "vn") check_words(line, kNumber, 3, 64);
        if (keyword == "vt") check_words(line, kNumber, 1, 64);
        if (keyword == "f" && check_words(line, kIndices, 3, 64)) check_indices(line);
    }

    /// The parser's integers wrap round where they overflow.
    void check_indices(std::string_view line) {
        while (true) {
            line.remove_prefix(kDigits.run_of_others(line));
            if (line.empty()) return;
            const std::size_t length = kDigits.run(line);
            if (length > 9)
                return problem(
                    line_, fmt::format("the index {} is too large", line.substr(0, std::min<std::size_t>(length, 32))));
            line.remove_prefix(length);
        }
    }

    bool check_words(std::string_view line, const Letters& letters, std::size_t min_count, std::size_t max_length) {
        std::size_t count = 0;
        for (;; ++count) {
            line.remove_prefix(kBlanks.run(line));
            if (line.empty()) break;
            const std::string_view word = line.substr(0, kBlanks.run_of_others(line));
            if (word.size() > max_length || letters.run(word) < word.size()) {
                problem(line_, fmt::format("'{}' is no number", word.substr(0, 32)));
                return false;
            }
            line.remove_prefix(word.size());
        }
        if (count >= min_count) return true;
        problem(line_, fmt::format("has {} numbers where {} are needed", count, min_count));
        return false;
    }

    std::string text_, name_;
    std::size_t next_ = 0, line_ = 0;
};

struct Face {
    std::size_t line, first_corner;
};

/// What the callbacks collect.
struct ObjData {
    ObjLines& lines;
    std::vector<Vec3> positions, normals;
    std::vector<Vec2> uvs;
    std::vector<tinyobj::index_t> corners;  ///< As in the file: from 1, 0 is absent; relative ones made absolute.
    std::vector<Face> faces;
};

int absolute(int index, std::size_t count) {
    return index < 0 ? static_cast<int>(static_cast<std::ptrdiff_t>(count) + index + 1) : index;
}

void add_face(void* user, tinyobj::index_t* indices, int count) {
    auto& data = *static_cast<ObjData*>(user);
    data.faces.push_back({data.lines.line(), data.corners.size()});
    for (const tinyobj::index_t& index : std::span(indices, static_cast<std::size_t>(count))) {
        tinyobj::index_t& corner = data.corners.emplace_back();
        corner.vertex_index = absolute(index.vertex_index, data.positions.size());
        corner.normal_index = absolute(index.normal_index, data.normals.size());
        corner.texcoord_index = absolute(index.texcoord_index, data.uvs.size());
        // A relative index that reaches before the first must not become "absent".
        if (index.normal_index < 0 && corner.normal_index == 0) corner.normal_index = -1;
        if (index.texcoord_index < 0 && corner.texcoord_index == 0) corner.texcoord_index = -1;
    }
}

bool parse(ObjLines& lines, ObjData& data) {
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* user, float x, float y, float z, float) {
        auto& d = *static_cast<ObjData*>(user);
        d.positions.emplace_back(x, y, z);
        if (!is_finite(d.positions.back())) d.lines.problem(d.lines.line(), "the vertex is not finite");
    };
    callback.normal_cb = [](void* user, float x, float y, float z) {
        static_cast<ObjData*>(user)->normals.emplace_back(x, y, z);
    };
    callback.texcoord_cb = [](void* user, float x, float y, float) {
        static_cast<ObjData*>(user)->uvs.emplace_back(x, y);
    };
    callback.index_cb = add_face;
    callback.usemtl_cb = [](void*, const char*, int) {};
    std::istream stream(&lines);
    std::string warning, error;
    if (tinyobj::LoadObjWithCallback(stream, callback, &data, nullptr, &warning, &error)) return true;
    lines.problem(lines.line(), error);
    return false;
}

/// One vertex for each tuple of position, uv and normal. The tuples of one position form a chain.
class VertexTable {
public:
    explicit VertexTable(const ObjData& data) : data_(data), first_(data.positions.size(), kNone) {}

    std::uint32_t vertex(const tinyobj::index_t& corner) {
        std::uint32_t* link = &first_[static_cast<std::size_t>(corner.vertex_index - 1)];
        while (*link != kNone) {
            const Tuple& tuple = tuples_[*link];
            if (tuple.normal == corner.normal_index && tuple.uv == corner.texcoord_index) return *link;
            link = &tuples_[*link].next;
        }
        *link = static_cast<std::uint32_t>(tuples_.size());
        tuples_.push_back({corner.normal_index, corner.texcoord_index, kNone});
        mesh.positions.push_back(data_.positions[static_cast<std::size_t>(corner.vertex_index - 1)]);
        if (!data_.normals.empty()) {
            mesh.normals.push_back(
                corner.normal_index ? data_.normals[static_cast<std::size_t>(corner.normal_index - 1)] : Vec3(0));
            has_normals |= corner.normal_index != 0;
        }
        if (!data_.uvs.empty()) {
            mesh.uvs.push_back(corner.texcoord_index ? data_.uvs[static_cast<std::size_t>(corner.texcoord_index - 1)]
                                                     : Vec2(0));
            has_uvs |= corner.texcoord_index != 0;
        }
        return static_cast<std::uint32_t>(tuples_.size() - 1);
    }

    TriangleMesh mesh;
    bool has_normals = false, has_uvs = false;

private:
    struct Tuple {
        int normal, uv;
        std::uint32_t next;
    };
    const ObjData& data_;
    std::vector<std::uint32_t> first_;
    std::vector<Tuple> tuples_;
};

bool in_range(const ObjData& data, const Face& face, std::span<const tinyobj::index_t> corners) {
    const auto check = [&](const char* what, int index, std::size_t count, bool optional) {
        if ((optional && index == 0) || (index >= 1 && static_cast<std::size_t>(index) <= count)) return true;
        data.lines.problem(face.line, fmt::format("{} {} does not exist, there are {}", what, index, count));
        return false;
    };
    return std::ranges::all_of(corners, [&](const tinyobj::index_t& corner) {
        return check("vertex", corner.vertex_index, data.positions.size(), false) &&
               check("normal", corner.normal_index, data.normals.size(), true) &&
               check("texture coordinate", corner.texcoord_index, data.uvs.size(), true);
    });
}

TriangleMesh build(const ObjData& data) {
    VertexTable table(data);
    std::vector<std::uint32_t> polygon;
    std::vector<glm::uvec3> cut;
    for (std::size_t i = 0; i < data.faces.size(); ++i) {
        const std::size_t first = data.faces[i].first_corner;
        const std::size_t last = i + 1 < data.faces.size() ? data.faces[i + 1].first_corner : data.corners.size();
        const std::span corners(data.corners.data() + first, last - first);
        if (!in_range(data, data.faces[i], corners)) continue;
        polygon.clear();
        for (const tinyobj::index_t& corner : corners) polygon.push_back(table.vertex(corner));
        cut.clear();
        triangulate(polygon, table.mesh.positions, cut);
        for (const glm::uvec3& t : cut) table.mesh.triangles.emplace_back(polygon[t.x], polygon[t.y], polygon[t.z]);
    }
    if (!table.has_normals) table.mesh.normals.clear();
    if (!table.has_uvs) table.mesh.uvs.clear();
    return std::move(table.mesh);
}

}  // namespace

MeshResult parse_obj(std::string_view text, const std::string& name, Problems* warnings) {
    ObjLines lines(std::string(text), name);
    ObjData data{lines, {}, {}, {}, {}, {}};
    if (!parse(lines, data) || !lines.problems.empty()) return tl::unexpected(std::move(lines.problems));
    TriangleMesh mesh = build(data);
    if (!lines.problems.empty()) return tl::unexpected(std::move(lines.problems));
    return finish_mesh(std::move(mesh), name, warnings);
}

MeshResult read_obj(const std::filesystem::path& path, Problems* warnings) {
    const Result<std::string> text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    return parse_obj(*text, path.string(), warnings);
}

}  // namespace rayuela
