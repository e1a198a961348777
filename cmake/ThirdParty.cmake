# Every dependency as an imported or SYSTEM target. A package manager (vcpkg, Conan) is preferred where it has the
# package; else Debian's packages, and for Dear ImGui and friends a source archive (see ImGui.cmake).

find_package(PkgConfig REQUIRED)

# rayuela_pkg(<target> <pkg-config module>): an interface target from a .pc file, with SYSTEM includes.
function(rayuela_pkg target module)
    pkg_check_modules(${target} QUIET IMPORTED_TARGET ${module})
    if(${target}_FOUND)
        add_library(${target} INTERFACE)
        target_link_libraries(${target} INTERFACE PkgConfig::${target})
    endif()
endfunction()

function(rayuela_header_target target header)
    find_path(${target}_INCLUDE ${header} PATH_SUFFIXES ${ARGN} REQUIRED)
    add_library(${target} INTERFACE)
    target_include_directories(${target} SYSTEM INTERFACE ${${target}_INCLUDE})
endfunction()

find_package(glm REQUIRED)
find_package(fmt REQUIRED)
find_package(tl-expected REQUIRED)
find_package(TBB REQUIRED)
find_package(hwy REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenEXR QUIET REQUIRED)
find_package(CLI11 REQUIRED)
find_package(glfw3 3.3 REQUIRED)

# Debian builds these three as libraries; elsewhere they are single headers, whose implementation core/io then compiles.
rayuela_header_target(rayuela_stb stb_image.h stb)
find_library(STB_LIBRARY stb)
if(STB_LIBRARY)
    target_link_libraries(rayuela_stb INTERFACE ${STB_LIBRARY})
else()
    target_compile_definitions(rayuela_stb INTERFACE RAYUELA_STB_HEADER_ONLY)
endif()
find_package(TinyGLTF QUIET)
if(TARGET TinyGLTF::TinyGLTF)
    add_library(rayuela_tinygltf INTERFACE)
    target_link_libraries(rayuela_tinygltf INTERFACE TinyGLTF::TinyGLTF)
else()
    rayuela_header_target(rayuela_tinygltf tiny_gltf.h)
    target_compile_definitions(rayuela_tinygltf INTERFACE RAYUELA_TINYGLTF_HEADER_ONLY)
endif()
find_package(tinyobjloader QUIET)
if(TARGET tinyobjloader::tinyobjloader)
    add_library(rayuela_tinyobj INTERFACE)
    target_link_libraries(rayuela_tinyobj INTERFACE tinyobjloader::tinyobjloader)
else()
    rayuela_header_target(rayuela_tinyobj tiny_obj_loader.h)
    target_compile_definitions(rayuela_tinyobj INTERFACE RAYUELA_TINYOBJ_HEADER_ONLY)
endif()

# Off-screen OpenGL: OSMesa where Mesa still has it (before 25.1), EGL's surfaceless platform beside it or instead.
add_library(rayuela_offscreen_gl INTERFACE)
rayuela_pkg(rayuela_osmesa osmesa)
rayuela_pkg(rayuela_egl egl)
if(TARGET rayuela_osmesa)
    # Only its header: it is loaded at run time, when something is drawn off-screen.
    target_include_directories(rayuela_offscreen_gl SYSTEM INTERFACE
                               $<TARGET_PROPERTY:PkgConfig::rayuela_osmesa,INTERFACE_INCLUDE_DIRECTORIES>)
    target_link_libraries(rayuela_offscreen_gl INTERFACE ${CMAKE_DL_LIBS})
    target_compile_definitions(rayuela_offscreen_gl INTERFACE RAYUELA_HAS_OSMESA=1)
endif()
if(TARGET rayuela_egl)
    target_link_libraries(rayuela_offscreen_gl INTERFACE rayuela_egl)
    target_compile_definitions(rayuela_offscreen_gl INTERFACE RAYUELA_HAS_EGL=1)
endif()
if(NOT TARGET rayuela_osmesa AND NOT TARGET rayuela_egl)
    message(WARNING "Neither OSMesa nor EGL found: no off-screen drawing, so no screenshots and no UI tests")
endif()

include(ImGui)

find_package(embree 3 QUIET)  # A rival of `rayuela bench rays`, nothing else.
if(BUILD_TESTING)
    find_package(GTest REQUIRED)
endif()
