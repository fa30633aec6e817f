# miebrdf_library(NAME [INTERNAL | ARITHMETIC] [ROOMS folder ...] [SOURCES a.cpp ...] [BATCH count] [COLD]
#                 [PRECOMPILE <header> ... | PRECOMPILED_BY target] PUBLIC dep ... PRIVATE dep ...)
# One static library: target miebrdf_NAME, alias and export miebrdf::NAME. Its sources are those of its rooms (folders below the current one; "." is the folder itself): a new file is
# built as soon as it is there. Public headers are those in include/miebrdf, the only ones that are
# installed; all others are included by path from the root, in the tree alone.
# INTERNAL: part of the program, not installed. ARITHMETIC: what most of the time is spent in; with
# MIEBRDF_PROCESSOR_PATHS a shared library, and one more for each of those.
function(miebrdf_library name)
    cmake_parse_arguments(ARG "INTERNAL;ARITHMETIC;COLD" "BATCH;PRECOMPILED_BY" "ROOMS;SOURCES;PRECOMPILE;PUBLIC;PRIVATE" ${ARGN})
    set(target miebrdf_${name})
    miebrdf_sources(sources ${ARG_ROOMS})
    set(kind STATIC)
    if(ARG_ARITHMETIC AND MIEBRDF_PROCESSOR_PATHS)
        set(kind SHARED)
    endif()
    add_library(${target} ${kind} ${sources} ${ARG_SOURCES})
    add_library(miebrdf::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    if(kind STREQUAL "SHARED")
        miebrdf_shared_arithmetic(${target} "")
    endif()
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    # Of libraries that are headers alone nothing is left when ours is built: no public header has them.
    set(public ${ARG_PUBLIC})
    set(private ${ARG_PRIVATE})
    foreach(headers Eigen3::Eigen Boost::headers nlohmann_json::nlohmann_json)
        list(TRANSFORM public REPLACE "^${headers}$" "$<BUILD_INTERFACE:${headers}>")
        list(TRANSFORM private REPLACE "^${headers}$" "$<BUILD_INTERFACE:${headers}>")
    endforeach()
    target_link_libraries(${target} PUBLIC ${public} PRIVATE ${private}
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
    if(kind STREQUAL "SHARED")
        if(ARG_PRECOMPILE)
            miebrdf_headers_of_others(${target} HEADERS ${ARG_PRECOMPILE} LINK ${ARG_PRIVATE})
        endif()
        miebrdf_for_other_processors(${target} SOURCES ${sources} ${ARG_SOURCES} FAST ${how}
            LINK PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:miebrdf_flags>)
    endif()
    set(public_headers "${CMAKE_CURRENT_SOURCE_DIR}/include")
    if(IS_DIRECTORY "${public_headers}")
        target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${public_headers}>)
    endif()
    if(ARG_INTERNAL)
        return()
    endif()
    set_property(GLOBAL APPEND PROPERTY miebrdf_libraries ${target})  # for the pkg-config file
    if(kind STREQUAL "SHARED")
        set_property(GLOBAL APPEND PROPERTY miebrdf_arithmetic ${target})
        install(TARGETS ${target} EXPORT miebrdfTargets LIBRARY COMPONENT program NAMELINK_COMPONENT dev)
    elseif(NOT BUILD_SHARED_LIBS)  # a shared build installs one library of them all (MiebrdfInstall)
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
# BATCH sources (0: all; 1: none) are compiled as one. COLD: code that reads words and prints them, whose own
# speed nobody notices; -O1 halves its time in the compiler. With PRECOMPILED_BY both must be COLD, or
# neither: gcc takes the level from the precompiled headers.
function(miebrdf_fast_build target)
    cmake_parse_arguments(ARG "COLD" "BATCH;PRECOMPILED_BY" "PRECOMPILE" ${ARGN})
    if(NOT DEFINED ARG_BATCH)
        set(ARG_BATCH 6)
    endif()
    get_target_property(kind ${target} TYPE)
    if(TARGET "${ARG_PRECOMPILED_BY}_headers" AND NOT kind STREQUAL "SHARED_LIBRARY")
        string(APPEND ARG_PRECOMPILED_BY _headers)
    endif()
    if(MIEBRDF_PRECOMPILE AND ARG_PRECOMPILED_BY)
        target_precompile_headers(${target} REUSE_FROM ${ARG_PRECOMPILED_BY})
    elseif(MIEBRDF_PRECOMPILE AND ARG_PRECOMPILE)
        target_precompile_headers(${target} PRIVATE ${ARG_PRECOMPILE})
    endif()
    if(ARG_COLD AND CMAKE_BUILD_TYPE MATCHES "^Rel")
        target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O1>)
        set_property(GLOBAL APPEND PROPERTY miebrdf_cold_targets ${target})
    endif()
    if(MIEBRDF_UNITY AND NOT ARG_BATCH EQUAL 1)
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ARG_BATCH})
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
            # gcc takes what a source keeps to itself for that of a header.
            target_compile_options(${target} PRIVATE
                                   $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
        endif()
    endif()
endfunction()

# miebrdf_headers(TARGET LINK words ... FAST words ...): a target that is there for the headers it
# precompiles, which others take PRECOMPILED_BY it. LINK: what they need; FAST: as of miebrdf_fast_build.
function(miebrdf_headers target)
    cmake_parse_arguments(ARG "" "" "LINK;FAST" ${ARGN})
    set(empty "${PROJECT_BINARY_DIR}/generated/${target}.cpp")
    file(CONFIGURE OUTPUT "${empty}" CONTENT "// Carries precompiled headers.\n")
    add_library(${target} OBJECT "${empty}")
    target_link_libraries(${target} PRIVATE ${ARG_LINK} $<BUILD_INTERFACE:miebrdf_flags>)
    set_target_properties(${target} PROPERTIES
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    miebrdf_fast_build(${target} ${ARG_FAST})
endfunction()

# Sources that embed files (.S). The language brings gcc's ending of precompiled headers with it,
# which Clang's must not have.
macro(miebrdf_enable_assembler)
    set(extension "${CMAKE_PCH_EXTENSION}")
    enable_language(ASM)
    set(CMAKE_PCH_EXTENSION "${extension}")
endmacro()

# miebrdf_plugin(NAME FOR target SOURCES a.cpp ... LINK word ...): miebrdf-NAME.so, a module around a
# library that few requests need and that takes long to load; TARGET opens it when asked for
# (pipeline/io/plugin.h).
function(miebrdf_plugin name)
    cmake_parse_arguments(ARG "" "FOR" "SOURCES;LINK" ${ARGN})
    set(plugin miebrdf_${name}_plugin)
    add_library(${plugin} MODULE ${ARG_SOURCES})
    target_include_directories(${plugin} PRIVATE "${PROJECT_SOURCE_DIR}")
    target_link_libraries(${plugin} PRIVATE miebrdf_base ${ARG_LINK} miebrdf_flags)
    target_link_options(${plugin} PRIVATE LINKER:--no-undefined)
    set_target_properties(${plugin} PROPERTIES PREFIX "" OUTPUT_NAME miebrdf-${name}
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
        LIBRARY_OUTPUT_DIRECTORY "${MIEBRDF_PLUGINS_FOLDER}"
        BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH_USE_LINK_PATH ON)
    add_dependencies(${ARG_FOR} ${plugin})
    install(TARGETS ${plugin} LIBRARY DESTINATION "${MIEBRDF_INSTALLED_PLUGINS}" COMPONENT extras)
endfunction()

# miebrdf_finds_libraries(TARGET folder): TARGET, which is installed in this folder below the prefix,
# finds the plug-ins from there and from the build folder, and the shared libraries of the arithmetic.
# It is linked with both places and loses those of the build folder when it is installed. (CMake's own
# exchange pads run paths with empty elements, which mean the folder where the user stands.)
# Call it after install(TARGETS).
function(miebrdf_finds_libraries target folder)
    get_target_property(built_in ${target} BINARY_DIR)
    get_target_property(other ${target} RUNTIME_OUTPUT_DIRECTORY)
    if(other)
        set(built_in "${other}")
    endif()
    file(RELATIVE_PATH to_plugins "${built_in}" "${MIEBRDF_PLUGINS_FOLDER}")
    set(built "$ORIGIN/${to_plugins}")
    file(RELATIVE_PATH to_plugins "/${folder}" "/${MIEBRDF_INSTALLED_PLUGINS}")
    set(installed "$ORIGIN/${to_plugins}")
    if(MIEBRDF_PROCESSOR_PATHS)
        file(RELATIVE_PATH to_libraries "${built_in}" "${MIEBRDF_PATHS_FOLDER}")
        list(APPEND built "$ORIGIN/${to_libraries}")
        file(RELATIVE_PATH to_libraries "/${folder}" "/${CMAKE_INSTALL_LIBDIR}")
        list(APPEND installed "$ORIGIN/${to_libraries}")
    endif()
    list(TRANSFORM built REPLACE "/$" "")
    list(TRANSFORM installed REPLACE "/$" "")
    set_target_properties(${target} PROPERTIES BUILD_WITH_INSTALL_RPATH ON
        INSTALL_RPATH "${built};${installed}" INSTALL_RPATH_USE_LINK_PATH ON)
    list(JOIN built ":" built)
    list(JOIN installed ":" installed)
    if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
        set(place "\${CMAKE_INSTALL_PREFIX}/${folder}")
        if(IS_ABSOLUTE "${folder}")
            set(place "${folder}")
        endif()
        install(CODE "set(file \"\$ENV{DESTDIR}${place}/$<TARGET_FILE_NAME:${target}>\")
if(EXISTS \"\${file}\")
    file(RPATH_CHANGE FILE \"\${file}\" OLD_RPATH [[${built}:${installed}]] NEW_RPATH [[${installed}]])
endif()" COMPONENT program)
    endif()
endfunction()
