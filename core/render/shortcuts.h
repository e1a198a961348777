#pragma once

#include <string_view>

namespace rayuela {

/// Work that is left out though the image is the same with it, to the last bit. Each can be put back, to see what it costs.
struct Shortcuts {
    bool few_objects = true;
    bool any_hit = true;
    bool black_shadow_rays = true;
    bool lamp_blocks = true;
    bool lobe_blocks = true;
    bool ready_materials = true;
    bool passing_rays = true;
    bool no_sky = true;
    bool no_light = true;
    bool no_lens = true;

    bool operator==(const Shortcuts&) const = default;
};

struct ShortcutField {
    std::string_view key;  ///< In files and on the command line.
    bool Shortcuts::*member;
    std::string_view put_back;  ///< What is done once it is put back, for a person.
};

/// One list: the panel, the command line, benchmarks and tests loop over it.
inline constexpr ShortcutField kShortcuts[] = {
    {"few_objects", &Shortcuts::few_objects, "All objects stand in a tree, however few or large they are."},
    {"any_hit", &Shortcuts::any_hit, "Shadow rays of camera paths look for the nearest hit instead of any."},
    {"black_shadow_rays", &Shortcuts::black_shadow_rays,
     "Shadow rays are traced even where their light would be black."},
    {"lamp_blocks", &Shortcuts::lamp_blocks, "Points on lamps are chosen one by one."},
    {"lobe_blocks", &Shortcuts::lobe_blocks, "Surfaces are shaded one by one."},
    {"ready_materials", &Shortcuts::ready_materials,
     "Materials are worked out at every hit, with texture coordinates."},
    {"passing_rays", &Shortcuts::passing_rays,
     "Camera rays are traced even where they pass the bounds of all objects by."},
    {"no_sky", &Shortcuts::no_sky, "Rays that leave the scene look up a black sky."},
    {"no_light", &Shortcuts::no_light, "Paths bounce on though there is no light to find."},
    {"no_lens", &Shortcuts::no_lens, "Points on a lens without extent are drawn."},
};

constexpr const ShortcutField* shortcut_of(bool Shortcuts::*member) {
    for (const ShortcutField& field : kShortcuts) {
        if (field.member == member) return &field;
    }
    return nullptr;
}

}  // namespace rayuela
