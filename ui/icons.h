#pragma once

/// Glyphs of Font Awesome 6 (solid), which the theme merges into every font.
namespace rayuela::icon {

inline constexpr const char* kMove = "\uf047";
inline constexpr const char* kRotate = "\uf2f1";
inline constexpr const char* kScale = "\uf424";
inline constexpr const char* kPointer = "\uf245";
inline constexpr const char* kPlay = "\uf04b";
inline constexpr const char* kPause = "\uf04c";
inline constexpr const char* kRestart = "\uf2ea";
inline constexpr const char* kFit = "\uf0b2";
inline constexpr const char* kFrame = "\uf05b";
inline constexpr const char* kOutline = "\uf248";
inline constexpr const char* kSun = "\uf185";
inline constexpr const char* kPalette = "\uf53f";
inline constexpr const char* kEye = "\uf06e";
inline constexpr const char* kEyeSlash = "\uf070";
inline constexpr const char* kCube = "\uf1b2";
inline constexpr const char* kCamera = "\uf030";
inline constexpr const char* kLayers = "\uf5fd";
inline constexpr const char* kSliders = "\uf1de";
inline constexpr const char* kChart = "\uf201";
inline constexpr const char* kList = "\uf03a";
inline constexpr const char* kPlus = "\u002b";
inline constexpr const char* kTrash = "\uf1f8";
inline constexpr const char* kCopy = "\uf0c5";
inline constexpr const char* kWarning = "\uf071";
inline constexpr const char* kError = "\uf057";
inline constexpr const char* kInfo = "\uf05a";
inline constexpr const char* kFolder = "\uf07c";
inline constexpr const char* kSave = "\uf0c7";
inline constexpr const char* kImage = "\uf03e";
inline constexpr const char* kUndo = "\uf2ea";
inline constexpr const char* kMouse = "\uf8cc";
inline constexpr const char* kCheck = "\uf00c";
inline constexpr const char* kStop = "\uf04d";
inline constexpr const char* kCrosshairs = "\uf05b";

}  // namespace rayuela::icon
