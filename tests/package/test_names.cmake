# Fails on tests that ctest would never run: cmake -DROOT=... -P this
#
# ctest asks test programs for their tests by name. CMake splits lists at semicolons, and Catch takes
# a name that begins with - for an option; a name it does not know runs nothing and passes. A file
# that no program is built of is not even compiled.
cmake_minimum_required(VERSION 3.25)

file(GLOB_RECURSE sources "${ROOT}/tests/*.cpp")
foreach(source IN LISTS sources)
    get_filename_component(file "${source}" NAME)
    get_filename_component(folder "${source}" DIRECTORY)
    if(file MATCHES "_test\\.cpp$")
        file(READ "${folder}/CMakeLists.txt" list)
        string(FIND "${list}" "${file}" place)
        if(place EQUAL -1)
            message(SEND_ERROR "${source}: not in ${folder}/CMakeLists.txt")
        endif()
    endif()
    file(READ "${source}" text)
    string(REPLACE ";" "<semicolon>" text "${text}")
    string(REGEX MATCHALL "TEST_CASE\\([ \n]*\"(-[^\"]*|[^\"]*<semicolon>[^\"]*)\"" names "${text}")
    foreach(name IN LISTS names)
        message(SEND_ERROR "${source}: ${name}: no - at its beginning, no semicolon")
    endforeach()
endforeach()
list(LENGTH sources count)
message(STATUS "names of tests: ${count} files")
