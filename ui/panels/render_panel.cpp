#include "ui/icons.h"
#include "ui/panels/panels.h"
#include "ui/widgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

namespace rayuela {
namespace {

constexpr const char* kAcceleratorNames[] = {"List", "KD-tree"};
constexpr const char* kSplitNames[] = {"Median", "SAH"};
constexpr const char* kSamplerNames[] = {"Independent", "Sobol"};
constexpr const char* kLightChoiceNames[] = {"All alike", "By power", "By what arrives"};
constexpr const char* kFilterNames[] = {"Box", "Tent", "Gaussian"};
constexpr int kSliderLeafSize = 1024;  ///< Larger ones can be typed.

template <typename Enum>
bool enum_combo(const char* id, Enum& value, std::span<const char* const> names, const char* tip) {
    int index = static_cast<int>(value);
    if (!name_combo(id, index, names, tip)) return false;
    value = static_cast<Enum>(index);
    return true;
}

void draw_buttons(Editor& editor) {
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - spacing) / 2;
    const std::string pause =
        editor.paused ? fmt::format("{}  Resume###pause", icon::kPlay) : fmt::format("{}  Pause###pause", icon::kPause);
    if (ImGui::Button(pause.c_str(), {width, 0})) editor.paused = !editor.paused;
    tooltip(editor.paused ? "Goes on where it stopped (P)." : "Stops adding samples; what is there stays (P).");
    ImGui::SameLine(0, spacing);
    if (ImGui::Button(fmt::format("{}  Restart###restart", icon::kRestart).c_str(), {width, 0}))
        editor.session().restart();
    tooltip("Throws the samples away and starts anew (Ctrl+R).");
}

/// How far the image is towards a limit or the target error, in [0, 1]; nothing where there is none.
std::optional<double> limit_progress(const RenderSettings& render, const RenderStatistics& statistics) {
    std::optional<double> progress;
    if (render.max_samples > 0) progress = static_cast<double>(statistics.spp) / render.max_samples;
    if (statistics.adaptive) progress = std::max(progress.value_or(0), statistics.spread.finished_pixels);
    if (render.max_seconds > 0)
        progress = std::max(progress.value_or(0), statistics.render_seconds / render.max_seconds);
    return progress;
}

void draw_progress(Editor& editor) {
    const SessionStatus status = editor.session().status();
    if (status.phase == SessionPhase::building) {
        ImGui::ProgressBar(static_cast<float>(status.build_progress), {-FLT_MIN, 0}, "Building");
        tooltip("The acceleration structure is being built.");
        return;
    }
    if (!editor.frame()) return;
    const RenderStatistics& statistics = editor.frame()->statistics;
    const auto progress = limit_progress(editor.scene().render, statistics);
    if (!progress) return;
    // Only what is finished is 100 %.
    const bool finished = status.phase == SessionPhase::finished;
    const int percent = finished ? 100 : std::min(99, static_cast<int>(*progress * 100));
    const std::string text = finished ? "Finished" : fmt::format("{} %", percent);
    ImGui::ProgressBar(static_cast<float>(percent) / 100, {-FLT_MIN, 0}, text.c_str());
    tooltip(fmt::format("{} samples a pixel in {:.1f} s of rendering.", statistics.spp, statistics.render_seconds));
}

void draw_structure(Editor& editor) {
    RenderSettings render = editor.scene().render;
    AccelSettings& accel = render.accel;
    bool changed = false;
    field_label("Structure", "How a ray finds what it hits. The image does not depend on it.");
    changed |=
        enum_combo("##structure", accel.kind, kAcceleratorNames,
                   "How a ray finds what it hits: a list tries every object in turn, a kd-tree only those nearby. "
                   "The image is the same, bit for bit; only the time differs.");
    const bool is_tree = accel.kind == AcceleratorKind::kd;
    ImGui::BeginDisabled(!is_tree);
    field_label("Leaf size", "Primitives that a leaf of the tree should hold at most.");
    changed |= log_slider(
        "##leaf size", accel.leaf_size, kMinLeafSize, kSliderLeafSize, kMinLeafSize, kMaxLeafSize,
        "Primitives that a leaf of the kd-tree should hold at most. Small leaves: a deep tree that takes memory; "
        "large leaves: many tests a ray. Watch nodes, leaves and speed in Statistics. The image stays the same "
        "and goes on converging. Ctrl-click to type, also larger numbers.");
    field_label("Split", "How the tree chooses its cuts.");
    changed |= enum_combo(
        "##split", accel.split, kSplitNames,
        "Median cuts the longest axis so that half of the primitives lie on each side; SAH cuts where a ray is "
        "expected to cost least.");
    ImGui::EndDisabled();
    if (changed) editor.edit(SetRenderSettings{render}, "Change structure");
}

void draw_paths(Editor& editor) {
    RenderSettings render = editor.scene().render;
    bool changed = false;
    field_label("Max bounces", "Scattering events of a path; 0 shows emitters and environment only.");
    changed |= ImGui::SliderInt("##max bounces", &render.max_bounces, 0, 32);
    tooltip(
        "Scattering events of a path at most; 0 shows emitters and environment only. Glass needs 8 or more. Ctrl-click "
        "to type.");

    field_label("Roulette", "First bounce at which weak paths may be ended by chance.");
    bool automatic = !render.rr_start;
    if (ImGui::Checkbox("auto##roulette", &automatic)) {
        render.rr_start = automatic ? std::nullopt : std::optional(3);
        changed = true;
    }
    tooltip("Russian roulette ends weak paths early without bias. Auto: the renderer chooses when.");
    if (render.rr_start) {
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-FLT_MIN);
        changed |= ImGui::SliderInt("##rr start", &*render.rr_start, 0, 32, "from bounce %d");
        tooltip("First bounce that roulette may cut.");
    }

