#!/usr/bin/env python3
"""Opens a table of `miebrdf sweep` as the field does: with xarray, netCDF4 and ncdump.

    open_table.py PROGRAM FOLDER
"""
import pathlib
import shutil
import subprocess
import sys

try:
    import netCDF4
    import numpy as np
    import scipy.io
    import xarray as xr
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(0)
if shutil.which("ncdump") is None:
    print("skipped: there is no program ncdump (package netcdf-bin)")
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


ERADIATE = """outputs = ["brdf"]
layout = "eradiate"
[scene]
base = "hg:0.9,{g}"
[axes]
g = 0.4
mu_in = "0:1:5 linear"
mu_out = "0:1:3 linear"
azimuth_deg = "0:270:90"
wavelength_nm = [500, 600]
"""


def eradiate(program, folder):
    """What Eradiate checks of a measured surface's BRDF, and values at their directions."""
    (folder / "eradiate.toml").write_text(ERADIATE)
    (folder / "grey.toml").write_text(ERADIATE.replace("[500, 600]", "550").replace("{g}", "0.4")
                                      .replace("g = 0.4\n", ""))
    for name in "eradiate", "grey":
        (folder / f"{name}.nc").unlink(missing_ok=True)
        subprocess.run([program, "sweep", str(folder / f"{name}.toml"), "-q", "-o",
                        str(folder / f"{name}.nc")], check=True)
    grey = xr.open_dataset(folder / "grey.nc")
    assert grey.brdf.dims == ("cos_theta_o", "phi_d", "cos_theta_i"), grey.brdf.dims
    assert float(grey.w) == 550 and grey.w.units == "nm"
    data = xr.open_dataset(folder / "eradiate.nc")
    assert data.brdf.dims == ("g", "cos_theta_o", "phi_d", "cos_theta_i", "w"), data.brdf.dims
    for name, size in (("cos_theta_o", 3), ("cos_theta_i", 5)):
        assert np.allclose(data[name], np.linspace(0, 1, size)) and data[name].units
    assert np.allclose(data.phi_d, np.linspace(0, 2 * np.pi, 4, endpoint=False))
    assert data.phi_d.units == "rad" and data.w.units == "nm"
    assert np.isfinite(data.brdf).all()
    # Our azimuth 0 is the mirror's side, pi of theirs; hg:0.9,0.4 scatters forward.
    alone = subprocess.run([program, "brdf", "--base", "hg:0.9,0.4", "--wavelengths", "500",
                            "--mu-in", "0.25,0.5,0.75,1", "--mu-out", "0.5,1", "--azimuth",
                            "0,90,180", "--no-cache"], capture_output=True, text=True, check=True)
    lines = [line.split(",") for line in alone.stdout.splitlines() if not line.startswith("#")]
    for row in lines[1:]:
        _, mu_in, mu_out, azimuth, value = (float(cell) for cell in row[:5])
        phi = np.pi * (1 - azimuth / 180)
        stored = float(data.brdf.isel(g=0, w=0).sel(cos_theta_o=mu_out, phi_d=phi,
                                                    cos_theta_i=mu_in, method="nearest"))
        assert abs(stored / value - 1) <= 1e-3, (row, stored)  # other directions are asked beside
    forward = data.brdf.isel(g=0, w=0, cos_theta_i=1, cos_theta_o=1)
    assert float(forward.isel(phi_d=2)) > 1.2 * float(forward.isel(phi_d=0))


ISOFIT = """outputs = ["hdrf"]
diffuse_fraction = 0
layout = "isofit"
[scene]
base = "hg:{albedo},{long_name_g}"
[axes]
albedo = [0.5, 0.9]
long_name_g = [0, 0.3, 0.6]
theta_in_deg = [0, 30, 60]
theta_out_deg = [0, 20]
azimuth_deg = 90
wavelength_nm = [500, 600, 700]
"""


CRTM = """outputs = ["plane_albedo"]
layout = "crtm-snow"
[scene]
coat = "H2O_ice,radius={radius_um}@{depth_m}m"
layer-density = "{density_kg_m3}"
substrate = "lambert:0.2"
tolerance = 1e-2
[axes]
density_kg_m3 = [100, 200, 300, 400]
radius_um = [50, 100, 200, 500]
depth_m = [0.001, 0.01, 0.1, 1]
theta_in_deg = [0, 30, 60, 75]
wavelength_nm = [1300, 1500, 1700, 1900, 2100]
"""


def rows_of(program, *words):
    """Columns of what the program prints."""
    run = subprocess.run([program, *words, "--no-cache"], capture_output=True, text=True,
                         check=True)
    lines = [line.split(",") for line in run.stdout.splitlines() if not line.startswith("#")]
    return [dict(zip(lines[0], map(float, line))) for line in lines[1:]]


