"""Importing: quick, and with words when an installation is broken."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import miebrdf

PACKAGE = Path(miebrdf.__file__).parent


def run(code, path, **environment):
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(path), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def copied(tmp_path):
    """A copy of the package, to be broken."""
    shutil.copytree(PACKAGE, tmp_path / "miebrdf", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def test_optional_packages_are_not_imported():
    code = (
        "import sys, miebrdf\n"
        "print([m for m in ('xarray', 'matplotlib', 'tqdm', 'pandas') if m in sys.modules])"
    )
    assert run(code, PACKAGE.parent).stdout.strip() == "[]"


def test_import_is_quick():
    """Beside NumPy's own import, which every script pays anyway: less than 150 ms."""
    code = (
        "import numpy, time\n"
        "begin = time.process_time()\n"
        "import miebrdf\n"
        "print(time.process_time() - begin)"
    )
    assert min(float(run(code, PACKAGE.parent).stdout) for _ in range(5)) <= 0.150


def test_a_copy_works(copied):
    done = run("import miebrdf; print(miebrdf.__file__)", copied)
    assert str(copied) in done.stdout, done.stderr


def test_processor_path_is_told_and_forced():
    """Built for one path or for several: the variable chooses of those that are there."""
    code = "import miebrdf; print(miebrdf.processor_path)"
    folders = [folder.name for folder in PACKAGE.glob("glibc-hwcaps/*")]
    for path in [miebrdf.processor_path, *(["x86-64"] if folders else [])]:
        done = run(code, PACKAGE.parent, MIEBRDF_PROCESSOR_PATH=path)
        assert done.stdout.strip() == path, done.stderr
    error = run(code, PACKAGE.parent, MIEBRDF_PROCESSOR_PATH="z80").stderr
    assert "'z80' is not in this build" in error and miebrdf.processor_path in error


def test_two_versions_over_each_other(copied):
    version = copied / "miebrdf" / "_version.py"
    version.write_text('__version__ = "99.0.0"\n')
    error = run("import miebrdf", copied).stderr
    assert "99.0.0" in error and miebrdf.__version__ in error and "remove" in error


def test_built_for_another_python(copied):
    module = next((copied / "miebrdf").glob("_core*.so"))
    module.rename(module.with_name("_core.cpython-39-x86_64-linux-gnu.so"))
    error = run("import miebrdf", copied).stderr
    assert "another Python" in error and "cpython-39" in error


def test_the_source_is_no_installation(copied):
    next((copied / "miebrdf").glob("_core*.so")).unlink()
    error = run("import miebrdf", copied).stderr
    assert "source of miebrdf" in error and "pip install" in error


def test_a_module_that_does_not_load(copied):
    module = next((copied / "miebrdf").glob("_core*.so"))
    module.write_bytes(b"no library of this machine" * 10)
    error = run("import miebrdf", copied).stderr
    assert "cannot be loaded" in error and "build miebrdf again" in error


def test_without_numpy(copied):
    # A finder that hides it, as on a machine without the package.
    (copied / "sitecustomize.py").write_text(
        "import sys\n"
        "class Hide:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.split('.')[0] == 'numpy':\n"
        "            raise ModuleNotFoundError(name)\n"
        "sys.meta_path.insert(0, Hide())\n"
    )
    error = run("import miebrdf", copied).stderr
    assert "NumPy" in error or "numpy" in error


def test_help_is_enough_to_write_a_script():
    text = run("import miebrdf; help(miebrdf.Scene)", PACKAGE.parent, PAGER="cat").stdout
    for word in ("coats", "mu_in", "1/sr", "(0, 1]", "UsageError", "effective_radius_um", "solve("):
        assert word in text, word


def test_every_public_name_has_a_docstring():
    for name in miebrdf.__all__:
        thing = getattr(miebrdf, name)
        if callable(thing):
            assert thing.__doc__, name
