# Configures tests/package/parent, of which miebrdf is a part: its settings stay as they are, it gets
# the library alone, of few objects, and no header of Eigen's. Then miebrdf without two packages that
# it needs: one message names both, and what installs them.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}")

execute_process(COMMAND ${CMAKE_COMMAND} -S "${ROOT}/tests/package/parent" -B "${WORK}/build" -G Ninja
                        "-DMIEBRDF=${ROOT}" "-DCMAKE_CXX_COMPILER=${CXX}" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
                OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "${said}")
endif()
file(READ "${WORK}/build/compile_commands.json" commands)
string(JSON count LENGTH "${commands}")
message(STATUS "${count} objects")
if(count GREATER 250)
    message(FATAL_ERROR "${count} objects are more than 250")
endif()
math(EXPR last "${count} - 1")
foreach(place RANGE ${last})
    string(JSON file GET "${commands}" ${place} file)
    string(JSON command GET "${commands}" ${place} command)
    if(file MATCHES "/outside/main.cpp$" AND command MATCHES "eigen3|-DEIGEN")
        message(FATAL_ERROR "who links to miebrdf::miebrdf gets Eigen: ${command}")
    elseif(NOT file MATCHES "/outside/main.cpp$" AND NOT command MATCHES " -O[123]")
        message(FATAL_ERROR "not optimised: ${command}")
    endif()
endforeach()

execute_process(COMMAND ${CMAKE_COMMAND} -S "${ROOT}" -B "${WORK}/without" -G Ninja -DBUILD_TESTING=OFF
                        "-DCMAKE_CXX_COMPILER=${CXX}" -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON
                        -DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON
                ERROR_VARIABLE said OUTPUT_QUIET RESULT_VARIABLE failed)
if(NOT failed OR NOT said MATCHES "fmt 9" OR NOT said MATCHES "apt install libfmt-dev libtbb-dev\n")
    message(FATAL_ERROR "without fmt and oneTBB the message is: ${said}")
endif()
