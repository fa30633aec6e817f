# cpack -G DEB: miebrdf (program and library), miebrdf-extras (plug-ins), libmiebrdf-dev, miebrdf-doc,
# python3-miebrdf. Build the preset `debian` for it: portable, one shared library, the arithmetic
# once more for newer processors.
# docs/python.md, README.md
set(CPACK_PACKAGE_NAME miebrdf)
set(CPACK_PACKAGE_VENDOR miebrdf)
set(CPACK_PACKAGE_CONTACT "The miebrdf developers <${PROJECT_HOMEPAGE_URL}>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_HOMEPAGE_URL "${PROJECT_HOMEPAGE_URL}")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)

set(CPACK_COMPONENTS_ALL program extras dev doc)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # the libraries that the files are linked to, with versions
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${MIEBRDF_PATHS_FOLDER}")  # and our own

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME miebrdf)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "The program miebrdf, its man page and completions, and the library that other programs load.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_GENERATE_SHLIBS ON)  # ldconfig after installation
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "miebrdf-extras")
set(opened "libzip4 | libzip5 | libzip4t64")  # by name, where dpkg-shlibdeps does not see it
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${opened}")

set(CPACK_DEBIAN_EXTRAS_PACKAGE_NAME miebrdf-extras)
set(CPACK_COMPONENT_EXTRAS_DESCRIPTION
    "Plug-ins of miebrdf: charts as PNG (librsvg), tables of sweeps as NetCDF, fits (Ceres), rendering of meshes (Embree).")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libmiebrdf-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION
    "Headers, and what find_package(miebrdf) and pkg-config need to build programs with miebrdf.")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "miebrdf (= ${PROJECT_VERSION})")
if(NOT BUILD_SHARED_LIBS)  # archives leave their dependencies to who links them
    string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", libfmt-dev, libtbb-dev, "
        "libpugixml-dev, zlib1g-dev, libsqlite3-dev, libyaml-dev, libsodium-dev, "
        "libmuparser-dev, libzip-dev, libopenexr-dev")
endif()

set(CPACK_DEBIAN_DOC_PACKAGE_NAME miebrdf-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_DOC_DESCRIPTION
    "Pages and examples of miebrdf, and the site made of them with the references of C++ and Python.")

if(TARGET miebrdf_python)
    list(APPEND CPACK_COMPONENTS_ALL python)
    find_package(Python 3.11 COMPONENTS Interpreter QUIET)
    math(EXPR next "${Python_VERSION_MINOR} + 1")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-miebrdf)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
    set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python package miebrdf: ${PROJECT_DESCRIPTION}.")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${opened}, python3-numpy, \
python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next})")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "miebrdf-extras, python3-matplotlib, python3-xarray")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-tqdm")
endif()

# Every package of Debian's says under which licence it is.
set(packages_program miebrdf)
set(packages_extras miebrdf-extras)
set(packages_dev libmiebrdf-dev)
set(packages_doc miebrdf-doc)
set(packages_python python3-miebrdf)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
    install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" RENAME copyright COMPONENT ${component}
            DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${packages_${component}}")
endforeach()
include(CPack)
