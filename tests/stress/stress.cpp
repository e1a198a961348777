#include "tests/stress/stress.h"

#include <fmt/format.h>

namespace rayuela::stress {

void Outcome::add(const Outcome& later) {
    if (failures == 0) failure = later.failure;
    if (note.empty()) note = later.note;
    cases += later.cases;
    failures += later.failures;
    measure(later.worst);
}

std::string describe(const Vec3& v) {
    return fmt::format("({:.9g} {:.9g} {:.9g})", v.x, v.y, v.z);
}

std::string describe(const Ray& ray) {
    return fmt::format("ray from {} along {} in [{:.9g}, {:.9g}]", describe(ray.origin), describe(ray.direction),
                       ray.t_min, ray.t_max);
}

std::vector<StressTest> stress_tests() {
    std::vector<StressTest> all;
    for (const auto& list :
         {sphere_tests, flat_shape_tests, watertight_tests, kd_build_tests, kd_invariant_tests, padding_tests,
          traversal_tests, offset_tests, light_leak_tests, sampling_tests, bsdf_tests, radiometry_tests, film_tests,
          adaptive_tests, camera_scale_tests, file_tests, determinism_tests}) {
        const std::vector<StressTest> tests = list();
        all.insert(all.end(), tests.begin(), tests.end());
    }
    std::ranges::stable_sort(all, {}, &StressTest::number);
    return all;
}

}  // namespace rayuela::stress
