#include "core/lights/light_table.h"

#include "core/accel/surface_point.h"
#include "core/materials/bsdf.h"
#include "core/math/basis.h"
#include "core/math/sampler.h"
#include "core/math/sampling.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayuela {
namespace {

Material lamp(const Color& radiance = Color(1), bool two_sided = false) {
    return Emitter{{radiance, nullptr}, two_sided};
}

/// A gradient from black to its value in one direction each in red and green.
std::shared_ptr<const Image> gradient() {
    Image image{8, 8, {}, ""};
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) image.pixels.emplace_back((x + 1) / 8.0f, (y + 1) / 8.0f, 1, 1);
    }
    return std::make_shared<const Image>(std::move(image));
}

std::shared_ptr<const TriangleMesh> tetrahedron() {
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    mesh->uvs = {{0.1f, 0.2f}, {0.9f, 0.3f}, {0.4f, 0.8f}, {0.6f, 0.6f}};
    mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (const Vec3& p : mesh->positions) mesh->bounds.extend(p);
    return mesh;
}

/// One light and its world.
struct World {
    std::string name;
    std::vector<GeometryInstance> instances;
    std::vector<Material> materials;
    std::shared_ptr<const Accelerator> accelerator;
    LightTable table;

    World(std::string name_, std::vector<GeometryInstance> instances_, std::vector<Material> materials_,
          const Environment& environment = NoEnvironment{})
        : name(std::move(name_)), instances(std::move(instances_)), materials(std::move(materials_)) {
        BuildControl control;
        accelerator = Accelerator::build(instances, {.kind = AcceleratorKind::list}, nullptr, control);
        std::vector<const Material*> pointers;
        for (const Material& m : materials) pointers.push_back(&m);
        table = LightTable(instances, pointers, environment);
    }

    Hit intersect(const Ray& ray) const {
        Hit hit;
        accelerator->intersect({&ray, 1}, {&hit, 1});
        return hit;
    }
    bool occluded(const Ray& ray) const {
        std::uint8_t blocked = 0;
        accelerator->occluded({&ray, 1}, {&blocked, 1});
        return blocked != 0;
    }
    float pdf(const Vec3& p, const Vec3& wi) const {
        const Ray ray{p, 0, wi, kInfinity};
        const Hit hit = intersect(ray);
        if (!hit.valid()) return table.environment_pdf(wi);
        const SurfacePoint point = surface_point(instances, ray, hit);
        return table.pdf({p}, wi, hit, point.p, point.ng);
    }
};

Affine placed(const Vec3& translate, float degrees, const Vec3& scale) {
    Transform t;
    t.translate = translate;
    t.rotate = glm::angleAxis(glm::radians(degrees), glm::normalize(Vec3(1, 2, 0.5f)));
    t.scale = scale;
    return t.affine();
}

/// Each shape that can be a light, plain and transformed (mirrored as well), even and textured.
std::vector<World> worlds() {
    const Triangle triangle{{Vec3(-1, 0, 0), Vec3(1, 0, 0.2f), Vec3(0, 1.5f, 0)}};
    const Quad quad{Vec3(-1, -1, 0), Vec3(2, 0, 0.3f), Vec3(0.4f, 2, 0)};
    const Box box{Vec3(-0.5f, -0.7f, -0.2f), Vec3(0.5f, 0.7f, 0.9f)};
    const std::vector<std::pair<std::string, TracedShape>> shapes{{"sphere", Sphere{Vec3(0.1f, 0, 0), 0.8f}},
                                                                  {"box", box},
                                                                  {"triangle", triangle},
                                                                  {"quad", quad},
                                                                  {"mesh", tetrahedron()}};
    std::vector<World> result;
    for (const auto& [name, shape] : shapes) {
        for (const bool textured : {false, true}) {
            const Emitter emitter{{Color(2, 3, 4), textured ? gradient() : nullptr},
                                  !std::holds_alternative<Sphere>(shape) && textured};
            const bool sphere = std::holds_alternative<Sphere>(shape);
            const Vec3 scale = sphere ? Vec3(1.5f) : Vec3(1.2f, 0.7f, 1.6f);
            const Vec3 mirror = sphere ? Vec3(-0.9f) : Vec3(-1.2f, 0.7f, 1.1f);
            const std::string kind = name + (textured ? " textured" : "");
            result.emplace_back(kind, std::vector{GeometryInstance{shape, {}}}, std::vector<Material>{emitter});
            result.emplace_back(kind + " placed",
                                std::vector{GeometryInstance{shape, placed(Vec3(0.2f, 0.1f, 0), 50, scale)}},
                                std::vector<Material>{emitter});
            result.emplace_back(kind + " mirrored", std::vector{GeometryInstance{shape, placed(Vec3(0), 20, mirror)}},
                                std::vector<Material>{emitter});
        }
    }
    return result;
}

