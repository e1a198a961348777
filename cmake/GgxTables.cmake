# The tables of core/materials/ggx_albedo.cpp, computed when the program is built.
add_executable(make_ggx_tables core/materials/tables/make_ggx_tables.cpp)
target_link_libraries(make_ggx_tables PRIVATE rayuela_options rayuela::shapes)
set(ggx_tables ${PROJECT_BINARY_DIR}/generated/ggx_tables.inc)
add_custom_command(OUTPUT ${ggx_tables}
                   COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/generated
                   COMMAND make_ggx_tables ${ggx_tables}
                   DEPENDS make_ggx_tables
                   VERBATIM)
target_sources(rayuela_materials PRIVATE ${ggx_tables})
target_include_directories(rayuela_materials PRIVATE ${PROJECT_BINARY_DIR}/generated)
