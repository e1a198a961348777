#include "ui/widgets.h"

#include "core/math/srgb.h"
#include "ui/icons.h"
#include "ui/theme.h"

#include <fmt/format.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace rayuela {
namespace {

constexpr float kLabelShare = 0.36f;  ///< Of a panel's width.

/// Numbers show four significant digits and are rounded to them when dragged; typed ones are kept.
constexpr const char* kNumberFormat = "%.4g";

float label_width() {
    const float font = ImGui::GetFontSize();
    return std::clamp(kLabelShare * ImGui::GetContentRegionMax().x, 5 * font, 10 * font);
}

std::string id_of(const Field& field) {
    return "##" + std::string(field.key);
}

std::string tip_of(const Field& field) {
    return std::string(field.tip) + "\nRight click: back to the default.";
}

template <typename T>
bool draw_reset_menu(const Field& field, T& value, const T& initial) {
    bool changed = false;
    if (ImGui::BeginPopupContextItem(fmt::format("reset {}", field.key).c_str())) {
        if (ImGui::MenuItem("Reset to default", nullptr, false, value != initial)) {
            value = initial;
            changed = true;
        }
        tooltip("Gives this field the value that a new one has.");
        ImGui::EndPopup();
    }
    return changed;
}

/// The number alone, without its label, as wide as the current item width.
bool number_control(const char* id, float& value, const Field& field) {
    const bool is_angle = field.role == FieldRole::angle;
    const char* format = is_angle ? "%.1f\u00b0" : kNumberFormat;
    if (field.soft_min < field.soft_max) {
        return ImGui::SliderFloat(id, &value, field.soft_min, field.soft_max, format);
    }
    const float speed = is_angle ? 0.5f : drag_speed(value);
    const bool changed = ImGui::DragFloat(id, &value, speed, 0, 0, format);
    // A drag stops where the field's range ends instead of being refused over and over.
    const float smallest = field.min_excluded ? std::max(field.min, std::abs(value) * 1e-3f) : field.min;
    if (changed && ImGui::IsMouseDown(ImGuiMouseButton_Left)) value = std::clamp(value, smallest, field.max);
    return changed;
}

/// The linear value of an edited colour: components that were not touched keep their bits.
Color edited_color(const Color& before, const Vec3& shown, const Vec3& edited) {
    Color result = before;
    for (int channel = 0; channel < 3; ++channel) {
        if (edited[channel] != shown[channel]) result[channel] = srgb_to_linear(edited[channel]);
    }
    return result;
}

Vec3 encoded(const Color& linear) {
    return {linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z)};
}

constexpr ImGuiColorEditFlags kColorFlags =
    ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_PickerHueWheel;

bool reflectance_control(const char* id, Color& value) {
    const Vec3 shown = encoded(value);
    Vec3 edited = shown;
    if (!ImGui::ColorEdit3(id, &edited.x, kColorFlags | ImGuiColorEditFlags_DisplayHex)) return false;
    value = edited_color(value, shown, edited);
    return true;
}

/// A colour whose largest component is 1, and how strong it is.
bool radiance_control(const char* id, Color& value) {
    const float intensity = max_component(value);
    const Color color = intensity > 0 ? value / intensity : Color(1);
    const Vec3 shown = encoded(color);
    Vec3 edited = shown;
    float edited_intensity = intensity;

    const float width = ImGui::CalcItemWidth();
    ImGui::PushID(id);
    const bool color_edited = ImGui::ColorEdit3("##color", &edited.x, kColorFlags | ImGuiColorEditFlags_NoInputs);
    tooltip("Colour of the light; its strength stands beside it. Where there is no other light, samples go on.");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::SetNextItemWidth(width - ImGui::GetFrameHeight() - ImGui::GetStyle().ItemInnerSpacing.x);
    const bool intensity_edited =
        ImGui::DragFloat("##intensity", &edited_intensity, drag_speed(intensity), 0, std::numeric_limits<float>::max(),
                         "\u00d7 %.4g", ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopID();

    if (color_edited && max_component(edited) > 0) {
        const Color picked = edited_color(color, shown, edited);
        value = picked / max_component(picked) * (intensity > 0 ? intensity : 1);
    }
    if (intensity_edited) value = color * edited_intensity;
    return color_edited || intensity_edited;
}

bool color_control(const char* id, Color& value, const Field& field) {
    return field.role == FieldRole::radiance ? radiance_control(id, value) : reflectance_control(id, value);
}

/// Button at the end of the line to load a texture, and a line with its name where there is one.
template <typename T>
bool texture_control(T& value, const Field& field, const FieldActions& actions) {
    bool changed = false;
    ImGui::PushID(field.key.data(), field.key.data() + field.key.size());
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (icon_button(icon::kImage, "texture", "Multiply with an image file: choose one."))
        actions.browse_texture(field.key);
    if (value.texture) {
        field_label("  texture", value.texture->source);
        if (icon_button(icon::kClose, "clear", "Remove the texture; the plain value stays.")) {
            value.texture = nullptr;
            changed = true;
        }
        if (value.texture) {
            ImGui::SameLine();
            const auto name = std::filesystem::path(value.texture->source).filename().string();
            ImGui::TextDisabled("%s, %d x %d", name.c_str(), value.texture->width, value.texture->height);
            tooltip(value.texture->source);
        }
    }
    ImGui::PopID();
    return changed;
}

/// Leaves room for the texture button where there is one.
void set_value_width(const FieldActions& actions) {
    const float button = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::SetNextItemWidth(actions.browse_texture ? -button : -FLT_MIN);
}

}  // namespace

