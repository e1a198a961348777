#pragma once

#include <span>
#include <string_view>

namespace rayuela {

/// Text of shaders/<name>, for example "display.frag". Empty when there is no such file.
std::string_view embedded_shader(std::string_view name);

/// Bytes of assets/fonts/<name>. They end with the program, so ImGui must not free them. Empty when there is no such file.
std::span<const unsigned char> embedded_font(std::string_view name);

/// Bytes of assets/icons/<name>. Empty when there is no such file.
std::span<const unsigned char> embedded_icon(std::string_view name);

}  // namespace rayuela
