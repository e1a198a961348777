#pragma once

#include "core/materials/value.h"
#include "core/math/field.h"

#include <imgui.h>

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace rayuela {

/// Explains the item before it: every control has one.
void tooltip(std::string_view text);

/// A button of one icon, as wide as high; its id is "###<id>".
bool icon_button(const char* icon, const char* id, std::string_view tip, bool enabled = true);

/// A label in the left column of a panel; the control that follows fills the rest of the line.
void field_label(std::string_view label, std::string_view tip);

/// A greyed line that says what to do where there is nothing to see.
void hint(const char* text);

/// A combo box over fixed names; `index` is valid.
bool name_combo(const char* id, int& index, std::span<const char* const> names, std::string_view tip);

/// A slider whose steps are even in the logarithm; any value in [min, max] may be typed (ctrl-click).
bool log_slider(const char* id, int& value, int slider_min, int slider_max, int min, int max, std::string_view tip);

/// A swatch of the colour of a linear value.
ImVec4 display_color(const Color& linear);

/// What a field cannot do by itself, because it needs a file.
struct FieldActions {
    std::function<void(std::string_view key)> browse_texture;  ///< Empty: no textures here.
    std::function<void(std::string_view key)> browse_file;
};

/// A labelled control for one member. `initial` is its default, to which the context menu resets it. True when the value
/// has been changed; whether it may have that value is for `apply` to say. The control's id is "##<key>", a file's "###<key>".
bool draw_field(bool& value, bool initial, const Field& field, const FieldActions& actions);
bool draw_field(float& value, float initial, const Field& field, const FieldActions& actions);
bool draw_field(Vec3& value, const Vec3& initial, const Field& field, const FieldActions& actions);
bool draw_field(std::array<Vec3, 3>& value, const std::array<Vec3, 3>& initial, const Field& field,
                const FieldActions& actions);
bool draw_field(FloatValue& value, const FloatValue& initial, const Field& field, const FieldActions& actions);
bool draw_field(ColorValue& value, const ColorValue& initial, const Field& field, const FieldActions& actions);
bool draw_field(std::string& value, const std::string& initial, const Field& field, const FieldActions& actions);

/// A control for each member that T::visit_fields lists.
template <typename T>
bool draw_fields(T& value, const FieldActions& actions = {}) {
    bool changed = false;
    const T initial{};
    T::visit_fields(value, [&]<typename F>(F& member, const Field& field) {
        // The default of a member is where the same member lies in a default-constructed struct.
        T::visit_fields(initial, [&]<typename G>(const G& other, const Field& other_field) {
            if constexpr (std::is_same_v<F, G>) {
                if (field.key == other_field.key) changed |= draw_field(member, other, field, actions);
            }
        });
    });
    return changed;
}

/// Three numbers in a row, marked x, y, z, with ids "##x", "##y", "##z" below `id`.
bool drag_vec3(const char* id, Vec3& value, float speed, const char* format, std::string_view tip);

/// How far one pixel of a drag moves a number of this size.
float drag_speed(float value);

}  // namespace rayuela
