# rayuela_glad, rayuela_imgui (docking, OpenGL3 and GLFW backends, ImPlot, ImGuizmo), rayuela_imgui_test_engine.
# A package manager's packages come first; Debian's ImGui is too old (no docking), so the sources otherwise come from
# the archive of a PyPI package that carries them all, pinned by its hash.

set(IMGUI_BUNDLE_VERSION 1.93.0)
set(IMGUI_BUNDLE_SHA256 10ad1dab8258a6787b4f07bb926b08d0efc648a7906242568c8dd778c5e719bf)

find_package(imgui CONFIG QUIET)
find_package(implot CONFIG QUIET)
find_package(imguizmo CONFIG QUIET)
find_package(glad CONFIG QUIET)
if(TARGET imgui::imgui AND TARGET implot::implot AND TARGET imguizmo::imguizmo AND TARGET glad::glad)
    add_library(rayuela_glad INTERFACE)
    target_link_libraries(rayuela_glad INTERFACE glad::glad)
    add_library(rayuela_imgui INTERFACE)
    target_link_libraries(rayuela_imgui INTERFACE imgui::imgui implot::implot imguizmo::imguizmo)
    add_library(rayuela_imgui_test_engine INTERFACE)  # the feature "test-engine" puts it into imgui itself
    target_link_libraries(rayuela_imgui_test_engine INTERFACE rayuela_imgui)
    return()
endif()

# Beside the sources, not in the build folder: one download and one copy for every preset.
set(downloads ${PROJECT_SOURCE_DIR}/build/downloads)
set(archive ${downloads}/imgui_bundle-${IMGUI_BUNDLE_VERSION}.tar.gz)
set(deps ${PROJECT_SOURCE_DIR}/build/deps/imgui_bundle-${IMGUI_BUNDLE_VERSION})

function(rayuela_download_imgui)
    message(STATUS "Downloading imgui-bundle ${IMGUI_BUNDLE_VERSION} (Dear ImGui, ImPlot, ImGuizmo) from PyPI")
    find_package(Python3 REQUIRED COMPONENTS Interpreter)
    file(MAKE_DIRECTORY ${downloads}/partial)
    file(WRITE ${downloads}/partial/requirements.txt
         "imgui-bundle==${IMGUI_BUNDLE_VERSION} --hash=sha256:${IMGUI_BUNDLE_SHA256}\n")
    execute_process(
        COMMAND ${Python3_EXECUTABLE} -m pip download --quiet --no-deps --no-binary imgui-bundle
                --require-hashes -r requirements.txt -d .
        WORKING_DIRECTORY ${downloads}/partial RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "pip could not download imgui-bundle ${IMGUI_BUNDLE_VERSION} (is python3-pip installed, is "
                            "PyPI reachable?). Or put its source archive at ${archive}.")
    endif()
    file(GLOB file ${downloads}/partial/imgui_bundle-*.tar.gz)
    file(RENAME ${file} ${archive})
    file(REMOVE_RECURSE ${downloads}/partial)
endfunction()

file(MAKE_DIRECTORY ${downloads})
file(LOCK ${downloads} DIRECTORY GUARD FILE TIMEOUT 600)
if(NOT EXISTS ${deps})
    if(EXISTS ${archive})
        file(SHA256 ${archive} sha256)
        if(NOT sha256 STREQUAL IMGUI_BUNDLE_SHA256)
            message(WARNING "${archive} is damaged: downloading it again")
            file(REMOVE ${archive})
        endif()
    endif()
    if(NOT EXISTS ${archive})
        rayuela_download_imgui()
    endif()
    set(top imgui_bundle-${IMGUI_BUNDLE_VERSION})
    file(REMOVE_RECURSE ${deps}.partial)
    file(ARCHIVE_EXTRACT INPUT ${archive} DESTINATION ${deps}.partial PATTERNS
         ${top}/LICENSE ${top}/external/imgui/imgui/* ${top}/external/implot/implot/* ${top}/external/ImGuizmo/ImGuizmo/*
         ${top}/external/imgui_test_engine/imgui_test_engine/*
         ${top}/external/hello_imgui/hello_imgui/external/OpenGL_Loaders/glad/*)
    file(RENAME ${deps}.partial ${deps})
endif()
file(LOCK ${downloads} DIRECTORY RELEASE)

set(external ${deps}/imgui_bundle-${IMGUI_BUNDLE_VERSION}/external)
set(imgui ${external}/imgui/imgui)
set(implot ${external}/implot/implot)
set(imguizmo ${external}/ImGuizmo/ImGuizmo/src)
set(test_engine ${external}/imgui_test_engine/imgui_test_engine)
set(glad ${external}/hello_imgui/hello_imgui/external/OpenGL_Loaders/glad)

add_library(rayuela_glad STATIC ${glad}/src/glad.c)
target_include_directories(rayuela_glad SYSTEM PUBLIC ${glad}/include)
target_link_libraries(rayuela_glad PUBLIC ${CMAKE_DL_LIBS})

add_library(rayuela_imgui STATIC
    ${imgui}/imgui.cpp ${imgui}/imgui_draw.cpp ${imgui}/imgui_tables.cpp ${imgui}/imgui_widgets.cpp
    ${imgui}/imgui_demo.cpp ${imgui}/imgui_stacklayout.cpp ${imgui}/misc/cpp/imgui_stdlib.cpp
    ${imgui}/backends/imgui_impl_glfw.cpp ${imgui}/backends/imgui_impl_opengl3.cpp
    ${implot}/implot.cpp ${implot}/implot_items.cpp ${imguizmo}/ImGuizmo.cpp
    ${PROJECT_SOURCE_DIR}/cmake/imgui_test_engine_hooks.cpp)
target_include_directories(rayuela_imgui SYSTEM PUBLIC ${imgui} ${imgui}/backends ${imgui}/misc/cpp ${implot} ${imguizmo})
target_compile_definitions(rayuela_imgui PUBLIC IMGUI_IMPL_OPENGL_LOADER_CUSTOM IMGUI_ENABLE_TEST_ENGINE)
target_link_libraries(rayuela_imgui PUBLIC glfw rayuela_glad)
set_source_files_properties(${imgui}/backends/imgui_impl_opengl3.cpp PROPERTIES
    COMPILE_OPTIONS "-include;glad/glad.h")

file(GLOB test_engine_sources ${test_engine}/imgui_test_engine/*.cpp)
add_library(rayuela_imgui_test_engine STATIC EXCLUDE_FROM_ALL ${test_engine_sources})
target_include_directories(rayuela_imgui_test_engine SYSTEM PUBLIC ${test_engine} ${test_engine}/imgui_test_engine)
target_compile_definitions(rayuela_imgui_test_engine PUBLIC
    IMGUI_TEST_ENGINE_ENABLE_COROUTINE_STDTHREAD_IMPL=1 IMGUI_TEST_ENGINE_ENABLE_STD_FUNCTION=1)
target_link_libraries(rayuela_imgui_test_engine PUBLIC rayuela_imgui Threads::Threads)

foreach(target rayuela_glad rayuela_imgui rayuela_imgui_test_engine)
    target_compile_options(${target} PRIVATE -w)
endforeach()
