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
configure_file("${PROJECT_SOURCE_DIR}/tools/cmake/miebrdf.pc.in"
               "${PROJECT_BINARY_DIR}/miebrdf.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/miebrdf.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
