# miebrdf_library(NAME [INTERNAL] SOURCES a.cpp ... PUBLIC dep ... PRIVATE dep ...)
# One static (or shared) library per folder: target miebrdf_NAME, alias and export miebrdf::NAME,
# headers included by path from the root. INTERNAL: part of the program, not installed.
function(miebrdf_library name)
    cmake_parse_arguments(ARG "INTERNAL" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    set(target miebrdf_${name})
    add_library(${target} ${ARG_SOURCES})
    add_library(miebrdf::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/miebrdf>)
    target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE}
                                    $<BUILD_INTERFACE:miebrdf_flags>)
    if(ARG_INTERNAL)
        return()
    endif()
    set_property(GLOBAL APPEND PROPERTY miebrdf_libraries ${target})  # for the pkg-config file
    install(TARGETS ${target} EXPORT miebrdfTargets)
    file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
    file(GLOB headers CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.h")
    install(FILES ${headers} DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/miebrdf/${folder}")
endfunction()
