#include "core/io/image_io.h"
#include "core/io/obj_reader.h"
#include "core/io/ply_reader.h"
#include "tests/stress/stress.h"
#include "tests/support/show_scene.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace rayuela::stress {
namespace {

using test::Random;
using testing::can_be_shown;

bool has_causes(const Problems& problems) {
    return !problems.empty() && std::ranges::none_of(problems, [](const Problem& p) { return p.cause.empty(); });
}

/// Whether the bytes are refused with a cause or can be shown.
using Reader = bool (*)(const std::string& bytes);

bool read_as_obj(const std::string& bytes) {
    const auto mesh = parse_obj(bytes, "stress.obj");
    return mesh ? can_be_shown(*mesh) : has_causes(mesh.error());
}
bool read_as_ply(const std::string& bytes) {
    const auto mesh = parse_ply(bytes, "stress.ply");
    return mesh ? can_be_shown(*mesh) : has_causes(mesh.error());
}
bool read_as_gltf(const std::string& bytes) {
    const auto file = parse_gltf(std::as_bytes(std::span(bytes)), "/nowhere/stress.glb");
    return file ? can_be_shown(**file) : has_causes(file.error());
}
bool read_as_scene(const std::string& bytes) {
    const auto loaded = scene_from_json(bytes, "/nowhere", "stress.scene.json");
    return loaded ? can_be_shown(loaded->scene) : has_causes(loaded.error());
}
bool read_as_image(const std::string& bytes) {
    const auto image = decode_image(std::as_bytes(std::span(bytes)), "stress", ColorDecoding::srgb);
    // Opened without being decoded it is the same image in the end, and what it lacks is known at once, but for a file
    // that looks whole.
    const auto opened = open_image(std::as_bytes(std::span(bytes)), "stress", ColorDecoding::srgb);
    const bool later = opened && (*opened)->encoded;
    if (!image) return has_causes(image.error()) && (later ? !with_pixels(*opened) : !opened);
    if (!opened || with_pixels(*opened)->pixels.size() != (*image)->pixels.size()) return false;
    return (*image)->pixels.size() == std::size_t((*image)->width) * std::size_t((*image)->height) &&
           (*image)->width == (*opened)->width && (*image)->height == (*opened)->height;
}

struct Seed {
    std::string name, bytes;
    Reader reader;
};

std::vector<Seed> read_seeds() {
    const std::pair<const char*, Reader> readers[] = {{"obj", read_as_obj},
                                                      {"ply", read_as_ply},
                                                      {"gltf", read_as_gltf},
                                                      {"scene", read_as_scene},
                                                      {"image", read_as_image}};
    std::vector<Seed> seeds;
    for (const auto& [name, reader] : readers) {
        for (const auto& entry :
             std::filesystem::directory_iterator(std::filesystem::path(RAYUELA_TESTS_DIR) / "fuzz/corpus" / name)) {
            std::ifstream file(entry.path(), std::ios::binary);
            seeds.push_back({entry.path().filename(), {std::istreambuf_iterator<char>(file), {}}, reader});
        }
    }
    std::ranges::sort(seeds, {}, &Seed::name);
    return seeds;
}

/// A number that sizes and offsets do not expect.
std::string hostile_number(Random& random) {
    constexpr std::array kNumbers{"0",
                                  "-1",
                                  "1",
                                  "255",
                                  "65535",
                                  "2147483647",
                                  "-2147483648",
                                  "4294967295",
                                  "4294967296",
                                  "9223372036854775807",
                                  "18446744073709551612",
                                  "18446744073709551615",
                                  "1e38",
                                  "1e39",
                                  "1e300",
                                  "-1e300",
                                  "1e-46",
                                  "0.5",
                                  "null",
                                  "nan",
                                  "inf",
                                  "\"\"",
                                  "[]",
                                  "{}"};
    return kNumbers[random.bits() % kNumbers.size()];
}

/// Bits flipped, bytes set, parts cut out or said twice, numbers replaced.
std::string mutate(std::string bytes, Random& random) {
    const auto at = [&] { return bytes.empty() ? 0 : random.bits() % bytes.size(); };
    for (int change = random.integer(1, 6); change > 0 && !bytes.empty(); --change) {
        const std::size_t from = at();
        switch (random.integer(0, 5)) {
            case 0:
                bytes[from] = static_cast<char>(bytes[from] ^ (1 << random.integer(0, 7)));
                break;
            case 1:
                bytes[from] = static_cast<char>(random.bits());
                break;
            case 2:
                bytes.erase(from, random.bits() % 32);
                break;
            case 3:
                bytes.insert(from, bytes.substr(at(), random.bits() % 64));
                break;
            default: {
                const std::size_t digit = bytes.find_first_of("0123456789", from);
                if (digit == std::string::npos) break;
                const std::size_t end = bytes.find_first_not_of("0123456789.eE+-", digit);
                bytes.replace(digit, end == std::string::npos ? std::string::npos : end - digit,
                              hostile_number(random));
                break;
            }
        }
    }
    return bytes;
}

/// Figure: the longest time that an input took.
Outcome mutated_files(double scale) {
    const std::vector<Seed> seeds = read_seeds();
    return for_cases(scaled(3e5, scale, 1000), 55, [&](Random& random, Outcome& outcome) {
        const Seed& seed = seeds[random.bits() % seeds.size()];
        const std::string bytes = mutate(seed.bytes, random);
        const auto start = std::chrono::steady_clock::now();
        const bool fine = seed.reader(bytes);
        outcome.measure(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        outcome.expect(fine, [&] { return fmt::format("{}: {}", seed.name, bytes.substr(0, 2000)); });
    });
}

Outcome truncated_files(double) {
    Outcome outcome;
    for (const Seed& seed : read_seeds()) {
        for (std::size_t size = 0; size < seed.bytes.size(); size += 1 + seed.bytes.size() / 2000) {
            outcome.expect(seed.reader(seed.bytes.substr(0, size)),
                           [&] { return fmt::format("{} cut at {}", seed.name, size); });
            ++outcome.cases;
        }
    }
    return outcome;
}

/// A square whose every number but the version may be hostile.
std::string hostile_gltf(Random& random) {
    const auto number = [&](int usual) {
        return random.integer(0, 9) ? std::to_string(usual) : hostile_number(random);
    };
    const std::string sparse =
        random.integer(0, 2)
            ? ""
            : fmt::format(
                  R"(, "sparse": {{"count": {}, "indices": {{"bufferView": {}, "byteOffset": {}, "componentType": {}}}, "values": {{"bufferView": {}, "byteOffset": {}}}}})",
                  number(1), number(1), number(0), number(5123), number(0), number(0));
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "scene": {}, "scenes": [{{"nodes": [{}]}}],
        "nodes": [{{"mesh": {}, "scale": [{}, 1, {}], "children": [{}]}}, {{"mesh": 0, "children": [{}]}}, {{}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}, "indices": {}, "mode": {}, "material": {}}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"roughnessFactor": {}, "baseColorTexture": {{"index": {}}}}}}}],
        "textures": [{{"source": {}}}], "images": [{{"uri": "missing.png"}}],
        "accessors": [{{"bufferView": {}, "byteOffset": {}, "componentType": {}, "count": {}, "type": "VEC3"{}}},
                      {{"bufferView": {}, "byteOffset": {}, "componentType": {}, "count": {}, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": {}, "byteOffset": {}, "byteLength": {}, "byteStride": {}}}, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
        "buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAAAAABAAIAAgABAAMA"}}]}})",
        number(0), number(0), number(0), number(1), number(1), number(1), number(2), number(0), number(1), number(4),
        number(0), number(1), number(0), number(0), number(0), number(0), number(5126), number(4), sparse, number(1),
        number(0), number(5123), number(6), number(0), number(0), number(48), number(12), number(48), number(12),
        number(60));
}