void tooltip(std::string_view text) {
    // Not for an item that the keyboard has reached: its tooltip would hide what is next to it.
    constexpr ImGuiHoveredFlags kFlags =
        ImGuiHoveredFlags_ForTooltip | ImGuiHoveredFlags_AllowWhenDisabled | ImGuiHoveredFlags_NoNavOverride;
    if (!ImGui::IsItemHovered(kFlags)) return;
    if (!ImGui::BeginTooltip()) return;
    ImGui::PushTextWrapPos(24 * ImGui::GetFontSize());
    ImGui::TextUnformatted(text.data(), text.data() + text.size());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool icon_button(const char* icon, const char* id, std::string_view tip, bool enabled) {
    const float side = ImGui::GetFrameHeight();
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, ImGui::GetStyle().FramePadding.y));
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(fmt::format("{}###{}", icon, id).c_str(), ImVec2(side, side));
    ImGui::EndDisabled();
    ImGui::PopStyleVar();
    tooltip(tip);
    return pressed;
}

void field_label(std::string_view label, std::string_view tip) {
    ImGui::AlignTextToFramePadding();
    const float start = ImGui::GetCursorPosX();
    const float end = label_width();
    const ImVec2 min = ImGui::GetCursorScreenPos();
    const ImVec2 max(min.x + end - start - ImGui::GetStyle().ItemInnerSpacing.x, min.y + ImGui::GetFrameHeight());
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    const std::string text(label);
    ImGui::BeginGroup();
    ImGui::PushClipRect(min, max, true);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopClipRect();
    ImGui::EndGroup();
    ImGui::PopStyleColor();
    tooltip(tip);
    ImGui::SameLine(end);
    ImGui::SetNextItemWidth(-FLT_MIN);
}

void hint(const char* text) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s", text);
    ImGui::PopStyleColor();
}

bool name_combo(const char* id, int& index, std::span<const char* const> names, std::string_view tip) {
    const bool changed = ImGui::Combo(id, &index, names.data(), static_cast<int>(names.size()));
    tooltip(tip);
    return changed;
}

bool log_slider(const char* id, int& value, int slider_min, int slider_max, int min, int max, std::string_view tip) {
    const bool changed = ImGui::SliderInt(id, &value, slider_min, slider_max, "%d", ImGuiSliderFlags_Logarithmic);
    tooltip(tip);
    value = std::clamp(value, min, max);
    return changed;
}

ImVec4 display_color(const Color& linear) {
    const Vec3 shown = encoded(glm::clamp(linear, Color(0), Color(1)));
    return {shown.x, shown.y, shown.z, 1};
}

float drag_speed(float value) {
    return std::max(std::abs(value), 1.0f) * 0.005f;
}

