#include "ui/gizmo.h"

#include "ui/editor.h"

// ImGuizmo.h needs imgui.h before it.
#include <imgui.h>

#include <ImGuizmo.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <cmath>

#include "ui/navigation.h"
#include "ui/theme.h"
#include "ui/transform_edit.h"

namespace rayuela {

namespace {

Mat4 matrix(const Affine& affine) {
    Mat4 result(affine.linear);
    result[3] = Vec4(affine.translation, 1);
    return result;
}

Affine translation(const Vec3& v) {
    return {Mat3(1), v};
}

/// A step for snapping: about a twentieth of the view, as 1, 2 or 5 times a power of ten.
float round_step(float distance) {
    const float wanted = distance / 20;
    const float power = std::pow(10.0f, std::floor(std::log10(wanted)));
    const float digit = wanted / power;
    return power * (digit < 2 ? 1.0f : digit < 5 ? 2.0f : 5.0f);
}

ImGuizmo::OPERATION operation(GizmoMode mode) {
    if (mode == GizmoMode::rotate) return ImGuizmo::ROTATE;
    return mode == GizmoMode::scale ? ImGuizmo::SCALE : ImGuizmo::TRANSLATE;
}

/// Axes in the colours of the number fields; lines that stay visible on any image.
void set_style(float scale) {
    ImGuizmo::Style& style = ImGuizmo::GetStyle();
    constexpr ImVec4 kAxes[] = {{0.93f, 0.36f, 0.33f, 1}, {0.53f, 0.78f, 0.30f, 1}, {0.34f, 0.60f, 0.96f, 1}};
    for (int axis = 0; axis < 3; ++axis) {
        style.Colors[ImGuizmo::DIRECTION_X + axis] = kAxes[axis];
        ImVec4& plane = style.Colors[ImGuizmo::PLANE_X + axis];
        plane = kAxes[axis];
        plane.w = 0.45f;
    }
    style.Colors[ImGuizmo::SELECTION] = {theme::kAccent.x, theme::kAccent.y, theme::kAccent.z, 1};
    style.TranslationLineThickness = style.ScaleLineThickness = 3.5f * scale;
    style.RotationLineThickness = style.RotationOuterLineThickness = 3 * scale;
    style.TranslationLineArrowSize = 7 * scale;
    style.ScaleLineCircleSize = style.CenterCircleSize = 6 * scale;
}

const char* label(GizmoMode mode) {
    if (mode == GizmoMode::rotate) return "Rotate";
    return mode == GizmoMode::scale ? "Scale" : "Move";
}

}  // namespace

Vec3 gizmo_pivot(const Scene& scene, const Object& object) {
    if (const Plane* plane = std::get_if<Plane>(&object.shape)) return plane->point;
    const Bounds3 bounds = world_bounds(scene, object.id);
    return bounds.empty() ? Vec3(0) : scene.to_world(object.id).inverse().point(bounds.center());
}

Object placed(const Scene& scene, const Object& object, const Affine& world, GizmoMode mode) {
    const Affine local = scene.to_world(object.parent).inverse() * world;
    const bool rigid = std::holds_alternative<Plane>(object.shape);
    Object result = object;
    Transform& transform = result.transform;
    if (transform.matrix) {
        transform.matrix = matrix(local);
        return result;
    }
    transform.translate = local.translation;
    if (mode == GizmoMode::translate) return result;
    const std::optional<Transform> parts = decomposed(local);
    if (parts && mode == GizmoMode::scale && !rigid) {
        // Mirroring is in the signs of the scale before, which lengths of axes do not tell.
        transform.scale = parts->scale * glm::sign(parts->scale) * glm::sign(object.transform.scale);
    } else if (mode == GizmoMode::rotate) {
        Mat3 rotation = local.linear;
        for (int axis = 0; axis < 3; ++axis) {
            rotation[axis] /= object.transform.scale[axis];
        }
        transform.rotate = glm::normalize(glm::quat_cast(rotation));
    }
    return result;
}

Mat4 view_matrix(const Camera& camera) {
    const CameraFrame frame = camera_frame(camera);
    return glm::lookAt(camera.position, camera.position + frame.forward, frame.up);
}

Mat4 projection_matrix(const Camera& camera, float aspect) {
    const float distance = glm::distance(camera.position, camera.target);
    return glm::perspective(glm::radians(camera.vfov), aspect, 1e-3f * distance, 1e3f * distance);
}

bool Gizmo::draw(Editor& editor, const Vec2& corner, const Vec2& size) {
    const Object* const object = editor.selection ? editor.scene().find(*editor.selection) : nullptr;
    const GizmoMode mode = editor.view.gizmo;
    const bool is_plane = object && std::holds_alternative<Plane>(object->shape);
    if (!object || mode == GizmoMode::none || (is_plane && mode == GizmoMode::scale) || size.x < 1 || size.y < 1) {
        held_pivot_.reset();
        return false;
    }
    const Scene& scene = editor.scene();
    const Vec3 pivot = held_pivot_.value_or(gizmo_pivot(scene, *object));
    Mat4 handles = matrix(scene.to_world(object->id) * translation(pivot));
    const Mat4 view = view_matrix(scene.camera);
    const Mat4 projection = projection_matrix(scene.camera, size.x / size.y);

    set_style(ImGui::GetFontSize() / theme::kFontSize);
    ImGuizmo::SetDrawlist();
    ImGuizmo::SetOrthographic(false);
    ImGuizmo::SetRect(corner.x, corner.y, size.x, size.y);
    ImGuizmo::SetGizmoSizeClipSpace(0.16f);
    ImGuizmo::AllowAxisFlip(false);
    const float distance = glm::distance(scene.camera.position, scene.camera.target);
    const float step = mode == GizmoMode::rotate ? 15 : mode == GizmoMode::scale ? 0.1f : round_step(distance);
    const Vec3 snap(step);
    const bool changed =
        ImGuizmo::Manipulate(glm::value_ptr(view), glm::value_ptr(projection), operation(mode),
                             mode == GizmoMode::translate ? ImGuizmo::WORLD : ImGuizmo::LOCAL, glm::value_ptr(handles),
                             nullptr, ImGui::GetIO().KeyCtrl ? glm::value_ptr(snap) : nullptr);
    if (ImGuizmo::IsUsing()) {
        held_pivot_ = pivot;
    } else {
        held_pivot_.reset();
    }
    if (changed) {
        const Affine world = Affine{Mat3(handles), Vec3(handles[3])} * translation(-pivot);
        const Object next = placed(scene, *object, world, mode);
        if (!(next == *object)) editor.edit(SetObject{next}, label(mode));
    }
    return ImGuizmo::IsOver();
}

}  // namespace rayuela
