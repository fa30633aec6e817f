# What a builder can choose, and the flags that follow from it.
option(MIEBRDF_NATIVE "Tune for this machine's processor (the binary may not run on others)" OFF)
option(MIEBRDF_WERROR "Warnings of the compilers of continuous integration (gcc 12, clang 14) are errors" OFF)
option(MIEBRDF_SANITIZE "AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
option(MIEBRDF_COVERAGE "Line coverage for gcov" OFF)
option(MIEBRDF_FUZZERS "libFuzzer targets (needs clang)" OFF)
# As a part of another project (add_subdirectory, FetchContent): the library alone, unless it is asked
# for more; nothing of the other project's is set.
option(MIEBRDF_BUILD_TOOLS "The miebrdf program" ${PROJECT_IS_TOP_LEVEL})
option(MIEBRDF_BUILD_PYTHON "The Python package, where pybind11 and NumPy are found" ${PROJECT_IS_TOP_LEVEL})
option(MIEBRDF_PRECOMPILE "Precompiled headers" ON)
set(unity ON)
if(PROJECT_IS_TOP_LEVEL)
    set(unity OFF)
endif()
option(MIEBRDF_UNITY "Several sources are compiled as one" ${unity})

set(MIEBRDF_BUILD_TESTS OFF)
if(PROJECT_IS_TOP_LEVEL)
    if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
        set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
    endif()
    include(CTest)
    set(MIEBRDF_BUILD_TESTS ${BUILD_TESTING})
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# What is installed belongs to developers, unless it says another component: program, extras, python.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)

include(GNUInstallDirs)

# Plug-ins (miebrdf_plugin): where programs of the build folder and installed ones find them.
set(MIEBRDF_PLUGINS_FOLDER "${PROJECT_BINARY_DIR}/plugins")
set(MIEBRDF_INSTALLED_PLUGINS "${CMAKE_INSTALL_LIBDIR}/miebrdf")
set(CMAKE_BUILD_RPATH "$ORIGIN/../../plugins")  # from tools/miebrdf/, tests/sweep/, ...

# Flags of our own targets only; what users compile against us is theirs to choose.
add_library(miebrdf_flags INTERFACE)
target_compile_options(miebrdf_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow
                                               -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual)
if(NOT PROJECT_IS_TOP_LEVEL)
    # Without optimisation everything takes fifty times as long: where the other project has no build
    # type, our own sources have one.
    target_compile_options(miebrdf_flags INTERFACE $<$<CONFIG:>:-O2>)
endif()
# Boost's package defines it for whoever asks for Boost; defined for all, one precompiled header
# serves them all.
target_compile_definitions(miebrdf_flags INTERFACE BOOST_ALL_NO_LIB)
if(MIEBRDF_WERROR)
    # Every new compiler has new warnings: whoever builds with one is told of them, and not stopped.
    set(compiler "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}")
    if(compiler MATCHES "^(GNU 12|Clang 14)\\.")
        target_compile_options(miebrdf_flags INTERFACE -Werror)
    else()
        message(STATUS "${compiler}: warnings stay warnings; they are errors with gcc 12 and clang 14")
    endif()
endif()
if(MIEBRDF_SANITIZE)
    target_compile_options(miebrdf_flags INTERFACE -fsanitize=address,undefined
                           -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
    # The ranges that neither sanitizer sees: an index within the block of memory, but past the size.
    # (Eigen checks its own wherever NDEBUG is not defined; the preset sees to that.)
    target_compile_definitions(miebrdf_flags INTERFACE _GLIBCXX_ASSERTIONS)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # gcc 12 sees uninitialised std::function members in <regex> when it instruments code.
        target_compile_options(miebrdf_flags INTERFACE -Wno-maybe-uninitialized)
    endif()
    target_link_options(miebrdf_flags INTERFACE -fsanitize=address,undefined)
endif()
if(MIEBRDF_FUZZERS)
    # C++ alone: the embedded database is assembled by the C compiler, which may be another.
    target_compile_options(miebrdf_flags INTERFACE
        "$<$<COMPILE_LANGUAGE:CXX>:SHELL:-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer>")
    target_link_options(miebrdf_flags INTERFACE -fsanitize=address,undefined)
endif()
if(MIEBRDF_COVERAGE)
    # -O1: a numerical test suite takes too long without; lines stay apart. Threads count, too.
    target_compile_options(miebrdf_flags INTERFACE --coverage -O1 -fprofile-update=atomic)
    target_link_options(miebrdf_flags INTERFACE --coverage)
endif()
# With AVX-512, gcc 12 warns of its own intrinsics' deliberately uninitialised registers in every
# file that uses Eigen, and at -O3 of array bounds inside std::string; dev finds the real ones.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(MIEBRDF_NOISE_OF_WIDE_VECTORS -Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict
                                      -Wno-array-bounds)
endif()
if(MIEBRDF_NATIVE)
    target_compile_options(miebrdf_flags INTERFACE -march=native ${MIEBRDF_NOISE_OF_WIDE_VECTORS})
endif()
include(MiebrdfProcessorPaths)
