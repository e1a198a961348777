#include "ui/icons.h"
#include "ui/number_text.h"
#include "ui/panels/number_table.h"
#include "ui/panels/panels.h"
#include "ui/widgets.h"

#include <fmt/format.h>

namespace rayuela {
namespace {

const Vec4* alarm(std::uint64_t count) {
    return count > 0 ? &theme::kError : nullptr;
}

void rejection_row(const RenderStatistics& statistics, Rejection cause, const char* name, const char* tip) {
    const std::uint64_t count = statistics.rejected[static_cast<std::size_t>(cause)];
    number_row(name, grouped_text(count), tip, alarm(count));
}

void draw_rejected(const RenderStatistics& statistics, float width) {
    if (!begin_number_table("rejected", width, 0.6f)) return;
    rejection_row(
        statistics, Rejection::nan, "Not a number",
        "Samples since the last restart that were left out of the image because a channel was not a number (film: "
        "what makes no sense is counted, never hidden). Counted for every sample, those of light paths "
        "included. Zero is right. The map of rejections shows where.");
    rejection_row(statistics, Rejection::infinite, "Infinite",
                  "Samples left out because a channel was infinite: a division by a density that rounded to zero, or "
                  "radiance beyond what a float holds. Counted for every sample. Zero is right.");
    rejection_row(statistics, Rejection::negative, "Negative",
                  "Samples left out because a channel was below zero, which light cannot be. Counted for every sample. "
                  "Zero is right.");
    ImGui::EndTable();
}

/// "-" before anything is measured.
std::string of_text(const PathHealth* health, std::uint64_t PathHealth::*count, std::uint64_t PathHealth::*of) {
    return health ? fmt::format("{} of {}", grouped_text(health->*count), count_text(static_cast<double>(health->*of)))
                  : "-";
}

void draw_measured(const PathHealth* health, float width) {
    if (!begin_number_table("measured", width, 1)) return;
    const auto row = [&](const char* name, std::uint64_t PathHealth::*count, std::uint64_t PathHealth::*of,
                         const char* tip) {
        number_row(name, of_text(health, count, of), tip, alarm(health ? health->*count : 0));
    };
    row("Self-hits", &PathHealth::self_hits, &PathHealth::scattered_rays,
        "Scattered rays that met the very surface they had left (shading and offsets: acne). Measured on demand, on "
        "paths "
        "spread over the image; the renderer does not test for it, because its rays start beyond the error bound of "
        "their origin. Zero is right.");
    row("Left closed object", &PathHealth::left_closed, &PathHealth::inner_rays,
        "Rays that set off into a sphere or box and came out without meeting its surface (shading and offsets: leaks). "
        "Measured on demand, on paths spread over the image, against the exit found in double. Meshes are not judged: "
        "few of them are closed. Zero is right.");
    number_row("Pdf <= 0", of_text(health, &PathHealth::without_pdf, &PathHealth::draws),
               "Directions drawn from the scene's materials that were not used because they lay under the surface or "
               "their density was zero, infinite or not a number (sampling: extreme values). Measured on demand; while "
               "rendering such a path ends there and is not counted. A few are normal at grazing angles of rough "
               "materials: that light is lost, not wrong.");
    row("Energy above 1", &PathHealth::above_one, &PathHealth::energy_tests,
        "Materials, seen under several angles, that send back more light than they receive (furnace test), by more "
        "than "
        "four standard errors of 4096 draws each. Measured on demand; textures at their middle. Zero is right.");
    number_row(
        "Highest share", health ? fmt::format("{:.4f}", health->highest_share) : "-",
        "The largest share of light that any material sends back in any of these tests; by chance it may exceed 1 "
        "a little.");
    ImGui::EndTable();
}

void draw_measure_button(Health& health, float width) {
    ImGui::BeginDisabled(health.is_measuring());
    if (ImGui::Button(health.is_measuring() ? "Measuring...###measure" : "Measure paths###measure", {width, 0}))
        health.measure();
    ImGui::EndDisabled();
    tooltip(
        "Follows 20 000 paths of this scene in the background and draws from its materials, and counts what goes "
        "wrong. "
        "Rendering goes on. The counts hold until the scene changes.");
}

void draw_map_choice(ViewSettings& view, float width) {
    ImGui::SetNextItemWidth(width);
    if (ImGui::BeginCombo("##map", kViewMaps[static_cast<std::size_t>(view.map)].name)) {
        for (std::size_t i = 0; i < std::size(kViewMaps); ++i) {
            const auto map = static_cast<ViewMap>(i);
            if (ImGui::Selectable(kViewMaps[i].name, view.map == map)) view.map = map;
            tooltip(kViewMaps[i].tip);
        }
        ImGui::EndCombo();
    }
    tooltip(
        "What the viewport shows: the image, or a number of each pixel. Maps are worked out in the background, while "
        "they are looked at; the image is never restarted.");
}

void draw_replay_choice(Health& health) {
    ImGui::Checkbox("Replay clicked pixel###replay", &health.replays);
    tooltip(
        "While this is on, a click in the image traces one sample of that pixel again and shows what it met, instead "
        "of "
        "selecting an object.");
    if (!health.replays) return;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(7 * ImGui::GetFontSize());
    if (ImGui::InputInt("##sample", &health.replayed_sample))
        health.replayed_sample = std::max(health.replayed_sample, 0);
    tooltip(
        "Which sample of the pixel, counted from 0. Every sample depends on its pixel and number alone, so that any "
        "of them can be traced again.");
    const Replay* const replay = health.replayed();
    if (!replay) return;
    ImGui::SameLine();
    const bool copies = icon_button(icon::kCopy, "copy",
                                    "Copies the path as text: what `rayuela render SCENE --replay x,y,sample` prints.");
    if (copies) ImGui::SetClipboardText(to_text(*replay).c_str());
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    const std::string found =
        fmt::format("{}, {}: {}", health.replayed_pixel.x, health.replayed_pixel.y, to_text(replay->radiance));
    ImGui::TextDisabled("%s", found.c_str());
    tooltip("The pixel, and the radiance that this sample brings to it.");
}

void draw_cell(const std::string& text) {
    ImGui::PushFont(mono_font(), 0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopFont();
}

void draw_replay(const Replay& replay) {
    constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_ScrollX | ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg |
                                       ImGuiTableFlags_BordersInnerV | ImGuiTableFlags_Resizable |
                                       ImGuiTableFlags_SizingFixedFit;
    const float height = std::max(ImGui::GetContentRegionAvail().y, 6 * ImGui::GetTextLineHeightWithSpacing());
    if (!ImGui::BeginTable("path", static_cast<int>(kReplayFields.size()) + 1, kFlags, {0, height})) return;
    ImGui::TableSetupScrollFreeze(1, 1);
    ImGui::TableSetupColumn("bounce");
    for (const ReplayField& field : kReplayFields) ImGui::TableSetupColumn(field.name);
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    ImGui::TableNextColumn();
    ImGui::TableHeader("bounce");
    tooltip("How often the path has been scattered before.");
    for (const ReplayField& field : kReplayFields) {
        ImGui::TableNextColumn();
        ImGui::TableHeader(field.name);
        tooltip(field.tip);
    }
    for (const ReplayRow& row : replay.rows) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        draw_cell(std::to_string(row.bounce));
        for (const ReplayField& field : kReplayFields) {
            ImGui::TableNextColumn();
            draw_cell(row.*field.text);
        }
    }
    ImGui::EndTable();
}

void draw_path(Health& health) {
    ImGui::BeginGroup();
    draw_replay_choice(health);
    if (health.replayed()) {
        draw_replay(*health.replayed());
    } else if (health.replays) {
        hint("Click a pixel of the image.");
    }
    ImGui::EndGroup();
}

}  // namespace

void draw_health_panel(Editor& editor) {
    if (!editor.frame()) {
        hint("Numbers appear here with the first image.");
        return;
    }
    const float available = ImGui::GetContentRegionAvail().x, unit = ImGui::GetFontSize();
    if (available > 40 * unit) {
        const float gap = 2 * ImGui::GetStyle().ItemSpacing.x;
        ImGui::BeginGroup();
        draw_rejected(editor.frame()->statistics, 10.5f * unit);
        draw_measure_button(editor.health, 10.5f * unit);
        draw_map_choice(editor.view, 10.5f * unit);
        ImGui::EndGroup();
        ImGui::SameLine(0, gap);
        draw_measured(editor.health.measured(), 17 * unit);
        ImGui::SameLine(0, gap);
        draw_path(editor.health);
    } else {
        const float half = 0.5f * (available - ImGui::GetStyle().ItemSpacing.x);
        draw_measure_button(editor.health, half);
        ImGui::SameLine();
        draw_map_choice(editor.view, half);
        draw_path(editor.health);
        draw_rejected(editor.frame()->statistics, available);
        draw_measured(editor.health.measured(), available);
    }
}

}  // namespace rayuela
