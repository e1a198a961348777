# The dragon is too large to keep in the repository, so the build makes it, where its scene looks for it.
set(dragon ${PROJECT_SOURCE_DIR}/assets/meshes/generated/dragon.ply)
add_custom_command(OUTPUT ${dragon} COMMAND gen_dragon ${dragon} COMMENT "Making the dragon" VERBATIM)
add_custom_target(dragon_mesh ALL DEPENDS ${dragon})
if(TARGET rayuela)
    add_dependencies(rayuela dragon_mesh)
endif()