const Vec3 kViewpoints[] = {{0.3f, 0.4f, 3}, {2, -1, -2}, {-2.5f, 0.5f, 0.7f}};

TEST(LightTable, SamplesAgreeWithWhatARayFinds) {
    for (const World& world : worlds()) {
        ASSERT_FALSE(world.table.empty()) << world.name;
        int found = 0;
        for (const Vec3& p : kViewpoints) {
            for (std::uint32_t i = 0; i < 300; ++i) {
                const Sampler sampler(SamplerKind::sobol, 0, 0, i);
                const auto s = world.table.sample({p}, sampler.get_2d(1));
                if (!s) continue;
                ++found;
                ASSERT_NEAR(glm::length(s->wi), 1, 1e-6) << world.name;
                const Ray ray{p, 0, s->wi, kInfinity};
                const Hit hit = world.intersect(ray);
                if (!hit.valid()) continue;                           // grazing past the edge
                if (std::abs(hit.t - s->distance) > 1e-5f) continue;  // another face in front
                const SurfacePoint point = surface_point(world.instances, ray, hit);
                const Vec2 seam = glm::abs(point.uv - glm::round(point.uv));
                if (glm::min(seam.x, seam.y) < 1e-4f) continue;  // where the texture repeats, rounding chooses the side
                const bool front = glm::dot(s->wi, point.ng) < 0;
                ASSERT_LT(glm::length(emitted(world.materials[0], point.uv, front) - s->radiance), 0.02f) << world.name;
                if (std::abs(glm::dot(s->wi, point.ng)) > 0.02f) {
                    const float pdf = world.table.pdf({p}, s->wi, hit, point.p, point.ng);
                    ASSERT_NEAR(pdf / s->pdf, 1, 1e-3) << world.name;
                }
                ASSERT_FALSE(world.occluded(shadow_ray(p, *s))) << world.name << " shadows itself, " << i;
            }
        }
        EXPECT_GT(found, 100) << world.name;
    }
}

TEST(LightTable, DensityIntegratesToTheChanceOfASample) {
    for (const World& world : worlds()) {
        for (const Vec3& p : kViewpoints) {
            test::Moments integral, drawn;
            for (std::uint32_t i = 0; i < 8192; ++i) {
                const Sampler sampler(SamplerKind::independent, 1, 0, i);
                // In a cone that holds the whole light.
                const float one_minus_cos = 1 - std::cos(1.3f);
                const Vec3 wi =
                    Basis(-glm::normalize(p)).to_world(sample_uniform_cone(sampler.get_2d(2), one_minus_cos));
                integral.add(double(world.pdf(p, wi)) / uniform_cone_pdf(one_minus_cos));
                const auto s = world.table.sample({p}, sampler.get_2d(1));
                // Of surfaces that hide each other only the first is found by a ray.
                const bool visible = s && std::abs(world.intersect({p, 0, s->wi, kInfinity}).t - s->distance) < 1e-3f;
                drawn.add(visible ? 1 : 0);
            }
            EXPECT_NEAR(integral.mean(), drawn.mean(), 5 * (integral.error() + drawn.error()) + 1e-3) << world.name;
        }
    }
}

