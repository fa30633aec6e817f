# cmake -DPROGRAM=miebrdf -DPRELOAD=moved_memory.so -P moved_memory.cmake: values are the same bits
# wherever in memory they are computed (results of one command, of a scene file and of Python lie at
# different places).
function(expect_same_bits)
    unset(first)
    foreach(offset 0 16 32 48)
        execute_process(
            COMMAND ${CMAKE_COMMAND} -E env "LD_PRELOAD=${PRELOAD}" "MIEBRDF_MEMORY_OFFSET=${offset}"
                    "${PROGRAM}" ${ARGN} --wavelengths 450,550 --no-cache --quiet --threads 1
            RESULT_VARIABLE code OUTPUT_VARIABLE values ERROR_VARIABLE errors)
        list(JOIN ARGN " " words)
        if(NOT (code EQUAL 0 OR code EQUAL 4))
            message(FATAL_ERROR "miebrdf ${words}: exit code ${code}\n${errors}")
        endif()
        if(NOT DEFINED first)
            set(first "${values}")
        elseif(NOT values STREQUAL first)
            message(SEND_ERROR "miebrdf ${words}: other bits with memory ${offset} bytes beyond a "
                               "line of the cache than at its beginning")
        endif()
    endforeach()
endfunction()

set(few --mu-in 0.4 --mu-out 0.3,0.9 --azimuth 0,60)
set(one_azimuth --mu-in 0.4 --mu-out 0.3,0.5,0.9 --azimuth 10)
set(more --mu-in 0.2,0.5,1 --mu-out 0.1,0.6,0.95 --azimuth 0,90,180)
set(spheres --base index:1.5,0.01 --effective-radius 2)
expect_same_bits(brdf ${spheres} --coat hg:0.8,0.5@1 --streams 12 ${few})
expect_same_bits(brdf --base hg:0.9,0.95 --tolerance 1e-2 ${one_azimuth})
expect_same_bits(brdf --base hg:0.9,0.6 --coat hg:0.5,0.5@1 --boundary smooth --host-index 1.5 ${few})
expect_same_bits(brdf --base hg:0.9,0.6 --boundary rough:0.3 --host-index 1.5 ${one_azimuth})
expect_same_bits(brdf --base TiO2,radius=0.2 --coat Au,radius=0.03@0.5 ${more})
expect_same_bits(brdf --substrate mirror:Al --coat hg:0.9,0.5@1 ${few})
expect_same_bits(brdf --base rayleigh:0.9 --stokes 4 ${more})
expect_same_bits(brdf ${spheres} --roughness 0.3 ${more})
expect_same_bits(albedo ${spheres} --coat hg:0.8,0.5@1 --mu-in 0.2,0.7)
expect_same_bits(optics index:1.5,0.01,radius=2 --moments 64)
expect_same_bits(phase index:2.6,radius=50 --angles 0:180:5)
