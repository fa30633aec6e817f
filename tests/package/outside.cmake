# Builds and runs tests/package/outside against the copy installed in PREFIX, by WAY.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")

function(run)
    execute_process(COMMAND ${ARGN} WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE result)
    if(NOT result EQUAL 0)
        string(REPLACE ";" " " line "${ARGN}")
        message(FATAL_ERROR "failed (${result}): ${line}")
    endif()
endfunction()

# Every installed header must compile with nothing but what is installed.
file(GLOB_RECURSE headers RELATIVE "${PREFIX}/include/miebrdf" "${PREFIX}/include/miebrdf/*.h")
list(LENGTH headers count)
if(count LESS 15 OR count GREATER 28)
    message(FATAL_ERROR "${count} headers in ${PREFIX}/include/miebrdf, not the 15 to 28 public ones")
endif()
set(includes "")
foreach(header IN LISTS headers)
    string(APPEND includes "#include <miebrdf/${header}>\n")
endforeach()
file(WRITE "${WORK}/every_header.cpp" "${includes}")

if(WAY STREQUAL find_package)
    run(${CMAKE_COMMAND} -S "${SOURCE}" -B "${WORK}/build" -G "${GENERATOR}"
        "-DCMAKE_PREFIX_PATH=${PREFIX}"
        "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
        "-DEVERY_HEADER=${WORK}/every_header.cpp")
    run(${CMAKE_COMMAND} --build "${WORK}/build")
    run("${WORK}/build/outside")
else()
    set(ENV{PKG_CONFIG_PATH} "${PREFIX}/${LIBDIR}/pkgconfig")
    execute_process(COMMAND "${PKG_CONFIG}" --cflags --libs miebrdf
                    OUTPUT_VARIABLE flags RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "pkg-config does not find miebrdf")
    endif()
    message(STATUS "pkg-config: ${flags}")
    separate_arguments(flags UNIX_COMMAND "${flags}")
    # In an older language a header compiles, or gets one error, which says what is needed.
    foreach(header IN LISTS headers)
        file(WRITE "${WORK}/one.cpp" "#include <miebrdf/${header}>\n")
        execute_process(COMMAND "${CXX}" -std=c++17 -fsyntax-only one.cpp ${flags} WORKING_DIRECTORY "${WORK}"
                        RESULT_VARIABLE result ERROR_VARIABLE said)
        string(REGEX MATCHALL "error:" errors "${said}")
        list(LENGTH errors count)
        if(result EQUAL 0 AND NOT header STREQUAL "miebrdf.h")
            continue()
        elseif(NOT count EQUAL 1 OR NOT said MATCHES "miebrdf needs C\\+\\+20")
            message(FATAL_ERROR "<miebrdf/${header}> in C++17 shall get one error, not ${count}:\n${said}")
        endif()
    endforeach()
    set(ENV{LD_LIBRARY_PATH} "${PREFIX}/${LIBDIR}:$ENV{LD_LIBRARY_PATH}")  # of shared builds
    run("${CXX}" -std=c++20 ${CXX_FLAGS} "${SOURCE}/main.cpp" every_header.cpp ${flags} -o outside)
    run("${WORK}/outside")

    # Static archives: the flags name all that they need, so that even a program that takes every
    # object of ours (--whole-archive) finds every symbol. --static adds what our dependencies need,
    # and hides what is missing: both ways.
    file(GLOB archives "${PREFIX}/${LIBDIR}/libmiebrdf*.a")
    foreach(how IN ITEMS "" --static)
        if(NOT archives)
            break()
        endif()
        execute_process(COMMAND "${PKG_CONFIG}" ${how} --cflags --libs miebrdf
                        OUTPUT_VARIABLE flags RESULT_VARIABLE result
                        OUTPUT_STRIP_TRAILING_WHITESPACE)
        if(NOT result EQUAL 0)
            message(FATAL_ERROR "pkg-config ${how} does not find miebrdf or what it needs")
        endif()
        separate_arguments(flags UNIX_COMMAND "${flags}")
        run("${CXX}" -std=c++20 ${CXX_FLAGS} "${SOURCE}/main.cpp" -Wl,--whole-archive ${flags}
            -Wl,--no-whole-archive -o whole)
        run("${WORK}/whole")
    endforeach()
endif()