std::string hostile_obj(Random& random) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\n";
    if (random.integer(0, 3) == 0) text += fmt::format("v {} 0 1\n", hostile_number(random));
    for (int i = random.integer(1, 4); i > 0; --i) {
        text += "f";
        for (int corner = random.integer(2, 6); corner > 0; --corner) {
            text += ' ' + (random.integer(0, 9) ? std::to_string(random.integer(-3, 3)) : hostile_number(random));
            if (random.integer(0, 3) == 0)
                text += '/' + hostile_number(random) + '/' + std::to_string(random.integer(-1, 1));
        }
        text += '\n';
    }
    return text;
}

/// Chains of 1e5 nodes and rings of nodes.
std::string long_gltf(bool ring) {
    constexpr int kNodes = 100'000;
    std::string nodes;
    for (int i = 0; i < kNodes; ++i) {
        const bool last = i + 1 == kNodes;
        if (last && !ring) {
            nodes += R"({"name": "leaf"})";
        } else {
            nodes += fmt::format(R"({{"children": [{}]}}{})", last ? 0 : i + 1, last ? "" : ",");
        }
    }
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [)" + nodes + "]}";
}

Outcome hostile_files(double scale) {
    Outcome outcome = for_cases(scaled(3e5, scale, 1000), 56, [](Random& random, Outcome& found) {
        const bool gltf = random.integer(0, 1) == 1;
        const std::string bytes = gltf ? hostile_gltf(random) : hostile_obj(random);
        found.expect(gltf ? read_as_gltf(bytes) : read_as_obj(bytes), [&] { return bytes; });
    });
    for (const bool ring : {false, true}) {
        outcome.expect(read_as_gltf(long_gltf(ring)), [&] { return ring ? "ring of nodes" : "chain of nodes"; });
        ++outcome.cases;
    }
    return outcome;
}

}  // namespace

std::vector<StressTest> file_tests() {
    return {{54, "truncated files: refused with a cause, or shown", "-", 0, truncated_files},
            {55, "mutated files: refused with a cause, or shown", "seconds", 10, mutated_files},
            {56, "hostile numbers, indices, nodes in glTF and OBJ", "-", 0, hostile_files}};
}

}  // namespace rayuela::stress
