# Installs components one by one: each holds its files and no others', and the man page and the
# completions are written while they are installed, from the program alone.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}" "${BUILD}/tools/miebrdf/written")
foreach(component program dev)
    execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --component ${component}
                            --prefix "${WORK}/${component}"
                    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(file program/${BINDIR}/miebrdf program/${MANDIR}/man1/miebrdf.1
             program/share/bash-completion/completions/miebrdf dev/include/miebrdf/brdf.h)
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
