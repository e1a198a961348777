# Flags of our own targets, through the interface target rayuela_options. Dependencies are SYSTEM and not affected.

set(RAYUELA_SANITIZE "" CACHE STRING "Sanitizers for all targets, for example: address,undefined")
option(RAYUELA_FUZZ "Instrument for libFuzzer and build tests/fuzz (clang only)" OFF)

# The code is kept free of warnings on these; what a newer compiler finds must not stop somebody's first build.
set(werror OFF)
if((CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
   OR (CMAKE_CXX_COMPILER_ID STREQUAL Clang AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15))
    set(werror ON)
endif()
option(RAYUELA_WERROR "Treat warnings of our own targets as errors" ${werror})

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_COLOR_DIAGNOSTICS ON)
set(CMAKE_INTERPROCEDURAL_OPTIMIZATION OFF)
set(THREADS_PREFER_PTHREAD_FLAG ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # Debug information names the build folder; without NOHASHDIR two build folders would never share an object.
    set(launcher ${CMAKE_COMMAND} -E env CCACHE_NOHASHDIR=1 ${CCACHE_PROGRAM})
    set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
    set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()

if(RAYUELA_SANITIZE)
    string(REGEX MATCH "undefined" has_ubsan "${RAYUELA_SANITIZE}")
    set(sanitize_flags -fsanitize=${RAYUELA_SANITIZE} -fno-omit-frame-pointer)
    if(has_ubsan)
        list(APPEND sanitize_flags -fsanitize=float-cast-overflow -fno-sanitize-recover=all)
    endif()
    add_link_options(${sanitize_flags})
endif()
if(RAYUELA_FUZZ)
    if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
        message(FATAL_ERROR "RAYUELA_FUZZ needs clang: use the preset 'fuzz'")
    endif()
    list(APPEND sanitize_flags -fsanitize=fuzzer-no-link)
    add_link_options(-fsanitize=fuzzer-no-link)
endif()

add_library(rayuela_options INTERFACE)
target_compile_options(rayuela_options INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wfloat-conversion -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align
    -Wextra-semi -Wimplicit-fallthrough
    # Structs name the fields they set; the others have their defaults.
    -Wno-missing-field-initializers
    # Contraction breaks the watertight triangle test; where an fma is wanted, the source says std::fma.
    -ffp-contract=off
    # Only ours: Dear ImGui's sources, which are built here too, would take minutes and gigabytes.
    ${sanitize_flags})
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # False positives of GCC 12 and 13 on std::string (GCC bug 105651) and on std::optional.
    target_compile_options(rayuela_options INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
endif()
if(RAYUELA_WERROR)
    target_compile_options(rayuela_options INTERFACE -Werror)
endif()
find_package(Threads REQUIRED)
target_link_libraries(rayuela_options INTERFACE Threads::Threads)
if(RAYUELA_SANITIZE MATCHES thread)
    target_compile_definitions(rayuela_options INTERFACE RAYUELA_TSAN)
endif()