/// Irradiance at p on a surface of normal n by sampling the lights, for all directions and for those of n in turn.
double irradiance(const World& world, const Vec3& p, const Vec3& n, std::uint32_t samples = 4096) {
    double sum = 0;
    const auto add = [&](const std::optional<LightSample>& s) {
        if (!s || world.occluded(shadow_ray(p, *s))) return;
        sum += s->radiance.x * std::max(0.0f, glm::dot(n, s->wi)) / s->pdf;
    };
    for (std::uint32_t i = 0; i < samples; ++i) {
        const Sampler sampler(SamplerKind::sobol, 7, 0, i);
        add(world.table.sample({p}, sampler.get_2d(1)));
        add(world.table.sample({p, n}, sampler.get_2d(2)));
    }
    return sum / (2 * samples);
}

TEST(LightTable, SphereOverAPlane) {
    // E = pi L (r / d)^2 cos(theta) while the sphere is above the horizon.
    for (const auto& [radius, center] : {std::pair{1.0f, Vec3(0, 0, 3)}, std::pair{0.01f, Vec3(2, 1, 4)},
                                         std::pair{1.9f, Vec3(0.1f, 0, 2)}, std::pair{1e-4f, Vec3(0, 30, 40)}}) {
        const World world("sphere", {{Sphere{center, radius}, {}}}, {lamp(Color(5))});
        const double d = glm::length(center);
        const double expected = std::numbers::pi * 5 * std::pow(radius / d, 2) * center.z / d;
        EXPECT_NEAR(irradiance(world, Vec3(0), Vec3(0, 0, 1)) / expected, 1, 2e-3) << radius;
    }
}

/// Lambert's formula for the irradiance of a polygon of radiance 1 (counter-clockwise seen from p), above the horizon.
double polygon_irradiance(const Vec3d& p, const Vec3d& n, const std::vector<Vec3d>& vertices) {
    double sum = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d a = glm::normalize(vertices[i] - p), b = glm::normalize(vertices[(i + 1) % vertices.size()] - p);
        sum += std::acos(glm::dot(a, b)) * glm::dot(n, glm::normalize(glm::cross(a, b)));
    }
    return std::abs(sum) / 2;
}

TEST(LightTable, QuadOverAPlane) {
    // The corner above the point: form factor of a differential element to a parallel rectangle.
    const Quad quad{Vec3(0, 0, 2), Vec3(0, 3, 0), Vec3(1.5f, 0, 0)};  // faces -z
    const World world("quad", {{quad, {}}}, {lamp(Color(7))});
    const double a = 1.5 / 2, b = 3.0 / 2, ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    const double form = (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * std::numbers::pi);
    EXPECT_NEAR(irradiance(world, Vec3(0), Vec3(0, 0, 1)) / (7 * std::numbers::pi * form), 1, 2e-3);
    EXPECT_NEAR(polygon_irradiance({0, 0, 0}, {0, 0, 1}, {{0, 0, 2}, {0, 3, 2}, {1.5, 3, 2}, {1.5, 0, 2}}),
                std::numbers::pi * form, 1e-9);
    EXPECT_EQ(irradiance(world, Vec3(0, 0, 4), Vec3(0, 0, -1)), 0) << "nothing from its back";
}

