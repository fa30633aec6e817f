"""What the tests share: the program beside the package, and how its CSV is read."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import miebrdf

PROGRAM = os.environ.get("MIEBRDF_PROGRAM", "")


def _number(text):
    """Not a number for empty cells and words."""
    try:
        return float(text)
    except ValueError:
        return np.nan


@pytest.fixture(autouse=True)
def plain_arrays():
    """NumPy arrays unless a test asks for more; no cache of the user's, no output."""
    before = miebrdf.set_options(xarray=False, progress=False)
    yield
    miebrdf.set_options(**before)


@pytest.fixture(scope="session")
def program():
    """Runs the program and gives its CSV as columns of numbers."""
    if not Path(PROGRAM).is_file():
        pytest.skip("MIEBRDF_PROGRAM does not name the program")

    def run(*words):
        done = subprocess.run(
            [PROGRAM, *map(str, words)], capture_output=True, text=True, check=False
        )
        # 4: written, but not converged.
        assert done.returncode in (0, 4), done.stderr
        lines = [line for line in done.stdout.splitlines() if not line.startswith("#")]
        names = lines[0].split(",")
        rows = [[_number(x) for x in line.split(",")] for line in lines[1:]]
        return dict(zip(names, np.array(rows).T))

    return run
