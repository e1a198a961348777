#include "ui/camera_control.h"

#include "core/render/render_scene.h"
#include "ui/camera_views.h"
#include "ui/navigation.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rayuela {

namespace {

constexpr float kWheelDolly = 0.9f;   ///< Factor of the distance, a notch.
constexpr float kWheelZoom = 1.25f;   ///< Factor of the zoom, a notch.
constexpr float kFastFlight = 4;      ///< With Shift.
constexpr float kLongestStep = 0.1f;  ///< Seconds of flight in one frame at most, after a stall.

Vec2 to_vec(const ImVec2& v) {
    return {v.x, v.y};
}

void set_camera(Editor& editor, const Camera& camera, const char* label) {
    if (!(camera == editor.scene().camera)) editor.edit(SetCamera{camera}, label);
}

bool is_zooming() {
    return ImGui::GetIO().KeyCtrl || ImGui::IsKeyDown(ImGuiKey_Z);
}

}  // namespace

ObjectId next_selection(const Scene& scene, std::optional<ObjectId> selected, ObjectId hit) {
    for (const Object* object = scene.find(hit); object; object = scene.find(object->parent)) {
        if (selected == object->id) return object->parent ? object->parent : hit;
    }
    return hit;
}

void CameraControl::update(Editor& editor, const Canvas& canvas) {
    flying_ = false;
    if (ImGui::IsItemHovered()) wheel(editor, canvas);
    if (ImGui::IsItemActive()) drag(editor, canvas);
    if (ImGui::IsItemDeactivated()) click(editor, canvas);
}

void CameraControl::drag(Editor& editor, const Canvas& canvas) {
    const ImGuiIO& io = ImGui::GetIO();
    const Vec2 delta = to_vec(io.MouseDelta);
    const bool left = ImGui::IsMouseDragging(ImGuiMouseButton_Left);
    const bool middle = ImGui::IsMouseDragging(ImGuiMouseButton_Middle);
    if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) return fly(editor, canvas);
    if (!(left || middle) || delta == Vec2(0)) return;

    const Camera& camera = editor.scene().camera;
    if (is_zooming()) {
        editor.view = panned(editor.view, canvas.size * canvas.density, canvas.image_size, delta * canvas.density);
    } else if (middle || io.KeyShift) {
        const ImageView view = canvas.view(editor.view);
        const float image_height = canvas.image_size.y * view.zoom / canvas.density;
        set_camera(editor, pan(camera, delta / std::max(image_height, 1.0f)), "Pan");
    } else {
        const Vec2 angle = kPi * delta / std::max(canvas.size.y, 1.0f);
        set_camera(editor, orbit(camera, -angle.x, angle.y), "Orbit");
    }
}

void CameraControl::fly(Editor& editor, const Canvas& canvas) {
    const ImGuiIO& io = ImGui::GetIO();
    const auto axis = [](ImGuiKey positive, ImGuiKey negative) {
        return static_cast<float>(ImGui::IsKeyDown(positive)) - static_cast<float>(ImGui::IsKeyDown(negative));
    };
    const Vec3 keys(axis(ImGuiKey_D, ImGuiKey_A), axis(ImGuiKey_E, ImGuiKey_Q), axis(ImGuiKey_W, ImGuiKey_S));
    flying_ = keys != Vec3(0);

    Camera camera = editor.scene().camera;
    const Vec2 angle = glm::radians(camera.vfov) * to_vec(io.MouseDelta) / std::max(canvas.size.y, 1.0f);
    if (angle != Vec2(0)) camera = look(camera, angle.x, -angle.y);
    if (flying_) {
        const float speed = fly_speed(camera, world_bounds(editor.scene())) * (io.KeyShift ? kFastFlight : 1);
        camera = rayuela::fly(camera, keys * speed * std::min(io.DeltaTime, kLongestStep));
    }
    set_camera(editor, camera, "Fly");
}

void CameraControl::wheel(Editor& editor, const Canvas& canvas) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.MouseWheel == 0) return;
    if (is_zooming()) {
        const Vec2 position = (to_vec(io.MousePos) - canvas.corner) * canvas.density;
        editor.view = zoomed_at(editor.view, canvas.size * canvas.density, canvas.image_size, position,
                                std::pow(kWheelZoom, io.MouseWheel));
    } else {
        set_camera(editor, dolly(editor.scene().camera, std::pow(kWheelDolly, io.MouseWheel)), "Dolly");
    }
}

void CameraControl::click(Editor& editor, const Canvas& canvas) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool released = ImGui::IsMouseReleased(ImGuiMouseButton_Left);
    const bool dragged =
        io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] >= io.MouseDragThreshold * io.MouseDragThreshold;
    const std::shared_ptr<const Frame>& frame = editor.frame();
    if (!released || dragged || !frame || !frame->render_scene) return;

    const Vec2 position = canvas.to_image(editor.view, to_vec(io.MousePos)) / canvas.image_size;
    const bool inside = position.x >= 0 && position.y >= 0 && position.x < 1 && position.y < 1;
    if (editor.health.replays && inside) {
        editor.health.replayed_pixel = glm::ivec2(position * canvas.image_size);
        return;
    }
    const std::optional<Pick> hit = inside ? pick(*frame->render_scene, position) : std::nullopt;
    if (io.MouseClickedLastCount[ImGuiMouseButton_Left] == 2) {
        if (!hit) return;
        Camera camera = focused_on(editor.scene().camera, hit->point);
        // Orbiting turns about the depth that is sharp; the picture keeps its place.
        camera.target = camera.position + camera.focus_distance * camera_frame(camera).forward;
        set_camera(editor, camera, "Focus");
    } else if (hit) {
        editor.selection = next_selection(editor.scene(), editor.selection, hit->object);
    } else {
        editor.selection.reset();
    }
}

}  // namespace rayuela
