#!/bin/sh
# What tools/package makes, in a root of its own: installed, used and removed without a trace. Debian
# packages, then the wheel and the source archive where there are some.
# debian_packages.sh FOLDER WORK-FOLDER [--compile-source]
# FOLDER holds the packages, or is the build folder of the preset `debian`, which they are made of.
set -eu
mkdir -p "$2"
packages=$(cd "$1" && pwd) work=$(cd "$2" && pwd) compile=${3:-}
skip() { echo "skipped: $*"; exit 0; }
[ "$(id -u)" -eq 0 ] || skip "only root may make a root"
for tool in debootstrap cpack dpkg-shlibdeps chroot; do
    command -v "$tool" >/dev/null || skip "$tool is not installed (debootstrap, cmake, dpkg-dev)"
done
mirror=${MIEBRDF_DEBIAN_MIRROR:-http://deb.debian.org/debian}

if [ -e "$packages/CMakeCache.txt" ]; then
    build=$packages packages=$work/deb
    rm -rf "$packages" && mkdir -p "$packages"
    (cd "$build" && cpack -G DEB -B "$packages" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log"; exit 1; }
    rm -rf "$packages/_CPack_Packages"
fi
ls -l "$packages"
now() { date +%s; }

root=$work/root
# debootstrap may leave file systems of the machine mounted there: these come off first, and nothing
# is ever removed through one.
remove_root() {
    for each in proc sys dev/pts dev; do umount "$root/$each" 2>/dev/null || true; done
    rm -rf --one-file-system "$root"
}
trap remove_root EXIT
if [ ! -e "$work/base.tar" ]; then  # kept for the next time
    remove_root
    debootstrap --variant=minbase bookworm "$root" "$mirror" >"$work/debootstrap.log" 2>&1 ||
        skip "debootstrap cannot make a root here: $(tail -n 1 "$work/debootstrap.log")"
    # Packages may start nothing, and ask nothing.
    printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d" && chmod +x "$root/usr/sbin/policy-rc.d"
    tar -cf "$work/base.tar" --one-file-system --exclude=./proc --exclude=./sys -C "$root" .
fi
remove_root
mkdir -p "$root/proc" "$root/sys" && tar -xf "$work/base.tar" --exclude=./proc --exclude=./sys -C "$root"
mount -t proc proc "$root/proc" 2>/dev/null || echo "no /proc in the new root: it cannot be mounted here"
cp "$packages"/*.deb "$root/root/"
for each in "$packages"/miebrdf-*.whl "$packages"/miebrdf-*.tar.gz; do
    [ ! -e "$each" ] || cp "$each" "$root/root/"
done
in_root() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
in_root apt-get -qq update || skip "no packages can be fetched in the new root"

echo "== install"
started=$(now)
in_root sh -c 'apt-get -qq install -y --no-install-recommends /root/*.deb' >"$work/install.log" 2>&1 ||
    { tail -n 20 "$work/install.log"; exit 1; }
in_root dpkg -l 'miebrdf*' libmiebrdf-dev python3-miebrdf | tail -n 5
in_root python3 -c "import miebrdf; print(miebrdf.Scene(base='TiO2,radius=0.2').brdf(550, 0.5, 0.5))"
echo "from nothing to a BRDF in Python, by apt: $(($(now) - started)) s"
in_root test -s /usr/share/doc/miebrdf/docs/conventions.md -a -s /usr/share/doc/miebrdf/docs/examples/albedo_spectrum.cpp

echo "== the program"
in_root miebrdf --version
in_root miebrdf albedo --base TiO2,radius=0.2 --wavelengths 550 --mu-in 0.5 --quiet
in_root test -s /usr/share/man/man1/miebrdf.1 -a -s /usr/share/bash-completion/completions/miebrdf

echo "== the plug-ins"
in_root miebrdf plot nk TiO2 -o /root/nk.png --quiet
in_root test -s /root/nk.png
in_root sh -c "ls /usr/lib/*/miebrdf/miebrdf-netcdf.so" >/dev/null

echo "== the arithmetic of each processor"
for path in x86-64-v3 x86-64-v4; do
    for name in math mie rte; do
        in_root sh -c "ls /usr/lib/*/glibc-hwcaps/$path/libmiebrdf_$name.so.*" >/dev/null ||
            { echo "not packaged: libmiebrdf_$name for $path"; exit 1; }
    done
done
in_root miebrdf --version >"$work/version"
grep -q 'x86-64' "$work/version" || { echo "--version names no processor path"; exit 1; }
values=""
for path in x86-64 x86-64-v3 x86-64-v4; do
    if one=$(in_root env MIEBRDF_PROCESSOR_PATH=$path miebrdf albedo --base Fe2O3,radius=0.2 \
                 --wavelengths 550 --mu-in 0.5 --no-comments --quiet 2>"$work/path.err"); then
        echo "$path: $(echo "$one" | tail -n 1)"
        values="$values $(echo "$one" | tail -n 1 | sed 's/.*,//')"
    elif grep -q 'cannot run' "$work/path.err"; then
        echo "$path: not on this processor"
    else
        cat "$work/path.err"; exit 1
    fi
done
# A hundredth of the tolerance, as docs/dependencies.md promises.
echo "$values" | awk '{ for (i = 2; i <= NF; ++i) if (!(($i - $1) ^ 2 <= 1e-10)) exit 1 }' ||
    { echo "paths differ by more than 1e-5:$values"; exit 1; }

echo "== Python"
in_root python3 -c "
import miebrdf, numpy
b = miebrdf.Scene(base='TiO2,radius=0.2', coats=[miebrdf.coat('Au', depth=0.5, radius_um=0.03)]).solve([450, 550, 650])
print(miebrdf.__file__, b(0.5, numpy.array([0.3, 0.9]))[1])"

echo "== a plot in Python"
in_root sh -c 'apt-get -qq install -y --no-install-recommends python3-matplotlib' \
    >"$work/matplotlib.log" 2>&1 || { tail -n 20 "$work/matplotlib.log"; exit 1; }
in_root env MPLBACKEND=Agg python3 -c "
import miebrdf, numpy
from matplotlib import image, pyplot
b = miebrdf.Scene(base='TiO2,radius=0.2', coats=[miebrdf.coat('Au', depth=0.5, radius_um=0.03)]).solve([450, 550, 650])
b.plot_lobe()
pyplot.savefig('/root/lobe.png', dpi=150)
seen = image.imread('/root/lobe.png')[:, :, :3]
coloured = numpy.ptp(seen, axis=2) > 0.3
assert coloured.sum() > 500, 'three coloured curves should be in the picture'
print('lobe.png:', seen.shape[1], 'x', seen.shape[0], 'pixels,', coloured.sum(), 'of them in curves')"
cp "$root/root/lobe.png" "$work/lobe.png"

echo "== a program of one's own"
in_root sh -c 'apt-get -qq install -y --no-install-recommends g++ pkg-config' >"$work/compiler.log" 2>&1
cat >"$root/root/own.cpp" <<'END'
#include <miebrdf/miebrdf.h>
#include <iostream>
int main() { std::cout << miebrdf::mie::scatter_by_sphere({1.5, 0.0}, 1.0).q_ext << '\n'; }
END
in_root sh -c 'cd /root && g++ -std=c++20 own.cpp -o own $(pkg-config --cflags --libs miebrdf) && ./own'

echo "== purge"
in_root apt-get -qq purge -y miebrdf miebrdf-extras libmiebrdf-dev python3-miebrdf miebrdf-doc >"$work/purge.log" 2>&1
left=$(in_root find /usr /etc /var/lib -name '*miebrdf*' -not -path '*/dpkg/*' -not -path '*/apt/*')
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
if in_root dpkg -l 2>/dev/null | grep miebrdf; then echo "dpkg still knows a package"; exit 1; fi
echo "installed, used and purged"

wheel=$(ls "$packages"/miebrdf-*.whl 2>/dev/null | head -n 1)
if [ -n "$wheel" ]; then
    echo "== the wheel"
    # What it is linked to: the same packages as python3-miebrdf, found by the names of the libraries.
    libraries=$(dpkg-deb -f "$packages"/miebrdf_*.deb Depends | tr ',' '\n' | sed 's/ *[(|].*//; s/ //g' | grep '^lib')
    started=$(now)
    in_root sh -c "apt-get -qq install -y --no-install-recommends python3-venv python3-numpy $(echo $libraries)" \
        >"$work/wheel.log" 2>&1 || { tail -n 20 "$work/wheel.log"; exit 1; }
    in_root python3 -m venv --system-site-packages /root/venv
    in_root sh -c '/root/venv/bin/pip install --no-index /root/miebrdf-*.whl' >"$work/wheel.log" 2>&1 ||
        { tail -n 20 "$work/wheel.log"; exit 1; }
    in_root /root/venv/bin/python -c "
import miebrdf
print(miebrdf.__file__, miebrdf.Scene(base='TiO2,radius=0.2').brdf(550, 0.5, 0.5))"
    echo "from nothing to a BRDF in Python, by the wheel: $(($(now) - started)) s"
fi

if [ "$compile" = --compile-source ]; then
    echo "== the source archive, compiled"
    started=$(now)
    # What is missing is named by the first try; the second one has it.
    in_root sh -c 'apt-get -qq install -y --no-install-recommends g++ cmake ninja-build python3-venv python3-numpy' \
        >"$work/source.log" 2>&1 || { tail -n 20 "$work/source.log"; exit 1; }
    in_root python3 -m venv --clear --system-site-packages /root/venv
    if in_root sh -c '/root/venv/bin/pip install /root/miebrdf-*.tar.gz' >"$work/source.log" 2>&1; then
        echo "the source was compiled without its libraries"; exit 1
    fi
    install=$(sed -n 's/.*sudo \(apt install .*\)/\1/p' "$work/source.log" | head -n 1)
    [ -n "$install" ] || { tail -n 30 "$work/source.log"; echo "no line for apt was named"; exit 1; }
    echo "named: $install"
    in_root sh -c "apt-get -qq install -y --no-install-recommends ${install#apt install}" >"$work/source.log" 2>&1
    in_root sh -c '/root/venv/bin/pip install /root/miebrdf-*.tar.gz' >"$work/source.log" 2>&1 ||
        { tail -n 30 "$work/source.log"; exit 1; }
    in_root /root/venv/bin/python -c "
import miebrdf
print(miebrdf.__file__, miebrdf.Scene(base='TiO2,radius=0.2').brdf(550, 0.5, 0.5))"
    echo "from nothing to a BRDF in Python, by pip from source: $(($(now) - started)) s"
fi
