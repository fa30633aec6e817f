# cmake --install: headers, libraries, program, find_package(miebrdf), pkg-config.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/miebrdf")
install(EXPORT miebrdfTargets NAMESPACE miebrdf:: DESTINATION "${package_dir}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/tools/cmake/miebrdfConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/miebrdfConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/miebrdfConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/miebrdfConfig.cmake"
              "${PROJECT_BINARY_DIR}/miebrdfConfigVersion.cmake"
        DESTINATION "${package_dir}")

# The pkg-config file says what the targets say: our libraries, the last declared first, so that a
# static linker finds everything; their dependencies by the names pkg-config has for them. Static
# libraries need all of these from every user, shared ones only what their headers include.
set(pc_name_Eigen3::Eigen eigen3)
set(pc_name_SQLite::SQLite3 sqlite3)
set(pc_name_fmt::fmt fmt)
set(pc_name_TBB::tbb tbb)
set(pc_name_tomlplusplus::tomlplusplus tomlplusplus)
set(pc_name_zip libzip)
set(pc_name_OpenEXR::OpenEXR OpenEXR)
set(pc_name_pugixml::pugixml pugixml)
set(header_only Boost::headers nlohmann_json::nlohmann_json)

get_property(libraries GLOBAL PROPERTY miebrdf_libraries)
set(pc_requires "")
set(plain_names "")
set(MIEBRDF_PC_LIBS "")
foreach(library IN LISTS libraries)
    string(PREPEND MIEBRDF_PC_LIBS "-l${library} ")
    get_target_property(dependencies ${library} LINK_LIBRARIES)
    foreach(dependency IN LISTS dependencies)
        if(dependency MATCHES "^(miebrdf::|\\$<BUILD_INTERFACE|::@)" OR dependency IN_LIST header_only)
            continue()
        elseif(DEFINED pc_name_${dependency})
            list(APPEND pc_requires ${pc_name_${dependency}})
        elseif(NOT dependency MATCHES "::")  # linked by name, so by name here too
            list(APPEND plain_names "-l${dependency}")
        else()
            message(AUTHOR_WARNING "miebrdf.pc: no pkg-config name known for ${dependency}")
        endif()
    endforeach()
endforeach()
list(REMOVE_DUPLICATES pc_requires)
list(REMOVE_DUPLICATES plain_names)
if(NOT BUILD_SHARED_LIBS)
    list(JOIN plain_names " " plain_names)
    string(APPEND MIEBRDF_PC_LIBS "${plain_names}")
endif()
list(REMOVE_ITEM pc_requires eigen3)
string(REPLACE ";" " " pc_requires "${pc_requires}")
if(BUILD_SHARED_LIBS)
    set(MIEBRDF_PC_REQUIRES "eigen3")
    set(MIEBRDF_PC_REQUIRES_PRIVATE "${pc_requires}")
else()
    set(MIEBRDF_PC_REQUIRES "eigen3 ${pc_requires}")
    set(MIEBRDF_PC_REQUIRES_PRIVATE "")
endif()
get_target_property(definitions miebrdf_math INTERFACE_COMPILE_DEFINITIONS)
list(TRANSFORM definitions PREPEND "-D" OUTPUT_VARIABLE MIEBRDF_PC_CFLAGS)
string(REPLACE ";" " " MIEBRDF_PC_CFLAGS "${MIEBRDF_PC_CFLAGS}")
# Relative, so that `cmake --install --prefix` and moving the folder keep it right.
file(RELATIVE_PATH MIEBRDF_PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" MIEBRDF_PC_TO_PREFIX "${MIEBRDF_PC_TO_PREFIX}")
configure_file("${PROJECT_SOURCE_DIR}/tools/cmake/miebrdf.pc.in"
               "${PROJECT_BINARY_DIR}/miebrdf.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/miebrdf.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
