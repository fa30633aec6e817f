"""Look-ups in tables of sweeps: nodes, what lies between, and what the program says."""

import subprocess

import numpy as np
import pytest
from conftest import PROGRAM

import miebrdf
from miebrdf import _core

pytestmark = pytest.mark.skipif(not _core.has_netcdf(), reason="this build has no NetCDF")

SWEEP = """outputs = ["spherical_albedo"]
[scene]
base = "{kind}:{albedo},{g}"
tolerance = 1e-3
[axes]
kind = ["hg"]
albedo = "0.1:0.9:9 linear"
g = [0, 0.2, 0.4]
wavelength_nm = [500, 600]
"""


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    folder = tmp_path_factory.mktemp("table")
    (folder / "s.toml").write_text(SWEEP)
    if not PROGRAM:
        pytest.skip("MIEBRDF_PROGRAM does not name the program")
    subprocess.run([PROGRAM, "sweep", folder / "s.toml", "-q", "-o", folder / "t.nc"], check=True)
    return folder / "t.nc"


def test_nodes_are_what_the_solver_says(table):
    found = miebrdf.lookup(table, kind="hg", albedo=0.5, g=0.2, wavelength_nm=500)
    exact = miebrdf.Scene("hg:0.5,0.2").albedo(500, tolerance=1e-3)
    assert found.value == pytest.approx(float(exact), abs=1e-15)
    assert found.interpolation_error == 0 and found.unit == "1"


def test_between_nodes_the_error_is_estimated(table):
    exact = float(miebrdf.Scene("hg:0.84,0.2").albedo(500, tolerance=1e-3))
    for interpolation in "linear", "cubic":
        found = miebrdf.lookup(
            table, kind="hg", albedo=0.84, g=0.2, wavelength=500, interpolation=interpolation
        )
        # An estimate from one derivative: within a factor of three where that varies.
        assert 0 < abs(found.value - exact) <= 3 * found.interpolation_error
    assert found.interpolation_error < 0.01 * exact


def test_it_says_what_the_program_says(table, program):
    one = "--variables", "spherical_albedo"
    rows = program("lookup", table, "--albedo", 0.33, "--wavelength", 550, *one)
    found = miebrdf.lookup(table, albedo=0.33, wavelength_nm=550)
    assert found.value.size == 3  # one kind, three values of g
    assert np.array_equal(found.value.reshape(-1), rows["value"])


def test_listed_axes_are_labelled(table):
    pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    found = miebrdf.lookup(table, kind="hg", albedo=0.3)
    assert found.value.dims == ("g", "wavelength_nm")
    assert found.value.wavelength_nm.units == "nm"
    assert found.value.sel(g=0.4, wavelength_nm=600) > 0


def test_refusals_name_what_there_is(table, tmp_path):
    with pytest.raises(miebrdf.UsageError, match="outside of the table"):
        miebrdf.lookup(table, albedo=0.95)
    with pytest.raises(miebrdf.UsageError, match=r"no axis 'radius'.*albedo"):
        miebrdf.lookup(table, radius=3)
    with pytest.raises(miebrdf.UsageError, match=r"no variable 'brdf'.*spherical_albedo"):
        miebrdf.lookup(table, variables="brdf")
    with pytest.raises(miebrdf.UsageError, match="one value"):
        miebrdf.lookup(table, albedo=[0.1, 0.2])
    with pytest.raises(miebrdf.UsageError, match="linear, cubic"):
        miebrdf.lookup(table, interpolation="spline")
    (tmp_path / "no.nc").write_text("no table")
    with pytest.raises(miebrdf.InputError):
        miebrdf.lookup(tmp_path / "no.nc", albedo=0.5)