TEST(LightTable, TriangleMeshAndBox) {
    const World triangle("triangle", {{Triangle{{Vec3(-1, 0, 2), Vec3(0, 2, 2), Vec3(2, 0, 3)}}, {}}}, {lamp()});
    EXPECT_NEAR(irradiance(triangle, Vec3(0), Vec3(0, 0, 1)) /
                    polygon_irradiance({0, 0, 0}, {0, 0, 1}, {{-1, 0, 2}, {0, 2, 2}, {2, 0, 3}}),
                1, 3e-3);
    // Seen from below, only the lower face of this box shines: its others are hidden behind it.
    const World box("box", {{Box{Vec3(-0.5f, -0.5f, 2), Vec3(0.5f, 0.5f, 3)}, {}}}, {lamp()});
    EXPECT_NEAR(irradiance(box, Vec3(0), Vec3(0, 0, 1), 16384) /
                    polygon_irradiance({0, 0, 0}, {0, 0, 1}, {{-.5, -.5, 2}, {-.5, .5, 2}, {.5, .5, 2}, {.5, -.5, 2}}),
                1, 3e-3);
    // A tetrahedron: the sum over the faces that look at the point.
    const auto mesh = tetrahedron();
    const World solid("mesh", {{mesh, {}}}, {lamp()});
    const Vec3d p(0.2, 0.3, 4), n = glm::normalize(-p);
    double expected = 0;
    for (const glm::uvec3& t : mesh->triangles) {
        const Vec3d a(mesh->positions[t.x]), b(mesh->positions[t.y]), c(mesh->positions[t.z]);
        if (glm::dot(glm::cross(b - a, c - a), p - a) > 0) expected += polygon_irradiance(p, n, {a, b, c});
    }
    EXPECT_NEAR(irradiance(solid, Vec3(p), Vec3(n), 65536) / expected, 1, 4e-3);
}

TEST(LightTable, InsideATwoSidedSphereEverythingShines) {
    const World world("inside", {{Sphere{Vec3(0), 2}, {}}}, {lamp(Color(3), true)});
    // Half of the directions: E = pi L, wherever the point is.
    EXPECT_NEAR(irradiance(world, Vec3(0.5f, 0.2f, 0), Vec3(0, 0, 1), 16384) / (3 * std::numbers::pi), 1, 5e-3);
    const World one_sided("outside", {{Sphere{Vec3(0), 2}, {}}}, {lamp(Color(3))});
    EXPECT_FALSE(one_sided.table.sample({Vec3(0.5f, 0, 0)}, Vec2(0.4f)));
}

TEST(LightTable, SphereConeDensityAgainstLongDouble) {
    for (const float radius : {1e-6f, 1e-3f, 0.5f, 0.99f, 0.999999f}) {
        for (const float distance : {1.0f, 1e3f}) {
            const World world("sphere", {{Sphere{Vec3(0, 0, distance), radius * distance}, {}}}, {lamp()});
            const auto s = world.table.sample({Vec3(0)}, Vec2(0.3f, 0.6f));
            ASSERT_TRUE(s);
            const long double sine = static_cast<long double>(radius * distance) / distance;
            const long double cosine = std::sqrt(1 - sine * sine);
            const long double exact = 1 / (2 * std::numbers::pi_v<long double> * (sine * sine / (1 + cosine)));
            EXPECT_NEAR(static_cast<double>(s->pdf / exact), 1, 1e-5) << radius;
        }
    }
}

TEST(LightTable, SelectionFollowsPower) {
    const Sphere small{Vec3(-3, 0, 0), 0.5f}, big{Vec3(3, 0, 0), 1.5f};
    const World world("two", {{small, {}}, {Plane{}, {}}, {big, {}}}, {lamp(Color(9)), Diffuse{}, lamp(Color(3))});
    EXPECT_EQ(world.table.size(), 2u);
    int small_count = 0;
    constexpr std::uint32_t kCount = 4096;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const Sampler sampler(SamplerKind::sobol, 0, 0, i);
        const auto s = world.table.sample({Vec3(0)}, sampler.get_2d(1));
        ASSERT_TRUE(s);
        small_count += s->wi.x < 0;
    }
    // Powers 9 * 0.25 and 3 * 2.25.
    EXPECT_NEAR(small_count / double(kCount), 0.25, 1e-3);
}

