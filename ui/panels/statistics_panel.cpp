#include "ui/number_text.h"
#include "ui/panels/number_table.h"
#include "ui/panels/panels.h"
#include "ui/theme.h"
#include "ui/widgets.h"

#include <fmt/format.h>
#include <implot.h>

#include <algorithm>
#include <cmath>

namespace rayuela {
namespace {

constexpr const char* kRejectionNames[] = {"not a number", "infinite", "negative"};

constexpr const char* kErrorTip =
    "Estimated relative mean squared error of the image: the expected square of (pixel - true pixel) over the true "
    "pixel's "
    "square, averaged. It is measured between two independent halves of the samples, so it is an error against the "
    "truth, not a "
    "change between two frames. 1e-2 is noisy, 1e-4 looks clean; four times the samples give a quarter of it.";

std::string percent(double relative_mse) {
    return fmt::format("{:.1f} %", 100 * std::sqrt(relative_mse));
}

void draw_rendering(const RenderStatistics& s, float width) {
    if (!begin_number_table("rendering", width)) return;
    const bool known = s.estimated_error > 0;
    std::uint64_t rejected = 0;
    for (const std::uint64_t count : s.rejected) rejected += count;
    if (s.adaptive) {
        number_row("Samples a pixel", fmt::format("{:.1f}", s.spread.mean),
                   "Camera paths that a pixel has got on average. View > Samples shows where they went.");
        number_row("Most samples", grouped_text(static_cast<std::uint64_t>(s.spp)),
                   "Camera paths of each pixel that is not finished.");
        number_row("Finished", fmt::format("{:.1f} %", 100 * s.spread.finished_pixels),
                   "Share of the pixels that have all samples that the target error asks for, and get no more.");
    } else {
        number_row("Samples a pixel", grouped_text(static_cast<std::uint64_t>(s.spp)),
                   "Camera paths that every pixel has got.");
    }
    if (s.clamp_loss.removed > 0) {
        number_row("Clamped away", fmt::format("{:.3g} ({:.2g} %)", s.clamp_loss.removed, 100 * s.clamp_loss.share),
                   "Luminance that the firefly clamp has removed from a pixel on average, and its share of the image's "
                   "energy. The image is darker than the truth by that much.",
                   &theme::kWarning);
    }
    number_row("Time", duration_text(s.render_seconds), "Rendering since the last restart, pauses left out.");
    number_row("Speed", quantity_text(s.samples_per_second, "samples/s"),
               "Camera paths a second over the whole image.");
    number_row("Rays", quantity_text(s.rays_per_second, "rays/s"), "Closest-hit and shadow rays a second.");
    number_row("Error (relMSE)", known ? fmt::format("{:.2e}", s.estimated_error) : "-", kErrorTip);
    number_row("Noise", known ? percent(s.estimated_error) : "-",
               "Square root of the error: how far a pixel typically is from the truth.");
    number_row("Rejected", grouped_text(rejected),
               "Samples left out because their value made no sense. Zero is right; anything else is a defect.",
               rejected > 0 ? &theme::kError : nullptr);
    for (std::size_t i = 0; i < s.rejected.size(); ++i) {
        if (s.rejected[i] > 0)
            number_row(kRejectionNames[i], grouped_text(s.rejected[i]), "Samples rejected for this cause.",
                       &theme::kError);
    }
    number_row("Memory", quantity_text(static_cast<double>(s.memory_bytes), "B"), "Trees, meshes, images and film.");
    number_row("Paths", grouped_text(s.samples), "Camera paths since the last restart.");
    number_row("Restarts", grouped_text(s.restarts),
               "How often accumulation has begun anew since the program started.");
    if (s.relit > 0)
        number_row("Relit", grouped_text(s.relit),
                   "Edits of light since the last restart that have scaled the image: its samples go on.");
    number_row("Threads", std::to_string(s.threads), "Workers that trace rays.");
    ImGui::EndTable();
}

void draw_structure(const RenderStatistics& s, float width) {
    if (!begin_number_table("structure", width)) return;
    const AccelStats& a = s.accel;
    const auto ratio = [](std::uint64_t count, std::uint64_t of) {
        return of > 0 ? fmt::format("{:.2f}", static_cast<double>(count) / static_cast<double>(of)) : "-";
    };
    number_row("Build", duration_text(s.build_seconds),
               "Time to derive all that the renderer needs from the last edit, trees included.");
    number_row("Primitives", grouped_text(a.primitives), "Shapes and triangles; an instanced mesh counts once.");
    number_row("Nodes", grouped_text(a.nodes), "Inner nodes and leaves of all trees.");
    number_row("Leaves", grouped_text(a.leaves), "Leaves of all trees.");
    number_row("Depth", std::to_string(a.depth), "Of the deepest leaf.");
    number_row("Refs a primitive", ratio(a.references, a.primitives),
               "How often a primitive lies in a leaf, on average: 1 means that none was cut by a plane.");
    number_row("Tree memory", quantity_text(static_cast<double>(a.memory_bytes), "B"),
               "Of the acceleration structure.");
    number_row("Refs a leaf", ratio(a.references, a.leaves), "Primitives that a ray meets in a leaf, on average.");
    number_row("References", grouped_text(a.references),
               "Primitives over all leaves: one that is cut by a plane lies in several.");
    ImGui::EndTable();
}

void draw_plot(Editor& editor, float width) {
    const ConvergenceHistory& history = editor.convergence();
    ImGui::BeginGroup();
    if (history.samples.size() < 2) {
        ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
        hint("The error of the image appears here as it falls, once a few samples are there.");
        ImGui::PopTextWrapPos();
        ImGui::EndGroup();
        return;
    }
    bool& over_time = editor.panels.plot_over_time;
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("Error over");
    tooltip(kErrorTip);
    ImGui::SameLine();
    if (ImGui::RadioButton("samples", !over_time)) over_time = false;
    tooltip("Plots the error against samples a pixel.");
    ImGui::SameLine();
    if (ImGui::RadioButton("seconds", over_time)) over_time = true;
    tooltip("Plots the error against seconds of rendering.");
    const float height = std::max(6 * ImGui::GetFontSize(), ImGui::GetContentRegionAvail().y - 2);
    const std::vector<double>& xs = over_time ? history.seconds : history.samples;
    ImPlot::PushStyleVar(ImPlotStyleVar_PlotPadding, {6, 4});
    ImPlot::PushStyleVar(ImPlotStyleVar_LabelPadding, {4, 2});
    if (ImPlot::BeginPlot("##convergence", {width, height},
                          ImPlotFlags_NoLegend | ImPlotFlags_NoMenus | ImPlotFlags_NoMouseText)) {
        const auto [lowest, highest] = std::ranges::minmax(history.error);
        ImPlot::SetupAxes(nullptr, nullptr, ImPlotAxisFlags_NoHighlight, ImPlotAxisFlags_NoHighlight);
        ImPlot::SetupAxisScale(ImAxis_X1, ImPlotScale_Log10);
        ImPlot::SetupAxisScale(ImAxis_Y1, ImPlotScale_Log10);
        ImPlot::SetupAxesLimits(xs.front(), xs.back(), 0.8 * lowest, 1.25 * highest, ImPlotCond_Always);
        const int count = static_cast<int>(xs.size());
        // The slope that independent samples have, through the newest point.
        const double guide_x[] = {xs.front(), xs.back()};
        const double guide_y[] = {history.error.back() * xs.back() / xs.front(), history.error.back()};
        ImPlot::PlotLine("1/N", guide_x, guide_y, 2, {ImPlotProp_LineColor, ImVec4(0.5f, 0.5f, 0.5f, 0.5f)});
        ImPlot::PlotLine("error", xs.data(), history.error.data(), count,
                         {ImPlotProp_LineColor, to_imgui(theme::kAccent), ImPlotProp_LineWeight, 2.0f});
        if (ImPlot::IsPlotHovered())
            ImGui::SetTooltip(
                "%s", "The grey line is the slope of independent samples: half the error for twice the samples.");
        ImPlot::EndPlot();
    }
    ImPlot::PopStyleVar(2);
    ImGui::EndGroup();
}

}  // namespace

void draw_statistics_panel(Editor& editor) {
    if (!editor.frame()) {
        hint("Numbers appear here with the first image.");
        return;
    }
    const RenderStatistics& statistics = editor.frame()->statistics;
    const float available = ImGui::GetContentRegionAvail().x, spacing = ImGui::GetStyle().ItemSpacing.x;
    // Side by side where there is room, as at the bottom of the window; else one below the other.
    const bool wide = available > 38 * ImGui::GetFontSize();
    const float column = wide ? (available - 4 * spacing) * 0.3f : available;
    draw_rendering(statistics, column);
    if (wide) ImGui::SameLine(0, 2 * spacing);
    draw_structure(statistics, column);
    if (wide) ImGui::SameLine(0, 2 * spacing);
    draw_plot(editor, wide ? ImGui::GetContentRegionAvail().x : available);
}

}  // namespace rayuela
