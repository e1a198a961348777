// Rays a second of list, kd-tree (median, sah) and Embree on one thread:
//     rayuela_bench --benchmark_filter=rays --benchmark_enable_random_interleaving=true --benchmark_repetitions=11
// A structure that disagrees with the list, or with Embree on more than 100 rays in a million, fails its run.
#include "core/accel/surface_point.h"
#include "core/math/float_error.h"
#include "tests/support/accel_scenes.h"

#include <benchmark/benchmark.h>

#include <map>
#include <string>

#ifdef RAYUELA_EMBREE
#if RAYUELA_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#endif

namespace rayuela::test {
namespace {

enum class Kind { camera, bounce, shadow };

constexpr std::size_t kRays = 1 << 16;

/// A ball with spikes, folds and hollows, so that rays have something to pass by.
MeshPtr make_rough_ball(int rings) {
    MeshPtr ball = make_ball(rings, 1, Vec3(0), 0, 1);
    std::vector<Vec3> positions = ball->positions;
    for (Vec3& p : positions) {
        const float bumps = std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(7 * p.z + 2);
        p *= 1 + 0.5f * bumps + 0.03f * std::sin(60 * p.x) * std::cos(70 * p.y);
    }
    return make_mesh(std::move(positions), ball->triangles);
}

struct Workload {
    std::vector<GeometryInstance> instances;
    std::map<Kind, std::vector<Ray>> rays;

    explicit Workload(int rings) : instances{{make_rough_ball(rings), {}}} {
        const auto kd = build(instances, {});
        Random random(1);
        const Vec3 light(3, 6, 2);
        while (rays[Kind::shadow].size() < kRays) {
            const float x = random.uniform(-1.4f, 1.4f), y = random.uniform(-1.4f, 1.4f);
            const Ray camera{.origin = Vec3(0, 0, 4), .direction = glm::normalize(Vec3(x, y, -4))};
            if (rays[Kind::camera].size() < kRays) rays[Kind::camera].push_back(camera);
            const Hit hit = intersect(*kd, camera);
            if (!hit.valid()) continue;
            const SurfacePoint point = surface_point(instances, camera, hit);
            const auto leave = [&](const Vec3& w, float t_max) {
                return Ray{
                    .origin = offset_ray_origin(point.p, point.p_error, point.ng, w), .direction = w, .t_max = t_max};
            };
            rays[Kind::bounce].push_back(leave(glm::normalize(point.ng + 0.999f * random.direction()), kInfinity));
            rays[Kind::shadow].push_back(leave(light + random.in_cube(0.2f) - point.p, 0.999f));
        }
    }
};

const Workload& workload(int rings) {
    static std::map<int, Workload> all;
    return all.try_emplace(rings, rings).first->second;
}

struct Answers {
    std::vector<Hit> hits = std::vector<Hit>(kRays);
    std::vector<std::uint8_t> blocked = std::vector<std::uint8_t>(kRays);
};

#ifdef RAYUELA_EMBREE
class Embree {
public:
    explicit Embree(const TriangleMesh& mesh) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* positions = static_cast<float*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
        for (const Vec3& p : mesh.positions) positions = std::copy(&p.x, &p.x + 3, positions);
        auto* indices = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
        for (const glm::uvec3& t : mesh.triangles) indices = std::copy(&t.x, &t.x + 3, indices);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~Embree() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    void intersect(const std::vector<Ray>& rays, std::vector<Hit>& hits) const {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RTCRayHit query{to_embree(rays[i]), {}};
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RAYUELA_EMBREE >= 4
            rtcIntersect1(scene_, &query);
#else
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            rtcIntersect1(scene_, &context, &query);
#endif
            hits[i] = {};
            if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
            hits[i] = {query.ray.tfar, query.hit.u, query.hit.v, 0, query.hit.primID};
        }
    }
    void occluded(const std::vector<Ray>& rays, std::vector<std::uint8_t>& blocked) const {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RTCRay query = to_embree(rays[i]);
#if RAYUELA_EMBREE >= 4
            rtcOccluded1(scene_, &query);
#else
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            rtcOccluded1(scene_, &context, &query);
#endif
            blocked[i] = query.tfar < 0;
        }
    }

private:
    static RTCRay to_embree(const Ray& ray) {
        RTCRay query{};
        query.org_x = ray.origin.x, query.org_y = ray.origin.y, query.org_z = ray.origin.z, query.tnear = ray.t_min;
        query.dir_x = ray.direction.x, query.dir_y = ray.direction.y, query.dir_z = ray.direction.z;
        query.tfar = ray.t_max;
        query.mask = ~0u;
        return query;
    }

    RTCDevice device_;
    RTCScene scene_;
};

double disagreement_ppm(const Answers& ours, const Answers& theirs, Kind kind) {
    std::size_t different = 0;
    for (std::size_t i = 0; i < kRays; ++i) {
        different += kind == Kind::shadow ? ours.blocked[i] != theirs.blocked[i]
                                          : ours.hits[i].primitive != theirs.hits[i].primitive;
    }
    return 1e6 * static_cast<double>(different) / static_cast<double>(kRays);
}
#endif

