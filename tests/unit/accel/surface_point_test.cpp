#include "core/accel/surface_point.h"

#include "core/accel/traced_object.h"
#include "core/math/float_error.h"
#include "core/math/isa.h"
#include "tests/support/accel_scenes.h"
#include "tests/support/scalar_list.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>

namespace rayuela::test {
namespace {

SurfacePoint surface(const std::vector<GeometryInstance>& instances, const Ray& ray) {
    const auto list = scalar_list(instances);
    const Hit hit = intersect(*list, ray);
    EXPECT_TRUE(hit.valid());
    return surface_point(instances, ray, hit);
}

void expect_near(const Vec3& actual, const Vec3& expected, float tolerance = 1e-6f) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(actual[axis], expected[axis], tolerance) << "axis " << axis;
}

const Ray kDown{.origin = Vec3(0.25f, 5, 0.5f), .direction = Vec3(0, -1, 0)};

TEST(SurfacePoint, FrontsAreWhereTheShapesSay) {
    expect_near(surface({{Sphere{}, {}}}, kDown).ng, glm::normalize(Vec3(0.25f, std::sqrt(1 - 0.3125f), 0.5f)));
    expect_near(surface({{Box{}, {}}}, {.origin = Vec3(0.1f, 5, 0.2f), .direction = Vec3(0, -1, 0)}).ng, Vec3(0, 1, 0));
    expect_near(surface({{Plane{Vec3(0), Vec3(0, 3, 0)}, {}}}, kDown).ng, Vec3(0, 1, 0));
    expect_near(surface({{Plane{Vec3(0), Vec3(0, -3, 0)}, {}}}, kDown).ng, Vec3(0, -1, 0));
    const Quad floor{Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)};
    expect_near(surface({{floor, {}}}, kDown).ng, Vec3(0, 1, 0));
    const Triangle triangle{{Vec3(-1, 0, 2), Vec3(2, 0, 2), Vec3(0, 0, -2)}};
    expect_near(surface({{triangle, {}}}, kDown).ng, Vec3(0, 1, 0));
    const MeshPtr mesh = make_mesh({triangle.vertices.begin(), triangle.vertices.end()}, {{0, 1, 2}});
    expect_near(surface({{mesh, {}}}, kDown).ng, Vec3(0, 1, 0));
}

TEST(SurfacePoint, MirroringKeepsTheFrontOnTheObject) {
    Mat3 mirror(1);
    mirror[0][0] = -1;
    const Affine flip{mirror, Vec3(0)};
    const Triangle triangle{{Vec3(-2, 0, 2), Vec3(2, 0, 2), Vec3(0, 0, -2)}};
    const MeshPtr mesh = make_mesh({triangle.vertices.begin(), triangle.vertices.end()}, {{0, 1, 2}});
    const Quad floor{Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2)};
    for (const TracedShape& shape :
         {TracedShape(triangle), TracedShape(floor), TracedShape(mesh), TracedShape(Sphere{}),
          TracedShape(Box{Vec3(-1), Vec3(1)}), TracedShape(Plane{})}) {
        EXPECT_GT(surface({{shape, flip}}, kDown).ng.y, 0.5f) << "shape " << shape.index();
    }
}

TEST(SurfacePoint, NormalsFollowTheInverseTranspose) {
    Mat3 scale(1);
    scale[0][0] = 4;
    const SurfacePoint ellipsoid =
        surface({{Sphere{}, {scale, Vec3(0)}}}, {.origin = Vec3(2, 5, 0), .direction = Vec3(0, -1, 0)});
    // Gradient of (x / 4)^2 + y^2 + z^2 at x = 2.
    expect_near(ellipsoid.p, Vec3(2, std::sqrt(0.75f), 0));
    expect_near(ellipsoid.ng, glm::normalize(Vec3(2.0f / 16, std::sqrt(0.75f), 0)));
    const SurfacePoint slope = surface({{Plane{Vec3(0), Vec3(1, 1, 0)}, {scale, Vec3(0)}}}, kDown);
    expect_near(slope.ng, glm::normalize(Vec3(0.25f, 1, 0)));
}