def isofit(program, folder):
    """What isofit/surface reads of its MAT-files, and how: LUTSurface, MultiComponentSurface."""
    for layout in "isofit", "isofit-surface":
        (folder / f"{layout}.toml").write_text(ISOFIT.replace('"isofit"', f'"{layout}"'))
        (folder / f"{layout}.mat").unlink(missing_ok=True)
        for _ in range(2):  # the second run finds it complete
            run = subprocess.run([program, "sweep", str(folder / f"{layout}.toml"), "-o",
                                  str(folder / f"{layout}.mat")], capture_output=True, text=True)
            assert run.returncode == 0, run.stderr
        assert "complete already" in run.stderr, run.stderr
    model = scipy.io.loadmat(str(folder / "isofit.mat"))
    names = [name.strip() for name in model["lut_names"]]
    states = [name.strip() for name in model["statevec_names"]]
    assert names[2:] == ["SOLZEN", "VIEWZEN"] and names[:2] == states, names
    assert sorted(states) == ["albedo", "long_name_g"], states
    grid = [axis[0] for axis in model["grids"][0]]
    assert [list(axis) for axis in grid[2:]] == [[0, 30, 60], [0, 20]], grid
    assert list(model["wl"][0]) == [500, 600, 700]
    data = model["data"]
    assert data.shape == tuple(len(axis) for axis in grid) + (3,), data.shape
    assert model["bounds"].shape == (2, 2)
    for s, state in enumerate(states):
        low, high = grid[s][0], grid[s][-1]
        assert list(model["bounds"][s]) == [low, high], state
        assert model["mean"][0][s] == model["init"][0][s] == (low + high) / 2
        assert model["sigma"][0][s] == model["scale"][0][s] == high - low
    alone = rows_of(program, "brdf", "--base", "hg:0.9,0.3", "--wavelengths", "500", "--theta-in",
                    "0,30,60", "--theta-out", "0,20", "--azimuth", "90")
    at = tuple(list(grid[s]).index({"albedo": 0.9, "long_name_g": 0.3}[state])
               for s, state in enumerate(states))
    for i in range(3):
        for o in range(2):
            expected = np.pi * alone[2 * i + o]["brdf"]
            assert np.allclose(data[at + (i, o)], expected, rtol=1e-3), (i, o)

    component = scipy.io.loadmat(str(folder / "isofit-surface.mat"))
    spectra = data.reshape(-1, 3)
    assert component["means"].shape == (1, 3) and component["covs"].shape == (1, 3, 3)
    assert np.allclose(component["means"][0], spectra.mean(axis=0), rtol=1e-12)
    apart = component["covs"][0] - np.cov(spectra.T)
    # What the error of the values adds to variances: at most the square of the tolerance.
    assert np.allclose(apart, np.diag(np.diag(apart)), atol=1e-15)
    assert (np.diag(apart) >= 0).all() and (np.diag(apart) <= 1e-6 * (spectra**2).max()).all()
    assert component["normalize"] == "None" and list(component["refwl"][0]) == [500, 600, 700]


def crtm(program, folder):
    """Names, order and units that CRTM's module VISsnowCoeff_netCDF_IO reads."""
    (folder / "crtm.toml").write_text(CRTM)
    table = folder / "SNICAR.VISsnow.EmisCoeff.nc"
    table.unlink(missing_ok=True)
    for _ in range(2):
        run = subprocess.run([program, "sweep", str(folder / "crtm.toml"), "-o", str(table)],
                             capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
    assert "complete already" in run.stderr, run.stderr
    with netCDF4.Dataset(table) as raw:
        assert int(raw.Release) == 1 and int(raw.Version) == 1
        assert raw.Classification_Name == "SNICAR" and raw.Title and raw.History and raw.Comment
        assert raw["Reflectance"].dimensions == ("n_Densities", "n_Depths", "n_Grain_Sizes",
                                                 "n_Frequencies", "n_Angles")
        for name, unit, values in (
                ("Density", "kg/m^3", [100, 200, 300, 400]),
                ("Depth", "meters", [0.001, 0.01, 0.1, 1]),
                ("Grain_Size", "effective radius in microns (um)", [50, 100, 200, 500]),
                ("Frequency", "inverse centimeters (cm^-1)",
                 [1e7 / nm for nm in (2100, 1900, 1700, 1500, 1300)]),
                ("Angle", "degrees from vertical", [0, 30, 60, 75])):
            assert np.allclose(raw[name][:], values, rtol=1e-14), name
            assert raw[name].units == unit and raw[name].dtype == "f8", name
        reflectance = np.array(raw["Reflectance"][:])
    alone = rows_of(program, "albedo", "--coat", "H2O_ice,radius=200@10mm", "--layer-density", "300",
                    "--substrate", "lambert:0.2", "--wavelengths", "1300:2100:200", "--theta-in",
                    "0,30,60,75", "--tolerance", "1e-2")
    for row in alone:
        if row["mu_in"] != row["mu_in"]:
            continue
        f = [2100, 1900, 1700, 1500, 1300].index(row["wavelength_nm"])
        a = int(np.argmin(np.abs(np.cos(np.radians([0, 30, 60, 75])) - row["mu_in"])))
        stored = reflectance[2, 1, 2, f, a]
        assert abs(stored / row["plane_albedo"] - 1) <= 2e-2, (row, stored)


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
    dump = subprocess.run(["ncdump", "-h", str(table)], capture_output=True, text=True,
                          check=True)
    assert "double plane_albedo(medium, ground, albedo, wavelength_nm, mu_in)" in dump.stdout
    eradiate(program, folder)
    isofit(program, folder)
    crtm(program, folder)
    print("opened with xarray, netCDF4 and ncdump")


main()