bool drag_vec3(const char* id, Vec3& value, float speed, const char* format, std::string_view tip) {
    static constexpr const char* kIds[] = {"##x", "##y", "##z"};
    static constexpr ImU32 kAxisColors[] = {IM_COL32(226, 84, 80, 255), IM_COL32(122, 190, 72, 255),
                                            IM_COL32(77, 143, 226, 255)};
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::CalcItemWidth() - 2 * spacing) / 3;
    bool changed = false;
    ImGui::PushID(id);
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine(0, spacing);
        ImGui::SetNextItemWidth(width);
        changed |= ImGui::DragFloat(kIds[axis], &value[axis], speed, 0, 0, format);
        tooltip(fmt::format("{}: {}", "xyz"[axis], tip));
        const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
        const float inset = ImGui::GetStyle().FrameRounding;
        ImGui::GetWindowDrawList()->AddRectFilled({min.x + 1, min.y + inset}, {min.x + 3, max.y - inset},
                                                  kAxisColors[axis]);
    }
    ImGui::PopID();
    return changed;
}

bool draw_field(bool& value, bool initial, const Field& field, const FieldActions&) {
    field_label(field.label, field.tip);
    bool changed = ImGui::Checkbox(id_of(field).c_str(), &value);
    tooltip(tip_of(field));
    changed |= draw_reset_menu(field, value, initial);
    return changed;
}

bool draw_field(float& value, float initial, const Field& field, const FieldActions&) {
    field_label(field.label, field.tip);
    bool changed = number_control(id_of(field).c_str(), value, field);
    tooltip(tip_of(field) + "\nDrag, or ctrl-click to type.");
    changed |= draw_reset_menu(field, value, initial);
    return changed;
}

bool draw_field(Vec3& value, const Vec3& initial, const Field& field, const FieldActions&) {
    field_label(field.label, tip_of(field));
    bool changed = false;
    ImGui::BeginGroup();
    if (field.role == FieldRole::reflectance || field.role == FieldRole::radiance) {
        changed = color_control(id_of(field).c_str(), value, field);
    } else {
        ImGui::SetNextItemWidth(-FLT_MIN);
        const std::string key(field.key);
        changed = drag_vec3(key.c_str(), value, drag_speed(max_component(glm::abs(value))), kNumberFormat, field.tip);
    }
    ImGui::EndGroup();
    if (field.role == FieldRole::reflectance || field.role == FieldRole::radiance) tooltip(tip_of(field));
    changed |= draw_reset_menu(field, value, initial);
    return changed;
}

bool draw_field(std::array<Vec3, 3>& value, const std::array<Vec3, 3>& initial, const Field& field,
                const FieldActions&) {
    bool changed = false;
    ImGui::PushID(field.key.data(), field.key.data() + field.key.size());
    for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string key = std::to_string(i), label = fmt::format("{} {}", field.label, i + 1);
        const Field row{key, label, field.tip, field.role};
        changed |= draw_field(value[i], initial[i], row, {});
    }
    ImGui::PopID();
    return changed;
}

bool draw_field(FloatValue& value, const FloatValue& initial, const Field& field, const FieldActions& actions) {
    field_label(field.label, field.tip);
    set_value_width(actions);
    bool changed = number_control(id_of(field).c_str(), value.value, field);
    tooltip(tip_of(field) + "\nDrag, or ctrl-click to type.");
    changed |= draw_reset_menu(field, value, initial);
    if (actions.browse_texture) changed |= texture_control(value, field, actions);
    return changed;
}

bool draw_field(ColorValue& value, const ColorValue& initial, const Field& field, const FieldActions& actions) {
    field_label(field.label, field.tip);
    set_value_width(actions);
    ImGui::BeginGroup();
    bool changed = color_control(id_of(field).c_str(), value.value, field);
    ImGui::EndGroup();
    tooltip(tip_of(field));
    changed |= draw_reset_menu(field, value, initial);
    if (actions.browse_texture) changed |= texture_control(value, field, actions);
    return changed;
}

bool draw_field(std::string& value, const std::string&, const Field& field, const FieldActions& actions) {
    field_label(field.label, field.tip);
    const std::string name = value.empty() ? "Choose a file..." : std::filesystem::path(value).filename().string();
    const bool pressed =
        ImGui::Button(fmt::format("{}  {}###{}", icon::kOpen, name, field.key).c_str(), ImVec2(-FLT_MIN, 0));
    tooltip(value.empty() ? std::string(field.tip) : fmt::format("{}\n{}\nClick to choose another.", field.tip, value));
    if (pressed && actions.browse_file) actions.browse_file(field.key);
    return false;
}

}  // namespace rayuela