template <typename Structure>
void trace(const Structure& structure, Kind kind, const std::vector<Ray>& rays, Answers& answers) {
    if (kind == Kind::shadow) {
        structure.occluded(rays, answers.blocked);
    } else {
        structure.intersect(rays, answers.hits);
    }
}

void report(benchmark::State& state, std::size_t rays) {
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(rays));
}

/// Whether the first rays agree with the list's answers.
bool agrees_with_list(const Workload& load, Kind kind, const Answers& answers) {
    std::vector<Ray> rays(load.rays.at(kind).begin(), load.rays.at(kind).begin() + 256);
    Answers expected;
    trace(*build(load.instances, {.kind = AcceleratorKind::list}), kind, rays, expected);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit &a = expected.hits[i], &b = answers.hits[i];
        if (kind == Kind::shadow ? expected.blocked[i] != answers.blocked[i]
                                 : a.t != b.t || a.primitive != b.primitive) {
            return false;
        }
    }
    return true;
}

void run_list(benchmark::State& state, int rings, Kind kind) {
    const Workload& load = workload(rings);
    const std::vector<Ray> rays(load.rays.at(kind).begin(), load.rays.at(kind).begin() + 16);
    const auto list = build(load.instances, {.kind = AcceleratorKind::list});
    Answers answers;
    for (auto _ : state) trace(*list, kind, rays, answers);
    report(state, rays.size());
}

void run_kd(benchmark::State& state, int rings, Kind kind, KdSplit split, int leaf_size) {
    const Workload& load = workload(rings);
    const std::vector<Ray>& rays = load.rays.at(kind);
    const auto kd = build(load.instances, {.leaf_size = leaf_size, .split = split});
    Answers answers;
    for (auto _ : state) trace(*kd, kind, rays, answers);
    report(state, rays.size());
    const AccelStats stats = kd->stats();
    state.counters["refs"] = static_cast<double>(stats.references) / static_cast<double>(stats.primitives);
    state.counters["build_s"] = stats.build_seconds;
    state.counters["MB"] = static_cast<double>(stats.memory_bytes) * 1e-6;
    if (!agrees_with_list(load, kind, answers)) state.SkipWithError("differs from the list");
#ifdef RAYUELA_EMBREE
    Answers theirs;
    trace(Embree(*std::get<MeshPtr>(load.instances[0].shape)), kind, rays, theirs);
    state.counters["embree_ppm"] = disagreement_ppm(answers, theirs, kind);
    if (state.counters["embree_ppm"] > 100) state.SkipWithError("differs from Embree");
#endif
}

#ifdef RAYUELA_EMBREE
void run_embree(benchmark::State& state, int rings, Kind kind) {
    const Workload& load = workload(rings);
    const std::vector<Ray>& rays = load.rays.at(kind);
    const Embree embree(*std::get<MeshPtr>(load.instances[0].shape));
    Answers answers;
    for (auto _ : state) trace(embree, kind, rays, answers);
    report(state, rays.size());
}
#endif

void build_kd(benchmark::State& state, int rings, KdSplit split, int leaf_size) {
    const Workload& load = workload(rings);
    for (auto _ : state) benchmark::DoNotOptimize(build(load.instances, {.leaf_size = leaf_size, .split = split}));
}

const bool kRegistered = [] {
    const std::map<std::string, int> meshes{{"70k", 133}, {"1M", 501}};
    const std::map<std::string, Kind> kinds{
        {"camera", Kind::camera}, {"bounce", Kind::bounce}, {"shadow", Kind::shadow}};
    const auto add = [](const std::string& name, auto function, auto... arguments) {
        return benchmark::RegisterBenchmark(name.c_str(), function, arguments...)->Unit(benchmark::kMillisecond);
    };
    for (const auto& [mesh, rings] : meshes) {
        for (const auto& [kind_name, kind] : kinds) {
            const std::string prefix = "rays/" + mesh + "/" + kind_name + "/";
            if (rings < 200) add(prefix + "list", run_list, rings, kind);
            add(prefix + "median16", run_kd, rings, kind, KdSplit::median, 16);
            for (const int leaf : {8, 16, 32})
                add(prefix + "sah" + std::to_string(leaf), run_kd, rings, kind, KdSplit::sah, leaf);
#ifdef RAYUELA_EMBREE
            add(prefix + "embree", run_embree, rings, kind);
#endif
        }
        for (const int leaf : {16, 32}) {
            add("build/" + mesh + "/sah" + std::to_string(leaf), build_kd, rings, KdSplit::sah, leaf)->UseRealTime();
            add("build/" + mesh + "/median" + std::to_string(leaf), build_kd, rings, KdSplit::median, leaf)
                ->UseRealTime();
        }
    }
    return true;
}();

}  // namespace
}  // namespace rayuela::test
