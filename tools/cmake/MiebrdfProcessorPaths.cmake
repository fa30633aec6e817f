# MIEBRDF_PROCESSOR_PATHS: the libraries with the arithmetic (math, mie, rte) are compiled for every
# processor of the kind and again for the newer ones in this list, as shared libraries of the same
# name in glibc-hwcaps/PATH beside the first. The loader of glibc 2.33 and later takes the best that
# the processor can run, in the build folder, an installed copy and a wheel alike; no code of ours
# chooses. What compilers take for one type on both sides of such a border: docs/dependencies.md
set(MIEBRDF_PROCESSOR_PATHS "" CACHE STRING
    "Processors that get libraries of their own, e.g. x86-64-v3;x86-64-v4 (empty: static, for one)")
set(MIEBRDF_PATHS_FOLDER "${PROJECT_BINARY_DIR}/lib")  # of the libraries in the build folder

if(MIEBRDF_PROCESSOR_PATHS)
    if(MIEBRDF_NATIVE)
        message(FATAL_ERROR "MIEBRDF_PROCESSOR_PATHS is for many machines, MIEBRDF_NATIVE for this "
                            "one: choose")
    endif()
    set(machine "${CMAKE_SYSTEM_NAME} ${CMAKE_SYSTEM_PROCESSOR}")
    if(NOT machine MATCHES "^Linux (x86_64|amd64|AMD64)$")
        message(STATUS "MIEBRDF_PROCESSOR_PATHS: the loader of ${machine} knows no such folders; one "
                       "build for all")
        set(MIEBRDF_PROCESSOR_PATHS "")
    endif()
    foreach(path IN LISTS MIEBRDF_PROCESSOR_PATHS)
        if(NOT path MATCHES "^x86-64-v[234]$")
            message(FATAL_ERROR "MIEBRDF_PROCESSOR_PATHS: '${path}'; allowed: x86-64-v2, x86-64-v3, "
                                "x86-64-v4")
        endif()
    endforeach()
endif()

# miebrdf_shared_arithmetic(TARGET folder): a shared library of the arithmetic, made to lie in this
# folder of the build and in the same folder below the library folder of an installation.
#
# Only names of miebrdf's are visible, and every call inside stays inside: programs contain
# templates of Eigen's by the same names, compiled for another processor. The compiler knows it,
# too, and inlines what it would have to leave replaceable.
function(miebrdf_shared_arithmetic target folder)
    set(names "${PROJECT_SOURCE_DIR}/tools/cmake/visible_names.map")
    target_link_options(${target} PRIVATE
                        "LINKER:-Bsymbolic,--no-undefined,--version-script=${names}")
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
    set(to_base "$ORIGIN")
    if(folder)
        set(to_base "$ORIGIN/../..")
    endif()
    set(version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    set_target_properties(${target} PROPERTIES
        CXX_VISIBILITY_PRESET default VISIBILITY_INLINES_HIDDEN OFF DEFINE_SYMBOL ""
        VERSION ${version} SOVERSION ${version} LINK_DEPENDS "${names}"
        LIBRARY_OUTPUT_DIRECTORY "${MIEBRDF_PATHS_FOLDER}/${folder}"
        BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "${to_base}")
endfunction()

# miebrdf_headers_of_others(TARGET HEADERS <header> ... LINK words ...): the headers that other
# kinds of libraries take from TARGET, read once for them: names are hidden there, and what was read
# with other flags (of what TARGET is linked to, too) cannot serve.
function(miebrdf_headers_of_others target)
    cmake_parse_arguments(ARG "" "" "HEADERS;LINK" ${ARGN})
    miebrdf_headers(${target}_headers LINK ${target} ${ARG_LINK} FAST PRECOMPILE ${ARG_HEADERS})
endfunction()

# miebrdf_for_other_processors(TARGET sources ... FAST words ... LINK words ...): the library TARGET
# once more for each path; what it is linked to, it takes of the same path.
function(miebrdf_for_other_processors target)
    cmake_parse_arguments(ARG "" "" "SOURCES;FAST;LINK" ${ARGN})
    get_target_property(base_name ${target} NAME)
    foreach(path IN LISTS MIEBRDF_PROCESSOR_PATHS)
        set(folder "glibc-hwcaps/${path}")
        set(variant ${target}_${path})
        add_library(${variant} SHARED ${ARG_SOURCES})
        miebrdf_shared_arithmetic(${variant} "${folder}")
        set_target_properties(${variant} PROPERTIES OUTPUT_NAME ${base_name})
        target_compile_features(${variant} PUBLIC cxx_std_20)
        string(REPLACE "miebrdf::math" "miebrdf_math_${path}" link "${ARG_LINK}")
        target_link_libraries(${variant} ${link})
        target_include_directories(${variant} PUBLIC
            $<TARGET_PROPERTY:${target},INTERFACE_INCLUDE_DIRECTORIES>)
        target_compile_definitions(${variant} PUBLIC
            $<TARGET_PROPERTY:${target},INTERFACE_COMPILE_DEFINITIONS>)
        target_compile_options(${variant} PRIVATE -march=${path} ${MIEBRDF_NOISE_OF_WIDE_VECTORS})
        string(REPLACE "miebrdf_math" "miebrdf_math_${path}" fast "${ARG_FAST}")
        miebrdf_fast_build(${variant} ${fast})
        add_dependencies(${target} ${variant})
        install(TARGETS ${variant} LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}/${folder}"
                COMPONENT program NAMELINK_SKIP)
    endforeach()
endfunction()
