#include "tests/stress/stress.h"
#include "tests/support/closed_meshes.h"
#include "tests/support/hits.h"
#include "tests/support/scalar_list.h"

#include <fmt/format.h>

#include <ctime>

// As core/accel/kd_kernels.cpp does.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/stress/padding.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/accel/mesh_apart-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayuela::HWY_NAMESPACE {

/// Nodes that rays visit on their way through a mesh by the steps of the kernels: inner nodes and leaves with triangles.
std::uint64_t count_visits(const MeshTree& mesh, const TracedObject& object, std::span<const Ray> rays,
                           std::span<Hit> hits) {
    std::uint64_t visits = 0;
    const KdNode* const nodes = mesh.tree.nodes.data();
    RayBlock block;
    for (std::uint32_t i = 0; i < rays.size(); ++i) {
        RayBlockWriter(rays, hits, &object, mesh.tree.bounds, mesh.bounds).write({&i, 1}, block);
        if (mesh.tree.apart != 0) ++visits;
        sweep_apart<Query::closest>(mesh, 0, block, rays, hits);
        if (!block.is_open(0)) continue;
        MeshClient<Query::closest> client(mesh, 0, block, rays, hits);
        LaneGroups lanes;
        LaneGroup& group = lanes.group[0];
        client.start(0, 0);
        group.start(0, block, 0);
        while (group.active() != 0) {
            while (group.step(nodes), group.at_leaf().any == 0) ++visits;
            const LeafVisit visit{0, group.first(0), group.count(0)};
            if (visit.count > 0) {
                ++visits;
                client.visit({&visit, 1}, lanes);
            }
            group.pop(group.active());
        }
    }
    return visits;
}

/// The same rays in blocks, and the CPU seconds that took after the blocks were written. Without `padded` the kernels find
/// pads of 0.
double trace_seconds(const MeshTree& mesh, const TracedObject& object, std::span<const Ray> rays, std::span<Hit> hits,
                     bool padded) {
    double clocks = 0;
    RayBlock block;
    std::vector<std::uint32_t> ids;
    for (std::size_t first = 0; first < rays.size(); first += ids.size()) {
        ids.resize(std::min(kBlockRays, rays.size() - first));
        std::iota(ids.begin(), ids.end(), static_cast<std::uint32_t>(first));
        RayBlockWriter(rays, hits, &object, mesh.tree.bounds, mesh.bounds).write(ids, block);
        if (!padded) std::fill(std::begin(block.pad), std::end(block.pad), 0.0f);
        MeshClient<Query::closest> client(mesh, 0, block, rays, hits);
        const std::clock_t start = std::clock();
        sweep_apart<Query::closest>(mesh, 0, block, rays, hits);
        trace_packets(mesh.tree, block, client);
        trace_lanes(mesh.tree, block, client);
        clocks += static_cast<double>(std::clock() - start);
    }
    return clocks / CLOCKS_PER_SEC;
}

}  // namespace rayuela::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayuela {

HWY_EXPORT(count_visits);
HWY_EXPORT(trace_seconds);

namespace stress {
namespace {

using namespace rayuela::test;

/// The same tree in double, each plane passed once, each hit as of the scalar routine.
class UnpaddedTraversal {
public:
    explicit UnpaddedTraversal(const MeshTree& mesh) : mesh_(mesh), triangles_(mesh.mesh.lock()) {}

    std::uint64_t visits() const { return visits_; }

    Hit trace(const Ray& ray) {
        ray_ = RayD(ray);
        range_ = {ray.t_min, ray.t_max};
        best_ = {};
        if (mesh_.tree.apart != 0) visit(mesh_.tree.apart, ray.t_min, ray.t_max);
        double begin = ray.t_min, end = ray.t_max;
        for (int axis = 0; axis < 3; ++axis) {
            const double lo = mesh_.tree.bounds.lo[axis], hi = mesh_.tree.bounds.hi[axis];
            const double o = ray_.origin[axis], d = ray_.direction[axis];
            if (d == 0 && (o < lo || o > hi)) return {};
            if (d == 0) continue;
            begin = std::max(begin, ((d < 0 ? hi : lo) - o) / d);
            end = std::min(end, ((d < 0 ? lo : hi) - o) / d);
        }
        if (begin <= end) visit(0, begin, end);
        return best_;
    }

private:
    void visit(std::uint32_t index, double begin, double end) {
        end = std::min(end, double{best_.t});
        const KdNode& node = mesh_.tree.nodes[index];
        if (begin > end || node.is_empty_leaf()) return;
        ++visits_;
        if (node.is_leaf()) {
            test(node);
            return;
        }
        const double o = ray_.origin[node.axis()], d = ray_.direction[node.axis()];
        const double t = d == 0 ? INFINITY : (double{node.split()} - o) / d;
        const bool from_above = d == 0 ? o > node.split() : d < 0;
        const std::uint32_t near = from_above ? 1 : 0, far = 1 - near;
        if (t >= begin) visit(node.children() + near, begin, std::min(t, end));
        if (t <= end) visit(node.children() + far, std::max(t, begin), end);
    }

    void test(const KdNode& leaf) {
        for (const std::uint32_t primitive : mesh_.references(leaf)) {
            const glm::uvec3& t = triangles_->triangles[primitive];
            const auto& p = triangles_->positions;
            ShapeHit hit;
            if (intersect_triangle(TriangleRay(ray_), p[t.x], p[t.y], p[t.z], range_, hit))
                keep_closer(hit, 0, primitive, best_);
        }
    }

    const MeshTree& mesh_;
    std::shared_ptr<const TriangleMesh> triangles_;
    RayD ray_;
    TRange range_;
    Hit best_;
    std::uint64_t visits_ = 0;
};

struct Case {
    MeshPtr mesh;
    TracedObject object;
    std::shared_ptr<const MeshTree> tree;

