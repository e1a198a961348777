#pragma once

#include "ui/editor.h"

namespace rayuela {

/// Which material the object has, and that material's fields.
void draw_object_material(Editor& editor, const Object& object);
/// All materials with swatches and how many objects use each; the selected one can be edited below.
void draw_material_list(Editor& editor);

}  // namespace rayuela
