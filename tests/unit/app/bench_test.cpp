#include "app/bench_file_mesh.h"
#include "app/contestant.h"
#include "app/count_text.h"
#include "app/median_ratio.h"
#include "app/scaling.h"
#include "app/text_table.h"

#include <gtest/gtest.h>

namespace rayuela::test {
namespace {

TEST(MedianRatio, ComparesRoundByRound) {
    // The second round was slow for both: of the medians 30 / 10 would come, of the rounds 2.
    const std::vector<double> above{20, 200, 30}, below{10, 100, 10};
    const Measured ratio = median_ratio(above, below);
    EXPECT_EQ(ratio.value, 2);
    EXPECT_EQ(ratio.interval.low, 2);
    EXPECT_EQ(ratio.interval.high, 3);
}

TEST(Contestant, SpeedsAreOfTheRaysEachAnswers) {
    const Contestant many{"many", {}, {}, 2'000'000, {2, 4, 1}}, few{"few", {}, {}, 1000, {0.1, 0.1, 0.1}};
    EXPECT_DOUBLE_EQ(mrays_per_second(many).value, 1);
    EXPECT_DOUBLE_EQ(nanoseconds_a_ray(many).value, 1000);
    EXPECT_DOUBLE_EQ(nanoseconds_a_ray(few).value, 1e5);
    EXPECT_DOUBLE_EQ(speed_ratio(many, few).value, 100);
}

TEST(Contestant, TheRoundThatWarmsUpDoesNotCount) {
    static double now = 0;
    double cost = 100;
    std::vector<Contestant> contestants{{"one", [] { now += 7; }, [&] { now += cost, cost = 1; }, 1}};
    compete(contestants, 3, [] { return now; });
    EXPECT_EQ(contestants[0].seconds, (std::vector<double>{1, 1, 1}));
}

TEST(Scaling, SpeedUpsAreOverTheFirstRunOfTheSame) {
    const std::vector<ScalingRun> runs{{"build", "kd", 1, 100, {4, 8, 6}},
                                       {"build", "Embree", 1, 100, {3, 3, 3}},
                                       {"rays", "kd", 1, 50, {10, 10, 10}},
                                       {"build", "kd", 2, 100, {2, 4, 3}},
                                       {"rays", "kd", 4, 50, {2.5, 2.5, 2.5}}};
    const auto figures = scaling_figures(runs);
    ASSERT_EQ(figures.size(), runs.size());
    EXPECT_EQ(figures[0].seconds, 6);
    EXPECT_EQ(figures[0].speed_up.value, 1);
    EXPECT_EQ(figures[3].speed_up.value, 2);
    EXPECT_DOUBLE_EQ(figures[3].speed, 100.0 / 3);
    EXPECT_EQ(figures[4].threads, 4);
    EXPECT_EQ(figures[4].speed_up.value, 4);
}

TEST(CountText, ReadsWhatPeopleWrite) {
    EXPECT_EQ(parse_count("700"), 700u);
    EXPECT_EQ(parse_count("10k"), 10'000u);
    EXPECT_EQ(parse_count("6M"), 6'000'000u);
    for (const char* wrong : {"", "k", "0", "0M", "-3", "1.5M", "10K", "7kM", "99999999999999999999", "2000M"})
        EXPECT_FALSE(parse_count(wrong)) << wrong;
}

TEST(TextTable, ColumnsAreAsWideAsTheyNeed) {
    TextTable table(1, {"who", "s"});
    table.add({"kd", "10.5"});
    EXPECT_EQ(table.text(), "who     s\n---------\nkd   10.5\n");
}

TEST(TextTable, NumbersKeepTwoDigits) {
    EXPECT_EQ(short_number(12.345), "12.35");
    EXPECT_EQ(short_number(0.1), "0.10");
    EXPECT_EQ(short_number(0.00123), "0.0012");
    EXPECT_EQ(short_number(0), "0");
    EXPECT_EQ(interval_text({0.02, 3}), "0.02 - 3.00");
}

TEST(BenchLand, HasAboutSoManyTriangles) {
    for (const std::size_t count : {1u, 1'000u, 20'000u}) {
        const auto mesh = bench_land("land", count).make();
        EXPECT_GE(mesh->triangles.size(), count * 95 / 100);
        EXPECT_LE(mesh->triangles.size(), std::max<std::size_t>(2, count * 105 / 100));
    }
}

double volume_of(const TriangleMesh& mesh) {
    double volume = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        volume += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return volume;
}

TEST(WorldTriangles, ABoxIsClosedAndFacesOutward) {
    const std::vector<GeometryInstance> instances{{Box{Vec3(1, 2, 3), Vec3(2, 4, 6)}, {Mat3(2), Vec3(5, 0, 0)}}};
    const auto [mesh, left_out] = world_triangles(instances);
    EXPECT_EQ(mesh->triangles.size(), 12u);
    EXPECT_EQ(left_out, 0u);
    EXPECT_EQ(mesh->bounds.lo, Vec3(7, 4, 6));
    EXPECT_EQ(mesh->bounds.hi, Vec3(9, 8, 12));
    EXPECT_DOUBLE_EQ(volume_of(*mesh), 2 * 4 * 6);
}

TEST(WorldTriangles, FlatShapesAndMeshesComeAndRoundOnesAreCounted) {
    auto own = std::make_shared<TriangleMesh>();
    own->positions = {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    own->triangles = {{0, 1, 2}};
    const std::vector<GeometryInstance> instances{{Sphere{Vec3(0), 1}, {}},
                                                  {Quad{Vec3(0), Vec3(1, 0, 0), Vec3(0, 0, 1)}, {}},
                                                  {std::shared_ptr<const TriangleMesh>(own), {Mat3(1), Vec3(0, 0, 9)}},
                                                  {Plane{}, {}}};
    const auto [mesh, left_out] = world_triangles(instances);
    EXPECT_EQ(left_out, 2u);
    ASSERT_EQ(mesh->triangles.size(), 3u);
    EXPECT_EQ(mesh->triangles[2], glm::uvec3(4, 5, 6));
    EXPECT_EQ(mesh->positions[5], Vec3(1, 0, 9));
}

TEST(ReadBenchMesh, MeshesAndScenesAreSeenByACamera) {
    const auto duck = read_bench_mesh(RAYUELA_ASSETS_DIR "/meshes/duck_bill.obj");
    ASSERT_TRUE(duck);
    const auto mesh = duck->make();
    EXPECT_GT(mesh->triangles.size(), 100u);
    EXPECT_FALSE(mesh->bounds.contains(duck->eye));
    EXPECT_GT(duck->light_corner.y, mesh->bounds.hi.y);
    const auto cornell = read_bench_mesh(RAYUELA_ASSETS_DIR "/scenes/cornell.scene.json");
    ASSERT_TRUE(cornell);
    EXPECT_GT(cornell->make()->triangles.size(), 10u);
}

TEST(ReadBenchMesh, SaysWhatIsWrong) {
    EXPECT_FALSE(read_bench_mesh(RAYUELA_ASSETS_DIR "/no_such.obj"));
    const auto round = read_bench_mesh(RAYUELA_ASSETS_DIR "/scenes/weekend.scene.json");
    ASSERT_FALSE(round);
    EXPECT_NE(round.error().front().message().find("no triangles"), std::string::npos);
}

}  // namespace
}  // namespace rayuela::test
