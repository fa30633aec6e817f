# cmake --install: headers, libraries, program, find_package(miebrdf), pkg-config.
#
# miebrdf::miebrdf is the whole library. Static builds make it of one archive for each area; shared
# builds (BUILD_SHARED_LIBS) of one libmiebrdf.so in which only what the public headers declare is
# visible. Libraries of the arithmetic for several processors (MIEBRDF_PROCESSOR_PATHS) stay beside
# it.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/miebrdf")
get_property(libraries GLOBAL PROPERTY miebrdf_libraries)
get_property(arithmetic GLOBAL PROPERTY miebrdf_arithmetic)

# What the areas link to outside the project.
set(outside "")
foreach(library IN LISTS libraries)
    get_target_property(dependencies ${library} LINK_LIBRARIES)
    foreach(dependency IN LISTS dependencies)
        if(NOT dependency MATCHES "^(miebrdf::|\\$<|::@)")
            list(APPEND outside ${dependency})
        endif()
    endforeach()
endforeach()
list(REMOVE_DUPLICATES outside)

if(BUILD_SHARED_LIBS)
    set(objects "")
    get_property(object_libraries GLOBAL PROPERTY miebrdf_object_libraries)  # of areas made of them
    set(inside ${libraries} ${object_libraries})
    list(REMOVE_ITEM inside ${arithmetic})
    foreach(library IN LISTS inside)
        list(APPEND objects $<TARGET_OBJECTS:${library}>)
    endforeach()
    add_library(miebrdf_everything SHARED ${objects})
    target_link_options(miebrdf_everything PRIVATE LINKER:--no-undefined)
    set_target_properties(miebrdf_everything PROPERTIES OUTPUT_NAME miebrdf LINKER_LANGUAGE CXX
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_link_libraries(miebrdf_everything PUBLIC ${arithmetic}
                                             PRIVATE ${outside} $<BUILD_INTERFACE:miebrdf_flags>)
else()
    add_library(miebrdf_everything INTERFACE)
    # To link alone: what their sources include stays with them.
    foreach(library IN LISTS libraries)
        target_link_libraries(miebrdf_everything INTERFACE $<LINK_ONLY:${library}>)
    endforeach()
endif()
set_target_properties(miebrdf_everything PROPERTIES EXPORT_NAME miebrdf)
target_link_libraries(miebrdf_everything INTERFACE miebrdf_base)
foreach(library IN LISTS libraries)
    get_target_property(folder ${library} SOURCE_DIR)
    if(IS_DIRECTORY "${folder}/include")
        target_include_directories(miebrdf_everything INTERFACE
                                   $<BUILD_INTERFACE:${folder}/include>)
    endif()
endforeach()
target_compile_features(miebrdf_everything INTERFACE cxx_std_20)
add_library(miebrdf::miebrdf ALIAS miebrdf_everything)
install(TARGETS miebrdf_everything EXPORT miebrdfTargets
        LIBRARY COMPONENT program NAMELINK_COMPONENT dev)
if(BUILD_SHARED_LIBS)
    miebrdf_finds_libraries(miebrdf_everything "${CMAKE_INSTALL_LIBDIR}")
endif()

install(EXPORT miebrdfTargets NAMESPACE miebrdf:: DESTINATION "${package_dir}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/tools/cmake/miebrdfConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/miebrdfConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/miebrdfConfigVersion.cmake"
                                 COMPATIBILITY SameMajorVersion)  # docs/versions.md
install(FILES "${PROJECT_BINARY_DIR}/miebrdfConfig.cmake"
              "${PROJECT_BINARY_DIR}/miebrdfConfigVersion.cmake"
        DESTINATION "${package_dir}")

# The pkg-config file says what the targets say. Static archives: ours, the last declared first, so
# that a linker finds everything, then their dependencies by the names pkg-config has for them.
set(pc_name_fmt::fmt fmt)
set(pc_name_TBB::tbb tbb)
set(pc_name_pugixml::pugixml pugixml)
set(pc_name_ZLIB::ZLIB zlib)
set(MIEBRDF_PC_LIBS "-lmiebrdf")
foreach(library IN LISTS arithmetic)
    string(APPEND MIEBRDF_PC_LIBS " -l${library}")
endforeach()
set(MIEBRDF_PC_REQUIRES "")
if(NOT BUILD_SHARED_LIBS)
    set(MIEBRDF_PC_LIBS "")
    foreach(library IN LISTS libraries)
        string(PREPEND MIEBRDF_PC_LIBS "-l${library} ")
    endforeach()
    foreach(dependency IN LISTS outside)
        if(DEFINED pc_name_${dependency})
            string(APPEND MIEBRDF_PC_REQUIRES "${pc_name_${dependency}} ")
        elseif(NOT dependency MATCHES "::")  # linked by name, so by name here too
            string(APPEND MIEBRDF_PC_LIBS "-l${dependency} ")
        else()
            message(AUTHOR_WARNING "miebrdf.pc: no pkg-config name known for ${dependency}")
        endif()
    endforeach()
endif()
# Relative, so that `cmake --install --prefix` and moving the folder keep it right.
file(RELATIVE_PATH MIEBRDF_PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" MIEBRDF_PC_TO_PREFIX "${MIEBRDF_PC_TO_PREFIX}")
configure_file("${PROJECT_SOURCE_DIR}/tools/cmake/miebrdf.pc.in"
               "${PROJECT_BINARY_DIR}/miebrdf.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/miebrdf.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")

# Pages and examples, by the names that headers give them ("docs/conventions.md"), and the site where
# tools/site has made it.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT doc
        PATTERN "site" EXCLUDE PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md SECURITY.md CITATION.cff LICENSE
        DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT doc)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/build/site/html" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
        COMPONENT doc OPTIONAL PATTERN ".buildinfo" EXCLUDE)

if(PROJECT_IS_TOP_LEVEL)
    add_custom_target(uninstall
        COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR}
                -P "${PROJECT_SOURCE_DIR}/tools/cmake/uninstall.cmake" VERBATIM)
endif()
