"""What is wrong with an installation, said before anything else fails."""

from __future__ import annotations

import os
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec
from pathlib import Path

_FOLDER = Path(__file__).parent


def check() -> None:
    """Import the compiled module, or say why that cannot be.

    Raises
    ------
    ImportError
        With what is missing or does not fit, and how to mend it.
    """
    if sys.version_info < (3, 11):  # noqa: UP036 - PYTHONPATH knows no requires-python
        version = ".".join(map(str, sys.version_info[:3]))
        raise ImportError(f"miebrdf needs Python 3.11 or later; this is {version}")
    if "numpy" not in sys.modules and find_spec("numpy") is None:
        raise ImportError(
            f"miebrdf needs NumPy, which {sys.executable} does not have; "
            "`apt install python3-numpy` or `pip install numpy`"
        )
    if not any((_FOLDER / f"_core{suffix}").exists() for suffix in EXTENSION_SUFFIXES):
        raise ImportError(_missing_module())
    asked = os.environ.get("MIEBRDF_PROCESSOR_PATH", "")
    if asked:
        _load_arithmetic(asked)
    try:
        from . import _core
    except ImportError as error:
        raise ImportError(
            f"the compiled part of miebrdf cannot be loaded: {error}; "
            "a library that it was built with is missing or has another version: install it, or "
            "build miebrdf again on this machine (`pip install .`)"
        ) from error
    try:
        from ._version import __version__
    except ImportError:
        raise ImportError(
            f"{_FOLDER} is the source of miebrdf, not an installation; "
            "install it (`pip install .` in the folder of pyproject.toml) or "
            "put BUILD-FOLDER/tools/python/package into PYTHONPATH"
        ) from None
    if _core.version != __version__:
        raise ImportError(
            f"the Python files of miebrdf are of version {__version__}, its compiled part "
            f"({_core.__file__}) is of {_core.version}: two installations lie over each other; "
            f"remove {_FOLDER} and install miebrdf again"
        )
    if asked and _core.processor_path != asked:
        raise ImportError(
            f"MIEBRDF_PROCESSOR_PATH: '{asked}' is not in this build, whose arithmetic is for "
            f"{_core.processor_path} alone"
        )


def _load_arithmetic(path: str) -> None:
    """Load the libraries for this processor path, so that _core finds them loaded already."""
    if not any(_FOLDER.glob("libmiebrdf_math.so.*")):
        return  # a build for one path
    folders = {each.name: each for each in sorted(_FOLDER.glob("glibc-hwcaps/*"))}
    # The libraries for every processor have the one name that no folder has.
    folder = folders.get(path, _FOLDER if path == "x86-64" else None)
    if folder is None:
        allowed = ", ".join(["x86-64", *folders])
        raise ImportError(
            f"MIEBRDF_PROCESSOR_PATH: '{path}' is not in this build; allowed: {allowed}"
        )
    if not _runs_here(path):
        raise ImportError(f"MIEBRDF_PROCESSOR_PATH: this processor cannot run {path}")
    import ctypes

    for name in ("math", "mie", "rte"):  # those first that others need
        for library in folder.glob(f"libmiebrdf_{name}.so.*"):
            ctypes.CDLL(str(library))


def _runs_here(path: str) -> bool:
    """Whether the processor has the instructions of a path; unknown counts as yes."""
    needed = {
        "x86-64-v2": {"sse4_2", "popcnt"},
        "x86-64-v3": {"avx2", "fma", "bmi2"},
        "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    }
    try:
        words = Path("/proc/cpuinfo").read_text().split("flags", 2)[1].split("\n", 1)[0].split()
    except (OSError, IndexError):
        return True
    return needed.get(path, set()) <= set(words)


def _missing_module() -> str:
    others = sorted(path.name for path in _FOLDER.glob("_core*.so"))
    here = f"Python {sys.version_info[0]}.{sys.version_info[1]} ({EXTENSION_SUFFIXES[0]})"
    if others:
        return (
            f"miebrdf was built for another Python: {_FOLDER} has {', '.join(others)}, and this is "
            f"{here}; use that Python, or build for this one "
            "(`pip install .`)"
        )
    return (
        f"{_FOLDER} has no compiled module: this is the source of miebrdf, not an installation; "
        "install it (`pip install .` in the folder of pyproject.toml) or put "
        "BUILD-FOLDER/tools/python/package into PYTHONPATH"
    )
