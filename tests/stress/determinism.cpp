#include "core/math/isa.h"
#include "core/render/render_session.h"
#include "tests/stress/paths.h"
#include "tests/support/random_edit.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <span>
#include <thread>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace rayuela::stress {
namespace {

using namespace rayuela::testing;
using namespace std::chrono_literals;

std::shared_ptr<const Frame> render_fresh(const Scene& scene) {
    RenderSession session({.threads = 2, .interactive = false});
    session.submit(std::make_shared<const Scene>(scene));
    return session.wait({});
}

bool is_settled(const RenderSession& session) {
    const SessionStatus status = session.status();
    return status.taken == status.submitted && status.phase == SessionPhase::finished;
}

/// Waits a minute at most; whether the session is settled.
bool settle(const RenderSession& session) {
    for (int i = 0; i < 60'000 && !is_settled(session); ++i) std::this_thread::sleep_for(1ms);
    return is_settled(session);
}

/// Submits `edits` random edits of the scene while it renders.
void edit_while_rendering(RenderSession& session, Scene& scene, int edits, std::mt19937& random) {
    for (int i = 0; i < edits; ++i) {
        const auto edited = rayuela::apply(scene, random_edit(scene, random));
        if (!edited) continue;
        scene = *edited;
        // A scene that only grows would be another test.
        if (scene.objects.size() > 24) scene.objects.resize(12);
        session.submit(std::make_shared<const Scene>(scene));
        if (random() % 3 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(random() % 10));
    }
}

/// Whatever was edited while rendering, the image is that of a fresh start on the final scene.
Outcome edit_storm(double scale) {
    constexpr int kEdits = 50;
    std::mt19937 random(20);
    Outcome outcome;
    for (std::uint64_t round = 0; round < scaled(1e4 / kEdits, scale, 2); ++round) {
        Scene scene = mixed_scene(64, 48);
        scene.render.max_samples = 2;
        RenderSession session({.threads = 2, .interactive = round % 2 == 0});
        session.submit(std::make_shared<const Scene>(scene));
        edit_while_rendering(session, scene, kEdits, random);
        outcome.expect(settle(session) && is_fresh(*session.frame(), *render_fresh(scene)),
                       [&] { return fmt::format("round {}", round); });
        outcome.cases += kEdits;
    }
    return outcome;
}

Outcome threads_and_order(double scale) {
    Scene scene = mixed_scene(128, 96);
    const auto expected = means(render(scene, 2)->film());
    std::mt19937 random(57);
    Outcome outcome;
    for (std::uint64_t run = 0; run < scaled(100, std::sqrt(scale), 4); ++run) {
        const int threads = run < 7 ? 1 << run : static_cast<int>(1 + random() % 64);
        outcome.expect(means(render(scene, 2, {}, threads)->film()) == expected,
                       [&] { return fmt::format("{} threads", threads); });
        ++outcome.cases;
    }
    return outcome;
}

std::uint64_t fnv1a(const std::vector<Vec3d>& values) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const std::byte byte : std::as_bytes(std::span(values))) {
        hash ^= static_cast<std::uint64_t>(byte);
        hash *= 0x100000001b3u;
    }
    return hash;
}

/// Each instruction set of this machine. The note is for the comparison of compilers: tests/stress/compilers.sh.
Outcome instruction_sets(double scale) {
    const int samples = static_cast<int>(scaled(64, scale, 2));
    const Scene scene = mixed_scene(128, 96);
    const int threads = tbb::this_task_arena::max_concurrency();
    const auto expected = means(render(scene, samples, {}, threads)->film());
    Outcome outcome;
    outcome.note = fmt::format("film of {} samples: {:016x}", samples, fnv1a(expected));
    for (const std::string_view set : rayuela::instruction_sets()) {
        use_instruction_set(set);
        outcome.expect(means(render(scene, samples, {}, threads)->film()) == expected,
                       [&] { return std::string(set); });
        ++outcome.cases;
    }
    use_instruction_set(rayuela::instruction_sets().front());
    return outcome;
}

/// Resident memory in bytes without what the allocator keeps for later; 0 where the system does not say.
double resident_bytes() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    std::ifstream statm("/proc/self/statm");
    double total = 0, resident = 0;
    statm >> total >> resident;
    return resident * 4096;
}

