# Installs components one by one: each holds its files and no others', the man page and the
# completions are written while they are installed, from the program alone, and what headers point to
# is there. Then removes them again.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}" "${BUILD}/tools/miebrdf/written")
foreach(component program dev doc)
    execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --component ${component}
                            --prefix "${WORK}/${component}"
                    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(file program/${BINDIR}/miebrdf program/${MANDIR}/man1/miebrdf.1
             program/share/bash-completion/completions/miebrdf dev/include/miebrdf/brdf.h
             doc/share/doc/miebrdf/docs/examples/albedo_spectrum.cpp doc/share/doc/miebrdf/README.md)
    file(SIZE "${WORK}/${file}" size)  # an error where it is missing
    if(size EQUAL 0)
        message(FATAL_ERROR "${file} is empty")
    endif()
endforeach()
foreach(file program/include dev/${BINDIR})
    if(EXISTS "${WORK}/${file}")
        message(FATAL_ERROR "${file} belongs to another component")
    endif()
endforeach()

# "docs/conventions.md", "docs/formats": from the folder of the documentation.
file(GLOB headers "${WORK}/dev/include/miebrdf/*.h")
set(count 0)
foreach(header IN LISTS headers)
    file(READ "${header}" text)
    string(REGEX MATCHALL "docs/[a-z/-]*[a-z](\\.md)?" pages "${text}")
    foreach(page IN LISTS pages)
        math(EXPR count "${count} + 1")
        if(NOT EXISTS "${WORK}/doc/share/doc/miebrdf/${page}")
            message(FATAL_ERROR "${header} points to ${page}, which is not installed")
        endif()
    endforeach()
endforeach()
if(count LESS 15)
    message(FATAL_ERROR "headers point to ${count} pages: is this still how they do it?")
endif()

# The manifests of these installations, and what is left without them.
foreach(component program dev doc)
    file(COPY_FILE "${BUILD}/install_manifest_${component}.txt" "${WORK}/install_manifest_${component}.txt")
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -DBUILD=${WORK} -P "${CMAKE_CURRENT_LIST_DIR}/../../tools/cmake/uninstall.cmake"
                COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE left "${WORK}/*/*")
if(left)
    message(FATAL_ERROR "left after uninstall: ${left}")
endif()
if(EXISTS "${WORK}/dev/include/miebrdf")
    message(FATAL_ERROR "uninstall leaves empty folders")
endif()
