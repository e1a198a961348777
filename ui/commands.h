#pragma once

#include "ui/editor.h"

#include <functional>
#include <span>
#include <string>

namespace rayuela {

/// The menus, from left to right.
inline constexpr const char* kMenus[] = {"File", "Edit", "Add", "View", "Render", "Help"};

/// Something a person can ask for. Menus, shortcuts, the Help window and the tests loop over `commands()`.
struct Command {
    const char* menu;  ///< One of kMenus.
    const char* name;
    const char* tip;
    int shortcut = 0;     ///< ImGuiKeyChord; 0 where there is none.
    int alternative = 0;  ///< Another ImGuiKeyChord for the same.
    std::function<void(Editor&)> run;
    std::function<bool(const Editor&)> enabled = {};       ///< Empty: always.
    std::function<bool(const Editor&)> checked = {};       ///< Empty: not a toggle.
    std::function<std::string(const Editor&)> label = {};  ///< Shown instead of the name. Empty: the name.
    bool starts_group = false;                             ///< A line above it in the menu.
};

std::span<const Command> commands();
/// Null where there is none of that name.
const Command* find_command(std::string_view name);
/// Runs it if it is enabled.
void run(const Command& command, Editor& editor);
/// "Ctrl+Shift+Z"; empty for 0.
std::string shortcut_text(int shortcut);

/// Draws the main menu bar and the dialogs (files, unsaved changes, help), and runs the command whose shortcut was pressed
/// (unless a text field has the keyboard or a mouse button is held).
void draw_menu_bar(Editor& editor);

}  // namespace rayuela
