"""Builds the wheel and the sdist of miebrdf with CMake (PEP 517); needs the standard library alone.

Settings (``pip install . --config-settings NAME=VALUE``):

build-dir
    A build folder that is configured already; default: build/python, configured here.
cmake-args
    More arguments of CMake's, separated by blanks.
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import shlex
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
        raise SystemExit(
            f"miebrdf: {words[0]} failed; docs/dependencies.md lists the packages that it needs, "
            "and tools/quickstart installs them"
        )


def _build(settings: dict[str, Any]) -> Path:
    """Builds the module. @returns the build folder"""
    folder = Path(settings.get("build-dir", ROOT / "build" / "python")).resolve()
    more = shlex.split(settings.get("cmake-args", ""))
    if not (folder / "CMakeCache.txt").exists():
        _run("cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release",
             "-DMIEBRDF_UNITY=ON", "-DMIEBRDF_BUILD_TOOLS=OFF", "-DBUILD_TESTING=OFF",
             "-DMIEBRDF_PYTHON_REQUIRED=ON", f"-DPython_EXECUTABLE={sys.executable}",
             "-DMIEBRDF_PROCESSOR_PATHS=x86-64-v3;x86-64-v4", *more)  # fmt: skip
    elif more:
        _run("cmake", folder, *more)
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    _run("cmake", "--build", folder, "--parallel", jobs, "--target", "miebrdf_python")
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
    name = f"miebrdf-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as stage:
        _run("cmake", "--install", folder, "--component", "python", "--prefix", stage)
        package = next(Path(stage).rglob("miebrdf/__init__.py")).parent
        contents = {
            f"miebrdf/{path.relative_to(package)}": path.read_bytes()
            for path in sorted(package.rglob("*"))
            if path.is_file()
        }
    for plugin in sorted((Path(folder) / "plugins").glob("miebrdf-netcdf.so")):
        contents[f"miebrdf/{plugin.name}"] = plugin.read_bytes()  # the only one that Python uses
    contents[f"{info}/METADATA"] = _metadata().encode()
    contents[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    contents[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: miebrdf_build\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
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
