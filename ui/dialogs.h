#pragma once

#include "ui/editor.h"

namespace rayuela {

/// The windows that are open above the panels: file dialog, "save changes?", quick start, shortcuts, about.
void draw_dialogs(Editor& editor);

}  // namespace rayuela
