#include "core/lights/light_table.h"
#include "core/math/isa.h"
#include "tests/support/accel_scenes.h"

#include <gtest/gtest.h>

// Light samples of many points at once and one by one: two programs for the same thing, and every bit must agree.

namespace rayuela {
namespace {

using test::Random;

struct Lamps {
    std::vector<GeometryInstance> instances;
    std::vector<Material> materials;

    void add(const TracedShape& shape, Random& random, bool two_sided) {
        instances.push_back({shape, {}});
        materials.push_back(Emitter{{Color(random.uniform(0.1f, 9), random.uniform(), 1), nullptr}, two_sided});
    }
    LightTable table() const {
        std::vector<const Material*> pointers;
        for (const Material& material : materials) pointers.push_back(&material);
        return {instances, pointers, NoEnvironment{}};
    }
};

Lamps random_lamps(int count, Random& random) {
    Lamps lamps;
    for (int i = 0; i < count; ++i) {
        const Vec3 at = random.in_cube(4);
        const bool two_sided = random.integer(0, 1) == 1;
        switch (random.integer(0, 4)) {
            case 0:
                lamps.add(Triangle{{at, at + random.in_cube(), at + random.in_cube()}}, random, two_sided);
                break;
            case 1:
                lamps.add(Quad{at, random.in_cube(), random.in_cube()}, random, two_sided);
                break;
            case 2: {
                const Mat3 turn = random.rotation();
                lamps.add(Quad{at, random.uniform(0.01f, 2) * turn[0], random.uniform(0.01f, 2) * turn[1]}, random,
                          two_sided);
                break;
            }
            default:
                lamps.add(Sphere{at, std::exp2(random.uniform(-12, 2))}, random, two_sided);
        }
    }
    return lamps;
}

/// Anywhere, close to a lamp, within one; facing some way or none.
LightReceiver random_receiver(const Lamps& lamps, Random& random) {
    LightReceiver receiver{random.in_cube(6), random.integer(0, 3) == 0 ? Vec3(0) : random.direction()};
    const auto& shape =
        lamps.instances[static_cast<std::size_t>(random.integer(0, static_cast<int>(lamps.instances.size()) - 1))]
            .shape;
    const auto* sphere = std::get_if<Sphere>(&shape);
    if (const auto* quad = std::get_if<Quad>(&shape); quad && random.integer(0, 1) == 0)
        receiver.p = quad->point + 0.5f * (quad->u + quad->v) + std::exp2(random.uniform(-3, 2)) * random.direction();
    if (const auto* triangle = std::get_if<Triangle>(&shape); triangle && random.integer(0, 1) == 0) {
        const auto& c = triangle->vertices;
        receiver.p = (c[0] + c[1] + c[2]) / 3.0f + std::exp2(random.uniform(-3, 2)) * random.direction();
    }
    if (sphere && random.integer(0, 1) == 0)
        receiver.p = sphere->center + sphere->radius * std::exp2(random.uniform(-3, 3)) * random.direction();
    return receiver;
}

void expect_same(const Lamps& lamps, std::size_t size, Random& random) {
    const LightTable table = lamps.table();
    LightBlock block{};
    block.size = size;
    for (std::size_t i = 0; i < size; ++i) {
        block.put_receiver(i, random_receiver(lamps, random));
        block.u[i] = random.uniform();
        block.v[i] = random.uniform();
    }
    table.sample(block);
    for (std::size_t i = 0; i < size; ++i) {
        const auto expected = table.sample(block.receiver(i), {block.u[i], block.v[i]});
        ASSERT_EQ(block.pdf[i] > 0, expected.has_value()) << i;
        if (!expected) continue;
        const LightSample sample = block.sample(i);
        EXPECT_EQ(sample.wi, expected->wi);
        EXPECT_EQ(sample.target, expected->target);
        EXPECT_EQ(sample.radiance, expected->radiance);
        EXPECT_EQ(sample.distance, expected->distance);
        EXPECT_EQ(sample.pdf, expected->pdf);
    }
}

TEST(LightBlock, SamplesAsOneByOneOnEachInstructionSet) {
    for (const std::string_view set : instruction_sets()) {
        use_instruction_set(set);
        Random random(9);
        for (int round = 0; round < 200; ++round) {
            const int lamps = 1 + round % 10;  // Few, and more than few.
            const auto size = static_cast<std::size_t>(random.integer(1, LightBlock::kSize));
            expect_same(random_lamps(lamps, random), size, random);
        }
    }
    use_instruction_set(instruction_sets().front());
}

}  // namespace
}  // namespace rayuela
