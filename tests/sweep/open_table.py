#!/usr/bin/env python3
"""Opens a table of `miebrdf sweep` as the field does: with xarray, netCDF4 and ncdump.

    open_table.py PROGRAM FOLDER
"""
import pathlib
import subprocess
import sys

try:
    import netCDF4
    import numpy as np
    import xarray as xr
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(0)

SWEEP = """title = "two media"
outputs = ["plane_albedo", "spherical_albedo"]
[scene]
base = "{medium}"
substrate = "{ground}"
coat = "hg:{albedo},0.2@1"
[axes]
medium = ["hg:0.9,0.3", "isotropic:0.5"]
ground = ["", "black"]
albedo = [0.1, 0.5, 0.9, 1.1]
mu_in = [0.25, 0.5, 1]
wavelength_nm = [500, 600]
"""


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "sweep.toml").write_text(SWEEP)
    table = folder / "table.nc"
    table.unlink(missing_ok=True)
    run = subprocess.run([program, "sweep", str(folder / "sweep.toml"), "-o", str(table)],
                         capture_output=True, text=True)
    assert run.returncode == 4, run.stderr  # an albedo of 1.1 fails; the others do not suffer
    assert "4 failed" in run.stderr, run.stderr

    data = xr.open_dataset(table)
    assert data.sizes == {"medium": 2, "ground": 2, "albedo": 4, "wavelength_nm": 2, "mu_in": 3,
                          "remark": 4}, data.sizes
    assert data.attrs["Conventions"] == "CF-1.8"
    assert data.plane_albedo.units == "1" and data.wavelength_nm.units == "nm"
    assert list(data.medium.values) == ["hg:0.9,0.3", "isotropic:0.5"]
    one = data.plane_albedo.sel(medium="isotropic:0.5", ground="", albedo=0.5, mu_in=0.5)
    alone = subprocess.run([program, "albedo", "--base", "isotropic:0.5", "--coat", "hg:0.5,0.2@1",
                            "--wavelengths", "500,600", "--mu-in", "0.25,0.5,1", "--no-cache"],
                           capture_output=True, text=True, check=True).stdout
    rows = [line.split(",") for line in alone.splitlines() if not line.startswith("#")]
    column, incidence = rows[0].index("plane_albedo"), rows[0].index("mu_in")
    expected = [float(row[column]) for row in rows[1:] if row[incidence] == "0.5"]
    assert list(one.values) == expected, (one.values, expected)  # to the last bit

    failed = data.sel(albedo=1.1)
    assert np.isnan(failed.plane_albedo.values).all() and (failed.converged.values == 0).all()
    good = data.sel(albedo=[0.1, 0.5, 0.9])
    assert np.isfinite(good.plane_albedo.values).all() and (good.converged.values == 1).all()
    assert (good.error_estimate.values <= 1e-3).all()
    assert all("1.1" in str(text) for text in data.remark.values), data.remark.values

    with netCDF4.Dataset(table) as raw:
        filters = raw["plane_albedo"].filters()
        assert filters["zlib"] and filters["shuffle"], filters
        assert np.isnan(raw["plane_albedo"]._FillValue)
        assert raw["plane_albedo"].ancillary_variables == "error_estimate converged"
    dump = subprocess.run(["ncdump", "-h", str(table)], capture_output=True, text=True)
    if dump.returncode == 0:
        assert "double plane_albedo(medium, ground, albedo, wavelength_nm, mu_in)" in dump.stdout
    print("opened with xarray, netCDF4 and ncdump")


main()