/// Figure: growth of resident memory from one half of the storm to the other, medians of readings of one finished image.
Outcome memory_under_edits(double scale) {
    constexpr int kReadings = 11;
#ifdef __GLIBC__
    // Large blocks go back to the system when they are freed, so that readings are not of holes between blocks.
    mallopt(M_MMAP_THRESHOLD, 1 << 17);
#endif
    const int edits = static_cast<int>(scaled(40'000, scale, 440));
    Scene start = mixed_scene(1280, 720);
    start.render.max_samples = 1;
    Scene scene = start;
    RenderSession session({.threads = 2, .interactive = true});
    std::mt19937 random(59);
    // First the allocator's pools grow to their size.
    edit_while_rendering(session, scene, edits / 4, random);
    std::array<double, 2> held{};
    for (double& half : held) {
        std::array<double, kReadings> readings;
        for (double& reading : readings) {
            edit_while_rendering(session, scene, edits * 3 / (8 * kReadings), random);
            session.submit(std::make_shared<const Scene>(start));
            settle(session);
            reading = resident_bytes();
        }
        std::ranges::nth_element(readings, readings.begin() + kReadings / 2);
        half = readings[kReadings / 2];
    }
    Outcome outcome;
    outcome.cases = static_cast<std::uint64_t>(edits);
    outcome.measure(held[0] > 0 ? std::max(0.0, held[1] / held[0] - 1) : 0);
    outcome.note = fmt::format("{:.2f} MB, then {:.2f} MB", held[0] / 1e6, held[1] / 1e6);
    return outcome;
}

/// A floor under a sphere lamp, whose radiance is known: RMSE of the pixels against it falls as 1 / sqrt(N).
Outcome convergence(double scale) {
    Scene scene = empty_scene(32, 32);
    scene.render.max_bounces = 1;
    scene.render.sampler = SamplerKind::independent;
    scene.camera.position = Vec3(3, 0.5f, 0);
    scene.camera.target = Vec3(0);
    scene.camera.vfov = 0.01f;
    add_object(scene, Plane{}, add_material(scene, Diffuse{{Color(0.6f), nullptr}}));
    add_object(scene, Sphere{Vec3(0, 3, -4), 1.5f}, add_material(scene, Emitter{.radiance = {Color(4), nullptr}}));
    const double expected = 0.6 * 4 * 0.09 * 0.6;  // L (r / d)^2 cos

    // Light found by scattering alone, for noise to be seen.
    const PathTracerOptions options{.light_sampling = false};
    const int largest = static_cast<int>(scaled(1 << 16, scale, 1 << 10));
    std::uint64_t paths = 0;
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    std::uint32_t seed = 0;
    for (int samples = 16; samples <= largest; samples *= 2) {
        // Films of their own, so that the points of the line are independent.
        scene.render.seed = ++seed;
        const auto film = render(scene, samples, options, tbb::this_task_arena::max_concurrency());
        double squares = 0;
        for (const Vec3d& mean : means(film->film())) squares += (mean.x - expected) * (mean.x - expected);
        const double x = std::log(samples), y = 0.5 * std::log(squares / (32 * 32));
        n += 1;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
        paths += 32 * 32 * static_cast<std::uint64_t>(samples);
    }
    Outcome outcome;
    outcome.cases = paths;
    outcome.measure(std::fabs((n * sxy - sx * sy) / (n * sxx - sx * sx) + 0.5));
    return outcome;
}

/// How often a scene with a plain mesh and a hidden textured one decodes the image or reads texture coordinates.
int reads_of_what_is_not_shown() {
    const auto reads = std::make_shared<int>(0);
    auto image = std::make_shared<Image>(Image{1, 1, {}, "image"});
    image->encoded = std::make_shared<const Lazy<Image>>([=] {
        ++*reads;
        return std::make_shared<const Image>(Image{1, 1, {Vec4(0.5f)}, "image"});
    });
    auto mesh = std::make_shared<TriangleMesh>(*torus_mesh());
    mesh->uvs_aside = std::make_shared<const Lazy<std::vector<Vec2>>>([reads, count = mesh->positions.size()] {
        ++*reads;
        return std::make_shared<const std::vector<Vec2>>(count);
    });
    Scene scene = empty_scene(32, 32);
    scene.render.max_samples = 2;
    add_object(scene, Mesh{"torus", mesh}, add_material(scene, Diffuse{}));
    add_object(scene, Mesh{"torus", mesh}, add_material(scene, Diffuse{{Color(1), image}}));
    scene.objects.back().visible = false;
    render_fresh(scene);
    const int hidden = *reads;
    scene.objects.back().visible = true;
    render_fresh(scene);
    return *reads == 2 ? hidden : -1;
}

/// What a scene does not have costs nothing, by the counters.
Outcome economy(double) {
    Outcome outcome;
    const auto expect = [&](bool holds, const char* what) {
        ++outcome.cases;
        outcome.expect(holds, [&] { return what; });
    };
    Scene scene = empty_scene(32, 32);
    scene.render.max_samples = 2;
    add_object(scene, Plane{}, add_material(scene, Diffuse{}));
    const auto black = render_fresh(scene)->statistics;
    expect(black.accel.references == 0 && black.accel.nodes <= 1, "a plane alone: no kd node");
    expect(black.rays == black.samples && black.shadow_rays == 0, "no light: only camera rays");
    scene.environment = ConstantEnvironment{Color(1)};
    const auto sky = render_fresh(scene)->statistics;
    expect(sky.shadow_rays == 0 && sky.rays > sky.samples, "a constant sky: no shadow ray");
    add_object(scene, Sphere{Vec3(0, 3, 0), 0.5f}, add_material(scene, Emitter{}));
    expect(render_fresh(scene)->statistics.shadow_rays > 0, "a lamp: shadow rays");
    std::get<Plane>(scene.objects[0].shape) = Plane{};
    scene.materials[0].material = Metal{};
    expect(render_fresh(scene)->statistics.shadow_rays == 0, "mirrors alone: no shadow ray");
    scene.render.max_bounces = 0;
    const auto direct = render_fresh(scene)->statistics;
    expect(direct.rays == direct.samples && direct.shadow_rays == 0, "no bounce: only camera rays");
    expect(!make_render_scene(scene)->features().textures && !make_render_scene(scene)->features().lens,
           "no texture, no lens");
    expect(reads_of_what_is_not_shown() == 0, "no textured object in sight: no image decoded, no uv in memory");
    return outcome;
}

}  // namespace

std::vector<StressTest> determinism_tests() {
    return {{20, "edits while rendering end in the image of a fresh start", "-", 0, edit_storm},
            {57, "1 to 64 threads: identical films", "-", 0, threads_and_order},
            {58, "instruction sets: identical films", "-", 0, instruction_sets},
            {59, "memory under edits", "growth", 0.01, memory_under_edits},
            {59, "error falls as N^-1/2", "|slope + 1/2|", 0.02, convergence},
            {60, "what a scene lacks costs nothing, by the counters", "-", 0, economy}};
}

}  // namespace rayuela::stress