TEST(SurfacePoint, MeshAttributesAreInterpolated) {
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->positions = {Vec3(0, 0, 0), Vec3(0, 0, 4), Vec3(4, 0, 0)};
    mesh->normals = {Vec3(0, 1, 0), glm::normalize(Vec3(0, 1, 1)), glm::normalize(Vec3(1, 1, 0))};
    mesh->uvs = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    mesh->triangles = {{0, 1, 2}};
    const SurfacePoint point = surface({{MeshPtr(mesh), {}}}, {.origin = Vec3(1, 3, 2), .direction = Vec3(0, -1, 0)});
    // Points keep off the edges by up to 72 roundings of their largest coordinate.
    expect_near(point.p, Vec3(1, 0, 2), 72 * kUnitRoundoff * 2);
    expect_near(point.ng, Vec3(0, 1, 0));
    const Vec3 expected = 0.25f * mesh->normals[0] + 0.5f * mesh->normals[1] + 0.25f * mesh->normals[2];
    expect_near(point.ns, glm::normalize(expected));
    EXPECT_NEAR(point.uv.x, 0.5f, 1e-6f);
    EXPECT_NEAR(point.uv.y, 0.25f, 1e-6f);
}

TEST(SurfacePoint, SphereUvIsLongitudeAndPolarAngle) {
    const auto uv = [](const Vec3& from, const Affine& to_world = {}) {
        return surface({{Sphere{}, to_world}}, {.origin = 5.0f * from, .direction = -from}).uv;
    };
    EXPECT_NEAR(uv(Vec3(1, 0, 0)).x, 0, 1e-6f);
    EXPECT_NEAR(uv(Vec3(1, 0, 0)).y, 0.5f, 1e-6f);
    EXPECT_NEAR(uv(Vec3(0, 0, -1)).x, 0.25f, 1e-6f);
    EXPECT_NEAR(uv(Vec3(0, 0, 1)).x, 0.75f, 1e-6f);
    EXPECT_NEAR(uv(Vec3(0, 1, 0)).y, 0, 1e-6f);
    // Rotated by 90 degrees about y, +x shows what +z showed.
    const Affine turned{Mat3(Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, 0, 0)), Vec3(0)};
    EXPECT_NEAR(uv(Vec3(1, 0, 0), turned).x, 0.75f, 1e-6f);
}

TEST(SurfacePoint, BoxPointLiesOnItsFaceBitForBit) {
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        Box box{random.in_cube(1000)};
        box.max = box.min + glm::abs(random.in_cube(1000));
        const std::vector<GeometryInstance> instances{{box, {}}};
        Ray ray{.origin = random.in_cube(3000)};
        ray.direction = 0.5f * (box.min + box.max) - ray.origin;
        const TracedObject object(instances[0]);
        ShapeHit hit;
        ASSERT_TRUE(intersect_shape(object, TracedRay{RayD(ray)}, {ray.t_min, ray.t_max}, hit));
        const SurfacePoint point = surface_point(instances, ray, {hit.t, 0, 0, 0, hit.primitive});
        const int axis = static_cast<int>(hit.primitive / 2);
        const float face = hit.primitive % 2 ? box.max[axis] : box.min[axis];
        ASSERT_EQ(std::bit_cast<std::uint32_t>(point.p[axis]), std::bit_cast<std::uint32_t>(face));
        ASSERT_TRUE(Bounds3({box.min, box.max}).contains(point.p));
    }
}

/// Any shape, anywhere up to 1e8, under any transform.
std::vector<GeometryInstance> random_object(Random& random) {
    const float scale = std::exp(random.uniform(std::log(1e-4f), std::log(1e4f)));
    const float away = std::exp(random.uniform(std::log(1e-2f), std::log(1e4f)));
    auto instances = make_scene(random.bits(), 1, 8);
    instances[0].to_world = Affine{Mat3(scale), random.in_cube(scale * away)} * instances[0].to_world;
    return instances;
}

bool is_flat(const TracedShape& shape) {
    return !std::holds_alternative<Sphere>(shape) && !std::holds_alternative<Box>(shape);
}

