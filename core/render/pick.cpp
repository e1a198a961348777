#include "core/accel/surface_point.h"
#include "core/render/camera_rays.h"
#include "core/render/render_scene.h"

namespace rayuela {

std::optional<Pick> pick(const RenderScene& scene, const Vec2& position) {
    const FilmSettings& film = scene.scene().film;
    const CameraRays camera(scene.camera(), static_cast<double>(film.width) / film.height);
    const Ray ray = camera.ray(position, Vec2(0));
    Hit hit;
    scene.accelerator().intersect({&ray, 1}, {&hit, 1});
    if (!hit.valid()) return std::nullopt;
    const SurfacePoint surface = scene.surfaces().point(ray, hit, false);
    return Pick{.object = scene.object_id(hit.object),
                .point = surface.p + scene.origin(),
                .normal = surface.ns,
                .distance = glm::dot(surface.p - ray.origin, camera.forward())};
}

}  // namespace rayuela
