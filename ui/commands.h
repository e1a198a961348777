#pragma once

#include "ui/editor.h"

#include <functional>
#include <span>

namespace rayuela {

/// Something a person can ask for. Menus, shortcuts, the Help window and the tests loop over `commands()`.
struct Command {
    const char* menu;  ///< "File", "Edit", "Add", "View", "Render", "Help"; empty: not in a menu.
    const char* name;
    const char* tip;
    int shortcut = 0;  ///< ImGuiKeyChord; 0 where there is none.
    std::function<void(Editor&)> run;
    std::function<bool(const Editor&)> enabled;  ///< Empty: always.
    std::function<bool(const Editor&)> checked;  ///< Empty: not a toggle.
};

std::span<const Command> commands();

/// Draws the main menu bar and the dialogs (files, unsaved changes, help), and runs the command whose shortcut was pressed
/// (unless a text field has the keyboard).
void draw_menu_bar(Editor& editor);

}  // namespace rayuela
