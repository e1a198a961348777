#pragma once

#include "ui/editor.h"

namespace rayuela {

/// What menus, panels and shortcuts do to objects and materials: each is one step of undo.

const char* shape_icon(const Shape& shape);
/// The colour by which a person recognises a material.
Color swatch_color(const Material& material);
/// How many objects use it.
int user_count(const Scene& scene, MaterialId id);

/// Adds the shape where the camera looks, in a size that suits the view, into the selected list if one is, and selects
/// it. A shape that comes from a file asks for that file instead.
void add_object(Editor& editor, const Shape& shape);
void duplicate_selection(Editor& editor);
void delete_selection(Editor& editor);
void set_visible(Editor& editor, ObjectId id, bool visible);
void rename_object(Editor& editor, ObjectId id, const std::string& name);
/// Puts the object into a list (none: to the top level) without moving it in the world.
void move_into(Editor& editor, ObjectId id, ObjectId list);
void assign_material(Editor& editor, ObjectId id, MaterialId material);
/// Adds a material and assigns it to the selected object, or selects it in the list where none is.
void add_material(Editor& editor, const std::string& name, const Material& material);
void frame_bounds_of(Editor& editor, std::optional<ObjectId> id);

}  // namespace rayuela
