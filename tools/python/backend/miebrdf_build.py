"""Builds the wheel and the sdist of miebrdf with CMake (PEP 517); needs the standard library alone.

Settings (``pip install . --config-settings NAME=VALUE``):

build-dir
    A build folder that is configured already; default: build/python, configured here.
cmake-args
    More arguments of CMake's, separated by blanks.
paths
    Processors whose arithmetic the wheel holds beside the one that every processor runs: ``here``
    (default: the best path of this machine; half the time to compile), ``all`` (for wheels that are
    given away), ``none``, or a list as x86-64-v3;x86-64-v4.

It says how long it takes and how far it is: on the terminal, too, where pip keeps what it prints.
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
# A source distribution leaves these out.
_NOT_SOURCES = {".git", "build", "out", "__pycache__", ".mypy_cache", ".ruff_cache"}
# Entries of wheels have a date; one that does not change makes builds reproducible.
_DATE = (2020, 1, 1, 0, 0, 0)
# Minutes of one processor that was busy with other work, too (docs/python.md): everything once, and
# the arithmetic for one more path.
_MINUTES_BASE, _MINUTES_PATH = 10.5, 5.5


def get_requires_for_build_wheel(config_settings: dict[str, Any] | None = None) -> list[str]:
    return []


def get_requires_for_build_sdist(config_settings: dict[str, Any] | None = None) -> list[str]:
    return []


def _version() -> str:
    found = re.search(r"project\(miebrdf VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        raise SystemExit(f"{ROOT}/CMakeLists.txt: no version found")
    return found.group(1)


def _metadata() -> str:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {_version()}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {each}" for each in project["dependencies"]),
    ]
    for extra, packages in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {each}; extra == "{extra}"' for each in packages]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / project["readme"]).read_text()]
    return "\n".join(lines)


def _tag() -> str:
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def _run(*command: str | Path) -> None:
    words = [str(word) for word in command]
    print("+", shlex.join(words), flush=True)
    try:
        done = subprocess.run(words, check=False)
    except FileNotFoundError:
        raise SystemExit(
            f"miebrdf: {words[0]} is not installed; `apt install cmake ninja-build g++`"
        ) from None
    if done.returncode != 0:
        raise SystemExit(f"miebrdf: {words[0]} failed; what it said stands above")


def _say(text: str) -> None:
    """Prints a line, and shows it to who waits for pip, which keeps what backends print."""
    print(f"miebrdf: {text}", flush=True)
    if not sys.stdout.isatty():
        try:
            with open("/dev/tty", "w") as terminal:
                terminal.write(f"\r\033[K  miebrdf: {text}\n")
        except OSError:
            pass  # nobody is there


def _run_with_progress(*command: str | Path) -> None:
    """As _run; each tenth of Ninja's (or make's) steps is said."""
    words = [str(word) for word in command]
    print("+", shlex.join(words), flush=True)
    tenths = 0
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as job:
        assert job.stdout is not None
        for line in job.stdout:
            print(line, end="", flush=True)
            steps = re.match(r"\[(\d+)/(\d+)\]|\[ *(\d+)%\]", line)
            if steps is None:
                continue
            share = int(steps[3]) / 100 if steps[3] else int(steps[1]) / int(steps[2])
            if int(10 * share) > tenths:
                tenths = int(10 * share)
                _say(f"{10 * tenths} % of the steps are done")
    if job.returncode != 0:
        raise SystemExit(f"miebrdf: {words[0]} failed; what it said stands above")


def _paths(wanted: str) -> str:
    """MIEBRDF_PROCESSOR_PATHS for the setting ``paths``."""
    if wanted == "all":
        return "x86-64-v3;x86-64-v4"
    if wanted == "none":
        return ""
    if wanted != "here":
        return wanted
    try:
        flags = set(Path("/proc/cpuinfo").read_text().split("flags", 2)[1].split("\n", 1)[0].split())
    except (OSError, IndexError):
        return ""  # no x86-64, or not Linux: one build for all
    if {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"} <= flags:
        return "x86-64-v4"
    return "x86-64-v3" if {"avx2", "fma", "bmi2"} <= flags else ""


def _is_native(folder: Path) -> bool:
    """Whether a build folder has the instructions of the machine that built it."""
    return "\nMIEBRDF_NATIVE:BOOL=ON\n" in (folder / "CMakeCache.txt").read_text()


def _build(settings: dict[str, Any]) -> Path:
    """Builds the module. @returns the build folder"""
    folder = Path(settings.get("build-dir", ROOT / "build" / "python")).resolve()
    more = shlex.split(settings.get("cmake-args", ""))
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    begun = (folder / "CMakeCache.txt").exists()
    if "build-dir" not in settings or not begun:
        # Every time: an earlier one may have ended where a package was missing, or been for another Python.
        paths = _paths(settings.get("paths", "here"))
        minutes = (_MINUTES_BASE + _MINUTES_PATH * len(paths.split(";") if paths else [])) / float(jobs)
        _say(f"compiling for x86-64{' and ' + paths.replace(';', ', ') if paths else ''} with {jobs} "
             f"processes: about {max(1, round(minutes))} minutes, less on a quiet machine")  # fmt: skip
        wanted = not begun and "CMAKE_GENERATOR" not in os.environ and shutil.which("ninja")
        ninja = ["-G", "Ninja"] if wanted else []
        _run("cmake", "-S", ROOT, "-B", folder, *ninja, "-DCMAKE_BUILD_TYPE=Release",
             "-DMIEBRDF_UNITY=ON", "-DMIEBRDF_BUILD_TOOLS=OFF", "-DBUILD_TESTING=OFF",
             "-DMIEBRDF_PYTHON_REQUIRED=ON", f"-DPython_EXECUTABLE={sys.executable}",
             f"-DMIEBRDF_PROCESSOR_PATHS={paths}", *more)  # fmt: skip
    elif more:
        _run("cmake", folder, *more)
    _run_with_progress("cmake", "--build", folder, "--parallel", jobs, "--target", "miebrdf_python")
    if _is_native(folder):
        _say(f"warning: {folder} is built with MIEBRDF_NATIVE for the processor of this machine; the "
             "wheel (build 0native) may end with 'illegal instruction' on others: leave build-dir "
             "out to make one for all")  # fmt: skip
    return folder


def prepare_metadata_for_build_wheel(
    metadata_directory: str, config_settings: dict[str, Any] | None = None
) -> str:
    folder = f"miebrdf-{_version()}.dist-info"
    (Path(metadata_directory) / folder).mkdir()
    (Path(metadata_directory) / folder / "METADATA").write_text(_metadata())
    return folder


def build_wheel(
    wheel_directory: str,
    config_settings: dict[str, Any] | None = None,
    metadata_directory: str | None = None,
) -> str:
    folder = _build(config_settings or {})
    info = f"miebrdf-{_version()}.dist-info"
    build = "0native" if _is_native(folder) else ""
    name = "-".join(filter(None, ["miebrdf", _version(), build, f"{_tag()}.whl"]))
    with tempfile.TemporaryDirectory() as stage:
        _run("cmake", "--install", folder, "--component", "python", "--prefix", stage)
        package = next(Path(stage).rglob("miebrdf/__init__.py")).parent
        contents = {
            f"miebrdf/{path.relative_to(package)}": path.read_bytes()
            for path in sorted(package.rglob("*"))
            if path.is_file()
        }
    for module in ("miebrdf-ceres.so", "miebrdf-netcdf.so"):  # those that Python uses
        plugin = Path(folder) / "plugins" / module
        if plugin.is_file():
            contents[f"miebrdf/{module}"] = plugin.read_bytes()
    contents[f"{info}/METADATA"] = _metadata().encode()
    contents[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    contents[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: miebrdf_build\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
        + (f"Build: {build}\n" if build else "")
    ).encode()
    record = ""
    for path, content in contents.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{path},sha256={digest},{len(content)}\n"
    contents[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in contents.items():
            entry = zipfile.ZipInfo(path, _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in path else 0o644) << 16
            wheel.writestr(entry, content)
    return name


def build_sdist(sdist_directory: str, config_settings: dict[str, Any] | None = None) -> str:
    top = f"miebrdf-{_version()}"

    def sources(entry: tarfile.TarInfo) -> tarfile.TarInfo | None:
        return None if _NOT_SOURCES & set(Path(entry.name).parts[1:]) else entry

    with tempfile.TemporaryDirectory() as stage:
        information = Path(stage) / "PKG-INFO"
        information.write_text(_metadata())
        with tarfile.open(Path(sdist_directory) / f"{top}.tar.gz", "w:gz") as archive:
            for path in sorted(ROOT.iterdir()):
                if path.name not in _NOT_SOURCES:
                    archive.add(path, f"{top}/{path.name}", filter=sources)
            archive.add(information, f"{top}/PKG-INFO")
    return f"{top}.tar.gz"