    field_label("Sampler", "Where random numbers come from.");
    changed |= enum_combo(
        "##sampler", render.sampler, kSamplerNames,
        "Sobol spreads samples evenly and converges faster; independent numbers are the plain textbook case.");
    field_label("Lamp choice", "How a path chooses the lamp that it asks for light.");
    changed |= enum_combo("##lamp choice", render.light_choice, kLightChoiceNames,
                          "How a path chooses the lamp that it asks for light: all alike, by power, or by what each is "
                          "estimated to send to "
                          "the point. The image becomes the same; with many lamps the last has far less noise.");
    field_label("Seed", "Another seed, another noise.");
    int seed = static_cast<int>(render.seed);
    if (ImGui::InputInt("##seed", &seed)) {
        render.seed = static_cast<std::uint32_t>(std::max(seed, 0));
        changed = true;
    }
    tooltip("Another seed gives other noise; the same seed the same image, on any number of threads.");
    if (changed) editor.edit(SetRenderSettings{render}, "Change sampling");

    FilmSettings film = editor.scene().film;
    field_label("Pixel filter", "How samples are weighted within and around a pixel.");
    if (enum_combo("##filter", film.filter, kFilterNames,
                   "Box is sharp and exact; tent and Gaussian smooth edges a little.")) {
        editor.edit(SetFilm{film}, "Change pixel filter");
    }
}

void draw_adaptive(SamplingSettings& sampling) {
    field_label("Adaptive", "Samples go where the noise is.");
    ImGui::Checkbox("##adaptive", &sampling.adaptive);
    tooltip(
        "Samples go where the noise is, and rendering stops where the target error is reached; no pixel gets fewer "
        "than 32. Each half of the samples is stopped by what the other half shows, so the image does not become "
        "darker or "
        "brighter by it. Off: all pixels get the same. What has been rendered stays.");
    ImGui::BeginDisabled(!sampling.adaptive);
    field_label("Target error", "Relative error at which the image is finished.");
    float percent = 100 * sampling.target_error;
    constexpr ImGuiSliderFlags kFlags = ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp;
    if (ImGui::SliderFloat("##target error", &percent, 0.5f, 20, "%.2f %%", kFlags))
        sampling.target_error = std::clamp(percent / 100, kMinTargetError, kMaxTargetError);
    tooltip(
        "How far a pixel may typically be from the truth when rendering stops (the root of the mean squared relative "
        "error). Half of it takes four times the samples. A smaller one goes on from the samples that are there.");
    ImGui::EndDisabled();
}

