#pragma once

/// Code points of Font Awesome 6 (solid), merged into the user interface's font.
namespace rayuela::icon {

inline constexpr const char* kSphere = "\uf111";    // circle
inline constexpr const char* kPlane = "\uf5fd";     // layer-group
inline constexpr const char* kBox = "\uf1b2";       // cube
inline constexpr const char* kTriangle = "\uf0d8";  // caret-up
inline constexpr const char* kQuad = "\uf0c8";      // square
inline constexpr const char* kGroup = "\uf07b";     // folder
inline constexpr const char* kMesh = "\uf5ee";      // draw-polygon
inline constexpr const char* kGltf = "\uf1b3";      // cubes
inline constexpr const char* kVisible = "\uf06e";   // eye
inline constexpr const char* kHidden = "\uf070";    // eye-slash
inline constexpr const char* kAdd = "\uf067";       // plus
inline constexpr const char* kDelete = "\uf2ed";    // trash-can
inline constexpr const char* kCopy = "\uf0c5";      // copy
inline constexpr const char* kPause = "\uf04c";     // pause
inline constexpr const char* kPlay = "\uf04b";      // play
inline constexpr const char* kRestart = "\uf2f9";   // rotate-right
inline constexpr const char* kOpen = "\uf07c";      // folder-open
inline constexpr const char* kImage = "\uf03e";     // image
inline constexpr const char* kClose = "\uf00d";     // xmark
inline constexpr const char* kSearch = "\uf002";    // magnifying-glass
inline constexpr const char* kWarning = "\uf071";   // triangle-exclamation
inline constexpr const char* kInfo = "\uf05a";      // circle-info
inline constexpr const char* kError = "\uf06a";     // circle-exclamation
inline constexpr const char* kFile = "\uf15b";      // file
inline constexpr const char* kUp = "\uf062";        // arrow-up
inline constexpr const char* kFrame = "\uf05b";     // crosshairs
inline constexpr const char* kSun = "\uf185";       // sun
inline constexpr const char* kPen = "\uf304";       // pen
inline constexpr const char* kLink = "\uf0c1";      // link

inline constexpr const char* kMove = "\uf047";      // up-down-left-right
inline constexpr const char* kRotate = "\uf021";    // arrows-rotate
inline constexpr const char* kScale = "\uf424";     // up-right-and-down-left-from-center
inline constexpr const char* kPointer = "\uf245";   // arrow-pointer
inline constexpr const char* kFit = "\uf065";       // expand
inline constexpr const char* kOutline = "\uf5cb";   // vector-square
inline constexpr const char* kPalette = "\uf53f";   // palette
inline constexpr const char* kKeyboard = "\uf11c";  // keyboard

}  // namespace rayuela::icon
