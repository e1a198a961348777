#include "ui/plot_image.h"

#include "ui/imgui_session.h"
#include "ui/theme.h"

#include <imgui.h>
#include <imgui_impl_opengl3.h>
#include <implot.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayuela {

namespace {

constexpr glm::ivec2 kPanelSize{520, 400};

/// What an axis shows: a little more than what is drawn, as seen on a logarithmic scale.
struct Range {
    double low = std::numeric_limits<double>::infinity(), high = 0;

    void enclose(const std::vector<double>& values) {
        for (const double value : values) {
            if (!(value > 0)) continue;
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    double margin() const { return std::pow(std::max(high / low, 1.1), 0.03); }
};

void setup_axes(const PlotPanel& panel) {
    Range x, y;
    for (const PlotCurve& curve : panel.curves) {
        x.enclose(curve.x);
        y.enclose(curve.low);
        y.enclose(curve.high);
    }
    ImPlot::SetupAxisScale(ImAxis_X1, ImPlotScale_Log10);
    ImPlot::SetupAxisScale(ImAxis_Y1, ImPlotScale_Log10);
    if (x.high == 0 || y.high == 0) return;
    ImPlot::SetupAxesLimits(x.low / x.margin(), x.high * x.margin(), y.low / y.margin(), y.high * y.margin(),
                            ImPlotCond_Always);
}

void draw_panel(const PlotSheet& sheet, const PlotPanel& panel) {
    const ImVec2 size{static_cast<float>(kPanelSize.x), static_cast<float>(kPanelSize.y)};
    const ImPlotFlags flags = ImPlotFlags_NoMouseText | (sheet.has_legend() ? 0 : ImPlotFlags_NoLegend);
    if (!ImPlot::BeginPlot(panel.title.c_str(), size, flags)) return;
    ImPlot::SetupAxes(sheet.x_label.c_str(), sheet.y_label.c_str());
    setup_axes(panel);
    ImPlot::SetupLegend(ImPlotLocation_NorthEast);
    ImPlot::PlotLine("##guide", panel.guide_x.data(), panel.guide_y.data(), static_cast<int>(panel.guide_x.size()),
                     {ImPlotProp_LineColor, ImVec4(0.5f, 0.5f, 0.5f, 0.7f)});
    for (const PlotCurve& curve : panel.curves) {
        const ImVec4 color{curve.color.r, curve.color.g, curve.color.b, 1};
        const int count = static_cast<int>(curve.x.size());
        ImPlot::PlotShaded(curve.name.c_str(), curve.x.data(), curve.low.data(), curve.high.data(), count,
                           {ImPlotProp_FillColor, color, ImPlotProp_FillAlpha, 0.2f});
        ImPlot::PlotLine(curve.name.c_str(), curve.x.data(), curve.y.data(), count,
                         {ImPlotProp_LineColor, color, ImPlotProp_LineWeight, 2.0f, ImPlotProp_Marker,
                          ImPlotMarker_Circle, ImPlotProp_MarkerSize, 2.5f, ImPlotProp_MarkerFillColor, color});
    }
    ImPlot::EndPlot();
}

void draw_sheet(const PlotSheet& sheet, const ImVec2& size) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(size);
    ImGui::Begin("plots", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings);
    for (std::size_t i = 0; i < sheet.panels.size(); ++i) {
        if (i % static_cast<std::size_t>(sheet.columns) != 0) ImGui::SameLine();
        // Titles may repeat.
        ImGui::PushID(static_cast<int>(i));
        draw_panel(sheet, sheet.panels[i]);
        ImGui::PopID();
    }
    ImGui::End();
}

}  // namespace

Result<Image> plot_image(const PlotSheet& sheet) {
    const int rows = (static_cast<int>(sheet.panels.size()) + sheet.columns - 1) / sheet.columns;
    const glm::ivec2 size{sheet.columns * kPanelSize.x, rows * kPanelSize.y};
    const auto context = make_offscreen_context(size);
    if (!context) return tl::unexpected(context.error());
    const ImGuiSession session(**context, {});
    apply_theme(1);
    ImGui::StyleColorsLight();
    ImPlot::StyleColorsLight();
    ImGui::GetStyle().WindowPadding = ImGui::GetStyle().ItemSpacing = {0, 0};
    ImGui::GetIO().DisplaySize = {static_cast<float>(size.x), static_cast<float>(size.y)};
    // Plots find their sizes in the first frames.
    constexpr int kFrames = 3;
    for (int i = 0; i < kFrames; ++i) {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui::NewFrame();
        draw_sheet(sheet, ImGui::GetIO().DisplaySize);
        render_imgui(**context, {1, 1, 1});
    }
    return (*context)->read_pixels();
}

}  // namespace rayuela
