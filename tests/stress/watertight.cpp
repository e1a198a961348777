#include "core/math/isa.h"
#include "core/shapes/intersect_triangle.h"
#include "tests/stress/stress.h"
#include "tests/support/closed_meshes.h"
#include "tests/support/oracle.h"

#include <fmt/format.h>

namespace rayuela::stress {
namespace {

using namespace rayuela::test;

const std::vector<MeshPtr>& unit_meshes() {
    static const std::vector<MeshPtr> meshes{make_tetrahedron(), make_cube(), make_ball(16, 1, Vec3(0), 0.1f, 3),
                                             make_icosphere(6)};
    return meshes;
}

/// A unit mesh somewhere in the world, either by its vertices or by the transform of its instance.
struct PlacedMesh {
    MeshPtr unit;
    float scale = 1;
    Vec3 center{0};
    std::shared_ptr<const Accelerator> accelerator;

    /// Shares the tree of the mesh with `previous` where it can.
    PlacedMesh(MeshPtr mesh, float s, const Vec3& c, bool by_instance, const Accelerator* previous)
        : unit(std::move(mesh)), scale(s), center(c) {
        const GeometryInstance instance =
            by_instance ? GeometryInstance{unit, {Mat3(s), c}} : GeometryInstance{moved(*unit, s, c), {}};
        BuildControl control;
        accelerator = Accelerator::build({instance}, {.leaf_size = 4}, previous, control);
    }
    /// From within a tenth of the size around the centre.
    Ray ray_from_inside(Random& random) const {
        const Vec3 from = random.in_cube(0.1f);
        Vec3 direction = aim(*unit, random) - from;
        if (random.integer(0, 1)) direction = glm::normalize(direction);
        return {.origin = center + scale * from, .direction = scale * direction};
    }
};

Outcome trace_from_inside(const PlacedMesh& mesh, std::uint64_t count, std::uint64_t seed) {
    return for_batches(count, seed, 4096, [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
        std::vector<Ray> rays;
        for (std::uint64_t i = 0; i < n; ++i) rays.push_back(mesh.ray_from_inside(random));
        std::vector<Hit> hits(n);
        mesh.accelerator->intersect(rays, hits);
        for (std::size_t i = 0; i < n; ++i) {
            outcome.expect(hits[i].valid(), [&] {
                return fmt::format("{} triangles, scale {:g}, centre {}: {}", mesh.unit->triangles.size(), mesh.scale,
                                   describe(mesh.center), describe(rays[i]));
            });
        }
    });
}

/// Where the vertices keep apart, or at least do not cross the rays' origins.
bool fits_floats(float scale, const Vec3& center) {
    const float largest = max_component(glm::abs(center));
    return scale >= 8 * (std::nextafter(largest, kInfinity) - largest);
}

std::vector<PlacedMesh> place(const std::vector<float>& scales) {
    constexpr std::size_t kLarge = 10'000;  // triangles, whose trees are not built again for every scale
    std::vector<PlacedMesh> placed;
    for (const MeshPtr& unit : unit_meshes()) {
        const Accelerator* previous = nullptr;
        for (const Vec3 center : {Vec3(0), Vec3(148376, 1234, -223423), Vec3(1e6f)}) {
            for (const float scale : scales) {
                placed.emplace_back(unit, scale, center, true, previous);
                previous = placed.back().accelerator.get();
                if (fits_floats(scale, center) && (unit->triangles.size() < kLarge || scale == scales.back()))
                    placed.emplace_back(unit, scale, center, false, nullptr);
            }
        }
    }
    return placed;
}

Outcome trace_from_inside(const std::vector<PlacedMesh>& placed, std::uint64_t count, std::uint64_t seed) {
    Outcome total;
    for (std::size_t i = 0; i < placed.size(); ++i)
        total.add(trace_from_inside(placed[i], count / placed.size() + 1, seed + i));
    return total;
}

Outcome closed_meshes(double scale) {
    return trace_from_inside(place({1e-6f, 1e-3f, 1, 37.7f, 1e6f, 1e3f}), scaled(1e8, scale), 7000);
}

Outcome closed_meshes_of_picometres(double scale) {
    return trace_from_inside(place({1e-12f}), scaled(1e7, scale), 11000);
}

/// From SSE2 to what this machine has at best. Compilers and levels of optimisation: tests/stress/compilers.sh.
Outcome instruction_sets(double scale) {
    const std::vector<PlacedMesh> placed = place({1e-3f, 37.7f});
    Outcome total;
    for (const std::string_view set : rayuela::instruction_sets()) {
        use_instruction_set(set);
        total.add(trace_from_inside(placed, scaled(3e6, scale), 8000));
    }
    use_instruction_set(rayuela::instruction_sets().front());
    return total;
}

/// [-1, 1]^2 in triangles whose inner vertices are anywhere in their cell.
MeshPtr jittered_square(int cells, std::uint64_t seed) {
    Random random(seed);
    const MeshPtr grid = make_grid(cells, 0);
    std::vector<Vec3> positions = grid->positions;
    const float jitter = 0.9f / static_cast<float>(cells);
    for (Vec3& p : positions) {
        if (std::fabs(p.x) < 1 && std::fabs(p.z) < 1)
            p += jitter * Vec3(random.uniform(-1, 1), 0, random.uniform(-1, 1));
    }
    return make_mesh(std::move(positions), grid->triangles);
}

/// Looked at from the grid of 256^2 pixels whose lines are those of the unjittered vertices.
Outcome subdivided_square(double scale) {
    const int seeds = static_cast<int>(scaled(10, std::sqrt(scale), 1));
    Outcome total;
    for (const int cells : {1, 2, 4, 8, 16, 32, 64, 128, 181}) {  // 2 to 65,522 triangles
        for (int seed = 0; seed < seeds; ++seed) {
            const auto kd = build({{jittered_square(cells, static_cast<std::uint64_t>(seed)), {}}}, {});
            total.add(for_batches(255, 9, 1, [&](Random&, std::uint64_t row, std::uint64_t, Outcome& outcome) {
                const Vec3 eye(0.3f, 2, -0.4f);
                for (int column = 1; column < 256; ++column) {
                    const Vec3 target(static_cast<float>(column) / 128 - 1, 0, static_cast<float>(row + 1) / 128 - 1);
                    for (const Ray& ray : {Ray{.origin = eye, .direction = target - eye},
                                           Ray{.origin = target + Vec3(0, 1, 0), .direction = Vec3(0, -1, 0)}}) {
                        outcome.expect(intersect(*kd, ray).valid(), [&] { return describe(ray); });
                        ++outcome.cases;
                    }
                }
                --outcome.cases;
            }));
        }
    }
    return total;
}

/// The closest hit of a ray from outside is a front, unless a front lies at the very same t.
Outcome first_hit_from_outside(double scale) {
    Outcome total;
    for (const MeshPtr& mesh : unit_meshes()) {
        const auto kd = build({{mesh, {}}}, {});
        const auto facing = [&](const Hit& hit, const Ray& ray) {
            const glm::uvec3& t = mesh->triangles[hit.primitive];
            const Vec3d a(mesh->positions[t.x]), b(mesh->positions[t.y]), c(mesh->positions[t.z]);
            return glm::dot(glm::cross(b - a, c - a), Vec3d(ray.direction));
        };
        total.add(for_cases(scaled(2.5e6, scale), 12, [&](Random& random, Outcome& outcome) {
            Ray ray{.origin = random.direction() * random.uniform(2, 5)};
            ray.direction = aim(*mesh, random) - ray.origin;
            const Hit hit = intersect(*kd, ray);
            if (!hit.valid() || facing(hit, ray) <= 0) return;
            // A back: is there a front at the same t?
            bool front_too = false;
            const TriangleRay exact{RayD(ray)};
            for (const glm::uvec3& t : mesh->triangles) {
                ShapeHit other;
                const auto primitive = static_cast<std::uint32_t>(&t - mesh->triangles.data());
                if (intersect_triangle(exact, mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z],
                                       {hit.t, hit.t}, other))
                    front_too |= facing({.primitive = primitive}, ray) <= 0;
            }
            outcome.expect(front_too, [&] { return describe(ray); });
        }));
    }
    return total;
}

}  // namespace

std::vector<StressTest> watertight_tests() {
    return {{7, "closed meshes: no ray leaves from inside", "leaks", 0, closed_meshes},
            {8, "the same on each instruction set", "leaks", 0, instruction_sets},
            {9, "subdivided square: no holes", "holes", 0, subdivided_square},
            {11, "closed meshes at scale 1e-12", "leaks", 0, closed_meshes_of_picometres},
            {12, "closed meshes from outside: a front comes first", "backs", 0, first_hit_from_outside}};
}

}  // namespace rayuela::stress
