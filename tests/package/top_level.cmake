# Fails on a file or folder at the top that does not belong there: cmake -DROOT=... -P this
#
# What git keeps counts, so that build folders and editors' files do not. A copy without git is not
# asked.
cmake_minimum_required(VERSION 3.25)

set(allowed mie rte materials pipeline tests tools docs .ci CMakeLists.txt CMakePresets.json
            pyproject.toml README.md LICENSE CHANGELOG.md CITATION.cff CONTRIBUTING.md
            SECURITY.md)

find_program(git NAMES git)
if(NOT git OR NOT EXISTS "${ROOT}/.git")
    message(STATUS "top level: skipped: no git here")
    return()
endif()
execute_process(COMMAND "${git}" -c safe.directory=* -C "${ROOT}" ls-files
                OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "/[^\n]*" "" names "${names}")
string(STRIP "${names}" names)
string(REPLACE "\n" ";" names "${names}")
list(REMOVE_DUPLICATES names)
foreach(name IN LISTS names)
    if(NOT name IN_LIST allowed AND NOT name MATCHES "^\\.[a-z-]+$")
        message(SEND_ERROR "${name} does not belong at the top level")
    endif()
endforeach()
list(LENGTH names count)
message(STATUS "top level: ${count} names")