TEST(LightTable, WhatCannotBeSampledIsLeftOut) {
    const Affine squash = placed(Vec3(0), 0, Vec3(1, 2, 1));
    const World world("none",
                      {{Plane{}, {}}, {Sphere{}, squash}, {Sphere{}, {}}, {Triangle{{Vec3(0), Vec3(0), Vec3(1)}}, {}}},
                      {lamp(), lamp(), lamp(Color(0)), lamp()}, ConstantEnvironment{});
    EXPECT_TRUE(world.table.empty());
    EXPECT_EQ(world.table.size(), 0u);
    EXPECT_EQ(world.table.memory_bytes(), 0u);
    EXPECT_EQ(world.pdf(Vec3(0, 5, 0), Vec3(0, -1, 0)), 0);
    EXPECT_EQ(world.table.environment_pdf(Vec3(0, 1, 0)), 0);
    EXPECT_TRUE(LightTable().empty());
}

TEST(LightTable, EmissivePrincipledIsALight) {
    Principled glowing;
    glowing.emissive.value = Color(1);
    glowing.emissive_strength = 2;
    const World world("principled", {{Sphere{Vec3(0, 0, 3), 1}, {}}}, {glowing});
    EXPECT_NEAR(irradiance(world, Vec3(0), Vec3(0, 0, 1)) / (2 * std::numbers::pi / 9), 1, 1e-3);
}

TEST(LightTable, ExtremeInputGivesFiniteSamplesOrNothing) {
    const float edges[] = {0, 0x1p-32f, 0.5f, 1 - 0x1p-24f};
    for (const World& world : worlds()) {
        for (const Vec3& p :
             {Vec3(0), Vec3(0.9f, 0, 0), Vec3(1e6f, 0, 0), Vec3(-1, -1, 0), Vec3(1e-20f), Vec3(0.1f, 0, 0.8f)}) {
            for (const float x : edges) {
                for (const float y : edges) {
                    const auto s = world.table.sample({p}, Vec2(x, y));
                    if (!s) continue;
                    ASSERT_TRUE(is_finite(s->wi) && is_finite(s->target) && is_finite(s->radiance)) << world.name;
                    ASSERT_TRUE(s->pdf > 0 && std::isfinite(s->pdf)) << world.name;
                }
            }
        }
    }
}

TEST(LightTable, ShadowRaysNearAndFarReachTheirLight) {
    // Lights from 1e-6 to 1e6 away, at the origin and far from it: no light shadows itself.
    int blocked = 0, tested = 0;
    for (int exponent = -6; exponent <= 6; ++exponent) {
        const float distance = std::pow(10.0f, static_cast<float>(exponent));
        for (const Vec3& centre : {Vec3(0), Vec3(3, -2, 1) * distance, Vec3(100, 20, -50) * distance}) {
            for (const TracedShape& shape :
                 {TracedShape(Sphere{Vec3(0), 0.3f}),
                  TracedShape(Quad{Vec3(-0.5f), Vec3(0.2f, 0, 0), Vec3(0, 0.3f, 0.1f)}), TracedShape(tetrahedron())}) {
                Affine to_world{Mat3(0.2f * distance), centre};
                const World world("light", {{shape, to_world}}, {lamp(Color(1), true)});
                for (std::uint32_t i = 0; i < 200; ++i) {
                    const Sampler sampler(SamplerKind::independent, 3, static_cast<std::uint32_t>(exponent + 6), i);
                    const Vec3 p = centre + distance * sample_uniform_sphere(sampler.get_2d(0));
                    const auto s = world.table.sample({p}, sampler.get_2d(2));
                    if (!s) continue;
                    // Of a closed mesh that shines from both sides the far faces are hidden.
                    const float t = world.intersect({p, 0, s->wi, kInfinity}).t;
                    if (t < 0.99999f * s->distance) continue;
                    ++tested;
                    blocked += world.occluded(shadow_ray(p, *s));
                }
            }
        }
    }
    EXPECT_GT(tested, 10'000);
    EXPECT_EQ(blocked, 0);
}

}  // namespace
}  // namespace rayuela
