# miebrdf_library(NAME [INTERNAL] [ROOMS folder ...] [SOURCES a.cpp ...] [BATCH count] [COLD]
#                 [PRECOMPILE <header> ... | PRECOMPILED_BY target] PUBLIC dep ... PRIVATE dep ...)
# One static library: target miebrdf_NAME, alias and export miebrdf::NAME. Its sources are those of its rooms (folders below the current one; "." is the folder itself): a new file is
# built as soon as it is there. Public headers are those in include/miebrdf, the only ones that are
# installed; all others are included by path from the root, in the tree alone.
# INTERNAL: part of the program, not installed.
function(miebrdf_library name)
    cmake_parse_arguments(ARG "INTERNAL;COLD" "BATCH;PRECOMPILED_BY" "ROOMS;SOURCES;PRECOMPILE;PUBLIC;PRIVATE" ${ARGN})
    set(target miebrdf_${name})
    miebrdf_sources(sources ${ARG_ROOMS})
    add_library(${target} STATIC ${sources} ${ARG_SOURCES})
    add_library(miebrdf::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE}
                                    $<BUILD_INTERFACE:miebrdf_flags>)
    set(how PRECOMPILE ${ARG_PRECOMPILE})
    if(ARG_COLD)
        list(APPEND how COLD)
    endif()
    foreach(word BATCH PRECOMPILED_BY)
        if(DEFINED ARG_${word})
            list(APPEND how ${word} ${ARG_${word}})
        endif()
    endforeach()
    miebrdf_fast_build(${target} ${how})
    set(public_headers "${CMAKE_CURRENT_SOURCE_DIR}/include")
    if(IS_DIRECTORY "${public_headers}")
        target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${public_headers}>)
    endif()
    if(ARG_INTERNAL)
        return()
    endif()
    set_property(GLOBAL APPEND PROPERTY miebrdf_libraries ${target})  # for the pkg-config file
    if(NOT BUILD_SHARED_LIBS)  # a shared build installs one library of them all (MiebrdfInstall)
        install(TARGETS ${target} EXPORT miebrdfTargets)
    endif()
    if(IS_DIRECTORY "${public_headers}")
        install(DIRECTORY "${public_headers}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
                FILES_MATCHING PATTERN "*.h")
    endif()
endfunction()

# miebrdf_sources(VARIABLE folder ...): every .cpp of these folders of the current one.
function(miebrdf_sources variable)
    set(all "")
    foreach(room IN LISTS ARGN)
        file(GLOB found CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${room}/*.cpp")
        if(NOT found)
            message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR}/${room} has no sources")
        endif()
        list(APPEND all ${found})
    endforeach()
    set(${variable} "${all}" PARENT_SCOPE)
endfunction()

# miebrdf_fast_build(TARGET [BATCH count] [COLD] PRECOMPILE <header> ... | PRECOMPILED_BY target): most of the time of a
# build is reading Eigen, fmt and the standard library again for every small file, and instantiating
# the same templates. Headers are read once for a target (precompiled), and with MIEBRDF_UNITY
# BATCH sources (0: all) are compiled as one. COLD: code that reads words and prints them, whose own
# speed nobody notices; -O1 halves its time in the compiler.
function(miebrdf_fast_build target)
    cmake_parse_arguments(ARG "COLD" "BATCH;PRECOMPILED_BY" "PRECOMPILE" ${ARGN})
    if(NOT DEFINED ARG_BATCH)
        set(ARG_BATCH 6)
    endif()
    if(MIEBRDF_PRECOMPILE AND ARG_PRECOMPILED_BY)
        target_precompile_headers(${target} REUSE_FROM ${ARG_PRECOMPILED_BY})
    elseif(MIEBRDF_PRECOMPILE AND ARG_PRECOMPILE)
        target_precompile_headers(${target} PRIVATE ${ARG_PRECOMPILE})
    endif()
    if(ARG_COLD AND CMAKE_BUILD_TYPE MATCHES "^Rel")
        target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O1>)
    endif()
    if(MIEBRDF_UNITY)
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ARG_BATCH})
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
            # gcc takes what a source keeps to itself for that of a header.
            target_compile_options(${target} PRIVATE
                                   $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
        endif()
    endif()
endfunction()
