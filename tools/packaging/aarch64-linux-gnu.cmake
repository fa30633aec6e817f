# Cross-compiles for 64-bit ARM on Debian, and runs what is built by QEMU, the tests included:
#
#   dpkg --add-architecture arm64 && apt update
#   apt install g++-aarch64-linux-gnu qemu-user cmake ninja-build pkg-config catch2 libeigen3-dev \
#       libboost-dev nlohmann-json3-dev $(for each in sqlite3 fmt tbb tomlplusplus pugixml yaml \
#       sodium openexr zip; do echo lib$each-dev:arm64; done) zlib1g-dev:arm64
#   cmake -B build/aarch64 -G Ninja --toolchain tools/packaging/aarch64-linux-gnu.cmake \
#       -DMIEBRDF_BUILD_TOOLS=OFF -DMIEBRDF_BUILD_PYTHON=OFF -DMIEBRDF_UNITY=ON
#   ninja -C build/aarch64 test_materials test_math test_mie test_rte
#   ctest --test-dir build/aarch64 -L '^(materials|math|mie|rte)$'
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64)
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)  # notes on a change of GCC 10.1, which nothing here was compiled with
set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