void draw_clamp(SamplingSettings& sampling) {
    field_label("Clamp fireflies", "Darkens single samples that are brighter than this.");
    ImGui::Checkbox("##clamps", &sampling.clamps);
    tooltip(
        "Darkens samples brighter than this, which hides rare bright dots. It also takes light away that belongs "
        "there: Statistics says how much. Off by default; switching it restarts the image.");
    if (!sampling.clamps) return;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    ImGui::DragFloat("##clamp", &sampling.clamp, 0.1f, 0.1f, 1e6f, "%.1f", ImGuiSliderFlags_AlwaysClamp);
    tooltip("Largest value that a channel of a sample may have. Ctrl-click to type.");
}

void draw_limits(Editor& editor) {
    RenderSettings render = editor.scene().render;
    bool changed = false;
    field_label("Stop at", "Stops at so many samples a pixel; 0 never.");
    const char* samples_format = render.max_samples > 0 ? "%d samples" : "no sample limit";
    changed |= ImGui::DragInt("##max samples", &render.max_samples, 4, 0, 1 << 30, samples_format,
                              ImGuiSliderFlags_AlwaysClamp);
    tooltip("Stops at so many samples a pixel; 0 never. Raising it goes on where it stopped. Ctrl-click to type.");
    field_label("Stop after", "Stops after so many seconds of rendering; 0 never.");
    float seconds = static_cast<float>(render.max_seconds);
    const char* seconds_format = seconds > 0 ? "%.1f s" : "no time limit";
    if (ImGui::DragFloat("##max seconds", &seconds, 0.5f, 0, 1e9f, seconds_format, ImGuiSliderFlags_AlwaysClamp)) {
        render.max_seconds = static_cast<double>(seconds);
        changed = true;
    }
    tooltip("Stops after so many seconds of rendering; 0 never. Ctrl-click to type.");
    if (changed) editor.edit(SetRenderSettings{render}, "Change limits");

    field_label("Threads", "Workers that trace rays.");
    const int available = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    ImGui::SliderInt("##threads", &editor.threads, 0, available, editor.threads > 0 ? "%d" : "all",
                     ImGuiSliderFlags_AlwaysClamp);
    tooltip(
        fmt::format("Workers that trace rays, of {} that the machine has. Fewer leave room for other programs; the "
                    "image is the same.",
                    available));
}

void draw_display(Editor& editor) {
    field_label("Exposure", "Brightness of the view, in stops.");
    ImGui::SliderFloat("##exposure", &editor.view.exposure, -8, 8, "%+.2f stops");
    tooltip("Brightness of the view: one stop up is twice the light. Nothing is rendered anew (+ and -).");
    if (ImGui::BeginPopupContextItem("reset exposure")) {
        if (ImGui::MenuItem("Reset to default")) editor.view.exposure = 0;
        tooltip("No change of brightness.");
        ImGui::EndPopup();
    }
    field_label("Tone map", "How radiance becomes what a display can show.");
    enum_combo(
        "##tone map", editor.view.tone_map, kToneMapNames,
        "How radiance becomes what a display can show: linear clips; ACES, AgX and Filmic roll bright light off; "
        "false color shows brightness in stops. Nothing is rendered anew.");
    field_label("Outline", "Marks the selected object in the image.");
    ImGui::Checkbox("##outline", &editor.view.show_outline);
    tooltip("Marks the selected object in the image.");
}

}  // namespace

void draw_render_panel(Editor& editor) {
    draw_buttons(editor);
    draw_progress(editor);
    ImGui::SeparatorText("Acceleration structure");
    draw_structure(editor);
    ImGui::SeparatorText("Display");
    draw_display(editor);
    ImGui::SeparatorText("Sampling");
    draw_adaptive(editor.sampling);
    draw_clamp(editor.sampling);
    ImGui::SeparatorText("Limits");
    draw_limits(editor);
    ImGui::SeparatorText("Light paths");
    draw_paths(editor);
}

}  // namespace rayuela
