#pragma once

#include "ui/editor.h"

namespace rayuela {

/// The questions for a file that menus and panels ask; the answer acts on the editor, which must live on.

void open_dialog(Editor& editor);
void save_as_dialog(Editor& editor);
/// Saves to the scene's own file, or asks for one where it has none; once it is saved, `then` is done.
void save_or_ask(Editor& editor);
void save_and_then(Editor& editor, std::function<void(Editor&)> then);
void import_dialog(Editor& editor);
void save_image_dialog(Editor& editor);
void object_file_dialog(Editor& editor, ObjectId id);
void texture_dialog(Editor& editor, MaterialId id, std::string key);
void environment_dialog(Editor& editor);

/// Draws the dialog if it is open, with the folders that the person uses beside it.
void draw_file_dialog(Editor& editor);

}  // namespace rayuela
