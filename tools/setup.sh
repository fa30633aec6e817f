# Shared by tools/quickstart and tools/check: packages and builds. Sourced, not run.

say() { printf '\n== %s\n' "$*"; }

# Debian's packages, each with its reason in docs/dependencies.md.
packages_program=(g++ cmake ninja-build pkg-config libeigen3-dev libboost-dev libsqlite3-dev
                  libfmt-dev libtbb-dev nlohmann-json3-dev libcli11-dev
                  libtomlplusplus-dev libyaml-dev libsodium-dev libmuparser-dev librsvg2-dev
                  libzip-dev libopenexr-dev libpugixml-dev zlib1g-dev libjs-three libnetcdf-dev libceres-dev libcpp-httplib-dev
                  python3-dev pybind11-dev python3-numpy)
# Rendering is optional; its tests run only with these.
packages_render=("${packages_program[@]}" libembree-dev libtinyobjloader-dev libpng-dev)
packages_tests=("${packages_render[@]}" catch2 python3-pytest)
packages_site=(doxygen python3-sphinx python3-myst-parser python3-breathe python3-numpy)
# What single tests need and say when it is missing: they are skipped.
packages_everything=("${packages_tests[@]}" python3-venv python3-xarray python3-netcdf4 netcdf-bin
                     python3-matplotlib python3-tqdm mypy codespell chromium slurm-wlm munge
                     openmpi-bin debootstrap dpkg-dev "${packages_site[@]}")
packages_package=("${packages_render[@]}" python3-venv debootstrap dpkg-dev)
packages_gates=("${packages_program[@]}" clang clang-format clang-tidy python3-numpy mypy)
packages_coverage=("${packages_everything[@]}" gcovr)

# missing_packages KIND: those of packages_KIND that are not installed
missing_packages() {
    local -n of_kind="packages_$1"
    for package in "${of_kind[@]}"; do
        dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
            echo "$package"
    done | paste -sd ' '
}

# install_missing_packages program|render|tests|everything|gates|coverage|site
install_missing_packages() {
    local -n wanted="packages_$1"
    local missing
    read -ra missing <<<"$(missing_packages "$1")"
    if [ ${#missing[@]} -eq 0 ]; then
        say "all ${#wanted[@]} packages are there"
        return
    fi
    if ! command -v apt-get >/dev/null; then
        echo "No apt-get here. Install these Debian packages' equivalents, then run this again:" >&2
        echo "  ${missing[*]}" >&2
        exit 1
    fi
    say "installing ${#missing[@]} missing packages: ${missing[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || { echo "Neither root nor sudo: install them by hand." >&2; exit 1; }
        as_root=(sudo)
        [ -t 0 ] || as_root=(sudo -n)
    fi
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        "${missing[@]}" >/dev/null
}

configure_preset() {
    local log="build/$1-configure.log"
    mkdir -p build
    cmake --preset "$1" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
}

# build_preset PRESET TARGET
build_preset() {
    say "configuring and building preset '$1' ($(nproc) processors)"
    configure_preset "$1"
    local started=$SECONDS
    cmake --build --preset "$1" --target "$2" --parallel "$(nproc)"
    say "built in $((SECONDS - started)) s"
}