/// A ray that leaves a surface point does not meet the same surface again: pbrt's Reintersect test, for all shapes.
TEST(SurfacePoint, LeavingRaysDoNotMeetTheirOwnSurface) {
    Random random(2);
    int tested = 0;
    for (int i = 0; i < 40000; ++i) {
        const auto instances = random_object(random);
        const TracedObject object(instances[0]);
        Ray ray{.origin = instances[0].to_world.point(random.in_cube(6))};
        ray.direction =
            special_point(instances, random) - ray.origin + 1e-3f * (special_point(instances, random) - ray.origin);
        const auto list = scalar_list(instances);
        const Hit hit = intersect(*list, ray);
        if (!hit.valid()) continue;
        ++tested;
        const SurfacePoint point = surface_point(instances, ray, hit);
        ASSERT_TRUE(point.p_error.x > 0 && point.p_error.y > 0 && point.p_error.z > 0);
        ASSERT_NEAR(glm::length(point.ng), 1, 1e-6f);
        for (const float side : {1.0f, -1.0f}) {
            Vec3 w = random.direction();
            if (glm::dot(w, point.ng) * side < 0) w = -w;
            if (i % 4 == 0) w = glm::normalize(w - 0.9999f * glm::dot(w, point.ng) * point.ng);  // grazing
            if (glm::dot(w, point.ng) * side <= 0) continue;  // Rounding took the grazing ray to the other side.
            const Ray leaving{.origin = offset_ray_origin(point.p, point.p_error, point.ng, w), .direction = w};
            const Hit again = intersect(*list, leaving);
            if (is_flat(instances[0].shape)) {
                ASSERT_FALSE(again.valid() && again.primitive == hit.primitive)
                    << "shape " << instances[0].shape.index();
            } else if (side > 0) {
                ASSERT_FALSE(again.valid()) << "shape " << instances[0].shape.index() << " t " << again.t;
            } else if (std::holds_alternative<Box>(instances[0].shape)) {
                ASSERT_NE(again.primitive, hit.primitive) << "t " << again.t;
            }
        }
    }
    EXPECT_GT(tested, 10000);
}

/// Offsets are small enough not to jump over a second surface 64 ulp behind the first.
TEST(SurfacePoint, LeavingRaysFindASurfaceCloseBehind) {
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 at = random.direction() * std::exp(random.uniform(std::log(1e-3f), std::log(1e6f)));
        const float largest = max_component(glm::abs(at));
        const float gap = 64 * (next_up(largest) - largest);
        const float size = largest;
        const auto quad_at = [&](float y) {
            return Quad{Vec3(at.x - size, y, at.z + size), Vec3(2 * size, 0, 0), Vec3(0, 0, -2 * size)};
        };
        const std::vector<GeometryInstance> instances{{quad_at(at.y), {}}, {quad_at(at.y - gap), {}}};
        const auto list = scalar_list(instances);
        const Ray ray{.origin = at + Vec3(0, size, 0),
                      .direction = Vec3(random.uniform(-0.3f, 0.3f), -1, random.uniform(-0.3f, 0.3f))};
        const Hit first = intersect(*list, ray);
        ASSERT_EQ(first.object, 0u);
        const SurfacePoint point = surface_point(instances, ray, first);
        const Vec3 origin = offset_ray_origin(point.p, point.p_error, point.ng, ray.direction);
        ASSERT_EQ(intersect(*list, {.origin = origin, .direction = ray.direction}).object, 1u);
    }
}

/// All shapes and transforms, spheres of all sizes and distances among them; with texture coordinates, without, and mixed.
TEST(SurfacePoint, ManyAtOnceAreTheSameAsEachAlone) {
    std::vector<GeometryInstance> instances = make_scene(17, 60, 40);
    Random random(18);
    for (int i = 0; i < 40; ++i)
        instances.push_back({Sphere{random.in_cube(4), std::ldexp(1.0f, random.integer(-12, 2))}, {}});
    instances.push_back({Sphere{Vec3(0, -1e4f, 0), 1e4f - 3}, {}});
    const auto list = scalar_list(instances);
    std::vector<Ray> rays;
    for (int i = 0; i < 5000; ++i) rays.push_back(make_ray(instances, random));
    std::vector<Hit> hits(rays.size());
    list->intersect(rays, hits);
    std::vector<std::uint8_t> mixed;
    for (std::size_t i = 0; i < rays.size(); ++i) mixed.push_back(i % 3 == 0 ? 1 : 0);
    const Surfaces surfaces(instances);
    const auto same = [](const Vec3& a, const Vec3& b) {
        return std::bit_cast<std::array<std::uint32_t, 3>>(a) == std::bit_cast<std::array<std::uint32_t, 3>>(b);
    };
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        for (const auto& with_uv : {std::vector<std::uint8_t>(), std::vector<std::uint8_t>(rays.size(), 1), mixed}) {
            std::vector<SurfacePoint> points(rays.size());
            surfaces.points(rays, hits, with_uv, points);
            std::size_t spheres = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                if (!hits[i].valid()) continue;
                spheres += std::holds_alternative<Sphere>(instances[hits[i].object].shape);
                const bool uv = !with_uv.empty() && with_uv[i] != 0;
                const SurfacePoint expected = surfaces.point(rays[i], hits[i], uv), &actual = points[i];
                ASSERT_TRUE(same(expected.p, actual.p) && same(expected.p_error, actual.p_error) &&
                            same(expected.ng, actual.ng) && same(expected.ns, actual.ns))
                    << "ray " << i << ' ' << set;
                ASSERT_EQ(uv ? expected.uv : Vec2(0), uv ? actual.uv : Vec2(0)) << "ray " << i << ' ' << set;
            }
            ASSERT_GT(spheres, 1000u);
        }
    }
    use_instruction_set(instruction_sets().front());
}

