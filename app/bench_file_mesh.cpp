#include "app/bench_file_mesh.h"

#include "app/subcommands.h"
#include "core/accel/traced_object.h"
#include "core/render/render_scene.h"

#include <fmt/format.h>

namespace rayuela {
namespace {

class Gatherer {
public:
    void add(const GeometryInstance& instance) {
        std::visit([&](const auto& shape) { add(shape, AffineD(instance.to_world)); }, instance.shape);
    }
    WorldTriangles finish() {
        return {.mesh = std::make_shared<const TriangleMesh>(std::move(mesh_)), .left_out = left_out_};
    }

private:
    void add(const Sphere&, const AffineD&) { ++left_out_; }
    void add(const Plane&, const AffineD&) { ++left_out_; }
    void add(const Triangle& triangle, const AffineD& to_world) {
        add(triangle.vertices, std::array{glm::uvec3(0, 1, 2)}, to_world);
    }
    void add(const Quad& quad, const AffineD& to_world) {
        const std::array corners{quad.point, quad.point + quad.u, quad.point + quad.u + quad.v, quad.point + quad.v};
        add(corners, std::array{glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)}, to_world);
    }
    void add(const Box& box, const AffineD& to_world) {
        std::array<Vec3, 8> corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis) corners[i][axis] = (i >> axis & 1 ? box.max : box.min)[axis];
        }
        constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
        std::vector<glm::uvec3> triangles;
        for (const auto& [a, b, c, d] : kFaces) {
            triangles.emplace_back(a, b, c);
            triangles.emplace_back(a, c, d);
        }
        add(corners, triangles, to_world);
    }
    void add(const std::shared_ptr<const TriangleMesh>& mesh, const AffineD& to_world) {
        add(mesh->positions, mesh->triangles, to_world);
    }
    void add(std::span<const Vec3> positions, std::span<const glm::uvec3> triangles, const AffineD& to_world) {
        const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
        for (const Vec3& p : positions) {
            mesh_.positions.emplace_back(to_world.point(Vec3d(p)));
            mesh_.bounds.extend(mesh_.positions.back());
        }
        for (const glm::uvec3& t : triangles) mesh_.triangles.push_back(t + first);
    }

    TriangleMesh mesh_;
    std::size_t left_out_ = 0;
};

}  // namespace

WorldTriangles world_triangles(std::span<const GeometryInstance> instances) {
    Gatherer gatherer;
    for (const GeometryInstance& instance : instances) gatherer.add(instance);
    return gatherer.finish();
}

Result<BenchMesh> read_bench_mesh(const std::filesystem::path& file) {
    auto scene = load_scene(file, {.accelerator = AcceleratorKind::list});
    if (!scene) return tl::unexpected(scene.error());
    BuildControl control;
    const auto built =
        RenderScene::update(nullptr, std::make_shared<const Scene>(std::move(*scene)), all_changes(), control);
    const auto [mesh, left_out] = world_triangles(built->accelerator().instances());
    if (mesh->triangles.empty()) return fail(file.string(), "", "there are no triangles to measure with");

    const Camera camera = built->camera();
    const Vec3 size = mesh->bounds.extent(), top(mesh->bounds.lo.x, mesh->bounds.hi.y, mesh->bounds.lo.z);
    return BenchMesh{
        .name = file.filename().string(),
        .description = left_out == 0 ? "from a file" : fmt::format("without {} spheres and planes", left_out),
        .make = [made = mesh] { return made; },
        .eye = camera.position,
        .target = camera.target,
        .field_of_view = camera.vfov,
        .light_corner = top + size * Vec3(0.25f, 0.5f, 0.25f),
        .light_u = Vec3(size.x / 2, 0, 0),
        .light_v = Vec3(0, 0, size.z / 2),
        .up = camera.up};
}

}  // namespace rayuela
