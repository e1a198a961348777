#include "app/embree_rival.h"

#include "app/clocks.h"

#include <algorithm>
#include <atomic>
#include <string>

#ifdef RAYUELA_EMBREE3
#include <embree3/rtcore.h>
#endif

namespace rayuela {

std::string_view name_of(EmbreeMode mode) {
    switch (mode) {
        case EmbreeMode::single:
            return "single";
        case EmbreeMode::packet16:
            return "packet 16";
        case EmbreeMode::stream:
            return "stream";
    }
    return "";
}

#ifdef RAYUELA_EMBREE3

/// Single rays and streams live in `singles`, packets in `packets`. A blocked ray has t_far < 0.
struct EmbreeQuery::Rays {
    bool any_hit;
    EmbreeMode mode;
    bool coherent;
    std::size_t count = 0;
    std::vector<float> t_far;
    std::vector<RTCRayHit> singles;
    std::vector<RTCRay> single_rays;
    std::vector<RTCRayHit16> packets;
};

EmbreeQuery::EmbreeQuery(std::span<const Ray> rays, bool any_hit, EmbreeMode mode, bool coherent)
    : rays_(new Rays{any_hit, mode, coherent, rays.size(), {}, {}, {}, {}}) {
    rays_->packets.resize(mode == EmbreeMode::packet16 ? (rays.size() + 15) / 16 : 0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& from = rays[i];
        rays_->t_far.push_back(from.t_max);
        if (mode == EmbreeMode::packet16) {
            RTCRay16& to = rays_->packets[i / 16].ray;
            const std::size_t k = i % 16;
            to.org_x[k] = from.origin.x, to.org_y[k] = from.origin.y, to.org_z[k] = from.origin.z;
            to.dir_x[k] = from.direction.x, to.dir_y[k] = from.direction.y, to.dir_z[k] = from.direction.z;
            to.tnear[k] = from.t_min, to.time[k] = 0, to.mask[k] = ~0u;
            continue;
        }
        RTCRay to{};
        to.org_x = from.origin.x, to.org_y = from.origin.y, to.org_z = from.origin.z;
        to.dir_x = from.direction.x, to.dir_y = from.direction.y, to.dir_z = from.direction.z;
        to.tnear = from.t_min, to.mask = ~0u;
        if (any_hit) {
            rays_->single_rays.push_back(to);
        } else {
            rays_->singles.push_back({to, {}});
        }
    }
    reset();
}

void EmbreeQuery::reset() {
    for (std::size_t i = 0; i < rays_->count; ++i) {
        if (rays_->mode == EmbreeMode::packet16) {
            rays_->packets[i / 16].ray.tfar[i % 16] = rays_->t_far[i];
            rays_->packets[i / 16].hit.geomID[i % 16] = RTC_INVALID_GEOMETRY_ID;
        } else if (rays_->any_hit) {
            rays_->single_rays[i].tfar = rays_->t_far[i];
        } else {
            rays_->singles[i].ray.tfar = rays_->t_far[i];
            rays_->singles[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
        }
    }
}

std::uint32_t EmbreeQuery::primitive(std::size_t i) const {
    const bool packet = rays_->mode == EmbreeMode::packet16;
    if (rays_->any_hit)
        return (packet ? rays_->packets[i / 16].ray.tfar[i % 16] : rays_->single_rays[i].tfar) < 0 ? 0 : kNone;
    if (packet) {
        const RTCHit16& hit = rays_->packets[i / 16].hit;
        return hit.geomID[i % 16] == RTC_INVALID_GEOMETRY_ID ? kNone : hit.primID[i % 16];
    }
    const RTCHit& hit = rays_->singles[i].hit;
    return hit.geomID == RTC_INVALID_GEOMETRY_ID ? kNone : hit.primID;
}

float EmbreeQuery::t(std::size_t i) const {
    if (rays_->mode == EmbreeMode::packet16) return rays_->packets[i / 16].ray.tfar[i % 16];
    return rays_->any_hit ? rays_->single_rays[i].tfar : rays_->singles[i].ray.tfar;
}

EmbreeMode EmbreeQuery::mode() const {
    return rays_->mode;
}

struct EmbreeRival::Scene {
    RTCDevice device;
    RTCScene scene;
    std::atomic<std::int64_t> bytes{0};

    explicit Scene(int threads)
        : device(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())), scene(rtcNewScene(device)) {}
    ~Scene() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

std::unique_ptr<const EmbreeRival> EmbreeRival::build(const TriangleMesh& mesh, bool robust, int threads) {
    std::unique_ptr<EmbreeRival> rival(new EmbreeRival);
    rival->scene_ = std::make_unique<Scene>(threads);
    Scene& scene = *rival->scene_;
    rtcSetDeviceMemoryMonitorFunction(
        scene.device,
        [](void* bytes, ssize_t change, bool) {
            static_cast<std::atomic<std::int64_t>*>(bytes)->fetch_add(change);
            return true;
        },
        &scene.bytes);
    rtcSetSceneFlags(scene.scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    RTCGeometry geometry = rtcNewGeometry(scene.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (const Vec3& p : mesh.positions) positions = std::copy(&p.x, &p.x + 3, positions);
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (const glm::uvec3& t : mesh.triangles) indices = std::copy(&t.x, &t.x + 3, indices);
    const std::int64_t mesh_bytes = scene.bytes;
    const double cpu_start = process_cpu_seconds(), wall_start = wall_seconds();
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.scene);
    rival->build_cpu_seconds_ = process_cpu_seconds() - cpu_start;
    rival->build_wall_seconds_ = wall_seconds() - wall_start;
    rival->memory_bytes_ = static_cast<std::uint64_t>(scene.bytes - mesh_bytes);
    return rival;
}

void EmbreeRival::trace(EmbreeQuery& query, std::size_t begin, std::size_t end) const {
    EmbreeQuery::Rays& rays = query.rays();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = rays.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    RTCScene scene = scene_->scene;
    switch (rays.mode) {
        case EmbreeMode::single:
            for (std::size_t i = begin; i < end; ++i) {
                if (rays.any_hit) {
                    rtcOccluded1(scene, &context, &rays.single_rays[i]);
                } else {
                    rtcIntersect1(scene, &context, &rays.singles[i]);
                }
            }
            break;
        case EmbreeMode::packet16:
            for (std::size_t i = begin; i < end; i += 16) {
                alignas(64) int valid[16];
                for (std::size_t k = 0; k < 16; ++k) valid[k] = i + k < end ? -1 : 0;
                if (rays.any_hit) {
                    rtcOccluded16(valid, scene, &context, &rays.packets[i / 16].ray);
                } else {
                    rtcIntersect16(valid, scene, &context, &rays.packets[i / 16]);
                }
            }
            break;
        case EmbreeMode::stream: {
            constexpr std::size_t kStream = 1024;
            for (std::size_t i = begin; i < end; i += kStream) {
                const auto count = static_cast<unsigned>(std::min(kStream, end - i));
                if (rays.any_hit) {
                    rtcOccluded1M(scene, &context, &rays.single_rays[i], count, sizeof(RTCRay));
                } else {
                    rtcIntersect1M(scene, &context, &rays.singles[i], count, sizeof(RTCRayHit));
                }
            }
            break;
        }
    }
}

#else

struct EmbreeQuery::Rays {};
struct EmbreeRival::Scene {};
EmbreeQuery::EmbreeQuery(std::span<const Ray>, bool, EmbreeMode, bool) : rays_(new Rays) {}
void EmbreeQuery::reset() {}
std::uint32_t EmbreeQuery::primitive(std::size_t) const {
    return kNone;
}
float EmbreeQuery::t(std::size_t) const {
    return kInfinity;
}
EmbreeMode EmbreeQuery::mode() const {
    return EmbreeMode::single;
}
std::unique_ptr<const EmbreeRival> EmbreeRival::build(const TriangleMesh&, bool, int) {
    return nullptr;
}
void EmbreeRival::trace(EmbreeQuery&, std::size_t, std::size_t) const {}

#endif

EmbreeQuery::~EmbreeQuery() = default;
EmbreeQuery::EmbreeQuery(EmbreeQuery&&) noexcept = default;
EmbreeRival::EmbreeRival() = default;
EmbreeRival::~EmbreeRival() = default;

}  // namespace rayuela