    Case(const MeshPtr& m, const AccelSettings& settings) : mesh(m), object(GeometryInstance{m, {}}) {
        BuildControl control;
        tree = build_mesh_tree(mesh, settings, control);
    }
};

std::vector<MeshPtr> meshes() {
    Random random(26);
    const MeshPtr icosphere = make_icosphere(5);
    return {icosphere,
            moved(*icosphere, 1, Vec3(10)),
            make_ball(40, 1, Vec3(0), 0.3f, 26),
            make_soup(5000, random),
            make_grid(100, 0.3f),
            make_grid(100, 0)};
}

Vec3 random_point(const TriangleMesh& mesh, Random& random) {
    const glm::uvec3& t = mesh.triangles[random.bits() % mesh.triangles.size()];
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    return glm::mix(a, glm::mix(b, c, random.uniform()), random.uniform());
}

/// From around the mesh towards it, and from its surface into any direction.
std::vector<Ray> random_rays(const TriangleMesh& mesh, std::size_t count, Random& random) {
    const Vec3 center = mesh.bounds.center();
    const float radius = glm::length(mesh.bounds.extent());
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const Vec3 p = random_point(mesh, random);
        const Vec3 from = random.integer(0, 1) ? center + radius * random.direction() : p;
        rays.push_back({.origin = from, .direction = from == p ? random.direction() : p - from});
    }
    return rays;
}

/// Figure: nodes that the kernels visit over those of the traversal in double, of 2000 rays at a time.
Outcome visited_nodes(double scale) {
    Outcome total;
    for (const MeshPtr& mesh : meshes()) {
        for (const KdSplit split : {KdSplit::median, KdSplit::sah}) {
            for (const int leaf_size : {1, 4, 16, 64}) {
                const Case c(mesh, {.leaf_size = leaf_size, .split = split});
                total.add(for_batches(
                    scaled(1e6 / 48, scale, 2000), 26, 2000,
                    [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
                        const std::vector<Ray> rays = random_rays(*mesh, n, random);
                        std::vector<Hit> hits(n);
                        const auto visits = HWY_DYNAMIC_DISPATCH(count_visits)(*c.tree, c.object, rays, hits);
                        UnpaddedTraversal unpadded(*c.tree);
                        for (const Ray& ray : rays) unpadded.trace(ray);
                        outcome.measure(static_cast<double>(visits) / static_cast<double>(unpadded.visits()));
                    }));
            }
        }
    }
    return total;
}

/// Figure: CPU time of the kernels over the same with pads of 0, which leaves only the few instructions that apply them out
/// of account; the fastest of all rounds of each, since other work of the machine only adds.
Outcome time_of_pads(double scale) {
    constexpr std::size_t kRays = 20'000;
    const std::uint64_t rounds = scaled(41, std::sqrt(scale), 9);
    Random random(27);
    Outcome outcome;
    double padded = 0, unpadded = 0;
    for (const MeshPtr& mesh : meshes()) {
        const Case c(mesh, {});
        const std::vector<Ray> rays = random_rays(*mesh, kRays, random);
        std::array<double, 2> fastest{INFINITY, INFINITY};
        for (std::uint64_t turn = 0; turn < 2 * rounds; ++turn) {
            std::vector<Hit> hits(kRays);
            const double seconds = HWY_DYNAMIC_DISPATCH(trace_seconds)(*c.tree, c.object, rays, hits, turn % 2 == 0);
            fastest[turn % 2] = std::min(fastest[turn % 2], seconds);
            outcome.cases += kRays;
        }
        padded += fastest[0];
        unpadded += fastest[1];
    }
    outcome.measure(padded / unpadded);
    return outcome;
}

/// Ever smaller triangles towards a point make a tree as deep as trees get, and rays through the point need all the stack.
Outcome deepest_tree(double scale) {
    std::vector<Vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < 120; ++i) {
        const float size = std::ldexp(1.0f, -static_cast<int>(i));
        positions.insert(positions.end(), {Vec3(size), size * Vec3(1.25f, 1, 1), size * Vec3(1, 1.25f, 1.25f)});
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const std::vector<GeometryInstance> scene{{make_mesh(std::move(positions), std::move(triangles)), {}}};
    const auto list = scalar_list(scene), kd = build(scene, {.leaf_size = 1});
    Outcome total = for_batches(
        scaled(1e6, scale), 28, 1024, [&](Random& random, std::uint64_t, std::uint64_t n, Outcome& outcome) {
            std::vector<Ray> rays;
            const Vec3 from = random.direction();
            while (rays.size() < n) {
                const Vec3 to = random.integer(0, 1) ? Vec3(0) : special_point(scene, random);
                const Vec3 origin = from + (random.integer(0, 1) ? Vec3(0) : random.in_cube(0.01f));
                rays.push_back({.origin = origin, .direction = to - origin});
            }
            const Answers expected = trace(*list, rays), actual = trace(*kd, rays);
            for (std::size_t i = 0; i < n; ++i)
                outcome.expect(identical(expected.hits[i], actual.hits[i]), [&] { return describe(rays[i]); });
        });
    total.expect(kd->stats().depth == kKdMaxDepth, [&] { return fmt::format("depth {}", kd->stats().depth); });
    return total;
}

}  // namespace

std::vector<StressTest> padding_tests() {
    return {{26, "padded planes: nodes visited", "times those in double", 1.01, visited_nodes},
            {26, "padded planes: time", "times pads of 0", 1.05, time_of_pads},
            {26, "the deepest tree and its stack: the list's hits", "-", 0, deepest_tree}};
}

}  // namespace stress
}  // namespace rayuela
#endif
