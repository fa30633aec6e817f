# pip install --no-build-isolation, offline, into an environment of its own; then the sdist:
# cmake -DPYTHON=... -DSOURCE=... -DBUILD=... -DWORK=... -DASK=... -P this
file(REMOVE_RECURSE "${WORK}")
execute_process(COMMAND "${PYTHON}" -m venv --system-site-packages "${WORK}/env" RESULT_VARIABLE failed
                OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(failed)
    message("skipped: no environment can be made here (python3-venv): ${said}")
    return()
endif()
# The module is built already: the wheel is made of it.
execute_process(COMMAND "${WORK}/env/bin/python" -m pip install --no-index --no-build-isolation --no-deps
                        --config-settings build-dir=${BUILD} "${SOURCE}"
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E env --unset=PYTHONPATH "${WORK}/env/bin/python" -c "${ASK}"
                WORKING_DIRECTORY "${WORK}" OUTPUT_VARIABLE file COMMAND_ERROR_IS_FATAL ANY)
if(NOT file MATCHES "^${WORK}/env/")
    message(FATAL_ERROR "imported ${file}, not what pip installed")
endif()
# Its stubs are there, and pip knows it.
execute_process(COMMAND "${WORK}/env/bin/python" -m pip show --files miebrdf OUTPUT_VARIABLE shown
                COMMAND_ERROR_IS_FATAL ANY)
foreach(word "Version: " "miebrdf/_core.pyi" "miebrdf/py.typed" "Requires: numpy")
    if(NOT shown MATCHES "${word}")
        message(FATAL_ERROR "pip show lacks '${word}':\n${shown}")
    endif()
endforeach()
execute_process(COMMAND "${WORK}/env/bin/python" -m pip uninstall --yes miebrdf COMMAND_ERROR_IS_FATAL ANY)
if(EXISTS "${WORK}/env/lib/python3/site-packages/miebrdf")
    message(FATAL_ERROR "pip uninstall left files")
endif()
# A source distribution has all that a build needs, and nothing of a build.
execute_process(COMMAND "${PYTHON}" -c "import sys; sys.path.insert(0, 'tools/python/backend'); import miebrdf_build; print(miebrdf_build.build_sdist(sys.argv[1]))" "${WORK}"
                WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE sdist OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E tar tf "${WORK}/${sdist}" OUTPUT_VARIABLE contents
                COMMAND_ERROR_IS_FATAL ANY)
foreach(path PKG-INFO pyproject.toml CMakeLists.txt tools/python/core.cpp materials/data/index.csv)
    if(NOT contents MATCHES "miebrdf-[^/]*/${path}\n")
        message(FATAL_ERROR "${sdist} lacks ${path}")
    endif()
endforeach()
if(contents MATCHES "/build/|\\.so\n|/\\.git/")
    message(FATAL_ERROR "${sdist} contains results of a build")
endif()
