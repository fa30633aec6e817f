# Puts styles, scripts and the 3D library into page.html:
#   cmake -DFOLDER=page -DOUTPUT=report.html [-DTHREE=three.min.js -DLICENCE=copyright] -P this
# The library is compressed (a page needs it only where it draws in 3D) and written in base64.
cmake_minimum_required(VERSION 3.25)

# Each defines one name for those behind it.
set(modules data colour brdf chart controls webgl object lobe panels app selftest)

file(READ "${FOLDER}/page.html" page)
file(READ "${FOLDER}/page.css" style)
set(script "")
foreach(module IN LISTS modules)
    file(READ "${FOLDER}/${module}.js" source)
    string(APPEND script "${source}\n")
endforeach()
set(library "")
set(licence "The 3D views were left out of this page.")
if(THREE)
    set(packed "${OUTPUT}.three.gz")
    execute_process(COMMAND gzip -9nc "${THREE}" OUTPUT_FILE "${packed}" COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND base64 -w0 "${packed}" OUTPUT_VARIABLE library COMMAND_ERROR_IS_FATAL ANY)
    file(REMOVE "${packed}")
    set(licence "three.js, MIT licence, https://github.com/mrdoob/three.js")
    if(EXISTS "${LICENCE}")
        file(READ "${LICENCE}" licence)
    endif()
    string(REPLACE "&" "&amp;" licence "${licence}")
    string(REPLACE "<" "&lt;" licence "${licence}")
endif()
string(REPLACE "@STYLE@" "${style}" page "${page}")
string(REPLACE "@LICENCE@" "${licence}" page "${page}")
string(REPLACE "@THREE@" "${library}" page "${page}")
string(REPLACE "@SCRIPT@" "${script}" page "${page}")
file(WRITE "${OUTPUT}" "${page}")