/// Three corners of any size anywhere, some of them in a line or at one point.
std::array<Vec3, 3> any_corners(Random& random) {
    const Vec3 at = random.integer(0, 2) ? std::ldexp(1.0f, random.integer(-40, 40)) * random.in_cube(1) : Vec3(0);
    const float size = std::ldexp(1.0f, random.integer(-60, 40));
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) corner = at + size * random.in_cube(1);
    if (random.integer(0, 9) == 0) corners[2] = corners[0] + 0.5f * (corners[1] - corners[0]);
    if (random.integer(0, 9) == 0) corners[1] = corners[0];
    return corners;
}

/// A triangle, a quad, or a mesh of some triangles that may have normals, some of them 0, and texture coordinates.
TracedShape any_flat_shape(Random& random) {
    const auto corners = any_corners(random);
    switch (random.integer(0, 2)) {
        case 0:
            return Triangle{corners};
        case 1:
            return Quad{corners[0], corners[1] - corners[0], corners[2] - corners[0]};
        default:
            break;
    }
    TriangleMesh mesh;
    const bool normals = random.integer(0, 1), uvs = random.integer(0, 1);
    for (std::uint32_t i = 0; i < 10; ++i) {
        for (const Vec3& corner : any_corners(random)) {
            mesh.positions.push_back(corner);
            if (normals) mesh.normals.push_back(random.integer(0, 5) ? random.direction() : Vec3(0));
            if (uvs) mesh.uvs.emplace_back(random.uniform(0, 1), random.uniform(0, 1));
        }
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// Bits, but any NaN is like any other: triangles without area have no normal, and no ray meets them.
bool same_numbers(const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) {
        const bool nan = std::isnan(a[axis]) && std::isnan(b[axis]);
        if (!nan && std::bit_cast<std::uint32_t>(a[axis]) != std::bit_cast<std::uint32_t>(b[axis])) return false;
    }
    return true;
}

TEST(SurfacePoint, ManyOnFlatShapesAreTheSameAsEachAlone) {
    Random random(19);
    std::vector<GeometryInstance> instances;
    for (int i = 0; i < 300; ++i) {
        Affine to_world;
        if (random.integer(0, 1)) {
            to_world.translation = random.in_cube(10);
            for (int axis = 0; axis < 3; ++axis) to_world.linear[axis] = random.in_cube(2);  // Half of them mirror.
        }
        instances.push_back({any_flat_shape(random), to_world});
    }
    const Surfaces surfaces(instances);
    std::vector<Hit> hits(3001);
    std::vector<std::uint8_t> with_uv;
    for (Hit& hit : hits) {
        const float u = random.uniform(0, 1);
        hit = {.t = 1, .u = u, .v = random.uniform(0, 1 - u), .object = kNone, .primitive = 0};
        if (random.integer(0, 9)) hit.object = static_cast<std::uint32_t>(random.integer(0, 299));
        if (hit.valid() && instances[hit.object].shape.index() == 5)
            hit.primitive = static_cast<std::uint32_t>(random.integer(0, 9));
        with_uv.push_back(static_cast<std::uint8_t>(random.integer(0, 1)));
    }
    const std::vector<Ray> rays(hits.size());
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        std::vector<SurfacePoint> points(rays.size());
        surfaces.points(rays, hits, with_uv, points);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (!hits[i].valid()) continue;
            const SurfacePoint expected = surfaces.point(rays[i], hits[i], with_uv[i] != 0), &actual = points[i];
            ASSERT_TRUE(same_numbers(expected.p, actual.p) && same_numbers(expected.p_error, actual.p_error) &&
                        same_numbers(expected.ng, actual.ng) && same_numbers(expected.ns, actual.ns))
                << "hit " << i << ' ' << set;
            ASSERT_EQ(expected.uv, actual.uv) << "hit " << i << ' ' << set;
        }
    }
    use_instruction_set(instruction_sets().front());
}

}  // namespace
}  // namespace rayuela::test
