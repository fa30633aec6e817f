"""What type checkers say of a program that uses the package: misspelt words are found before it
runs, results have types."""

import shutil
import subprocess
from pathlib import Path

import pytest

import miebrdf

PROGRAM = """
import miebrdf
s = miebrdf.Scene("TiO2", coats=["Au@0.1"], roughness=0.1)
s.brdf(550, 0.5, 0.5, tolerance=1e-4, stokes=3).to_netcdf
s.solve([450, 550]).albedo(0.5).coords, s.coats[0].medium, s.replace(host=1.5).albedo(550, 0.5)
miebrdf.sphere(1.5, [1.0, 2.0]).q_ext.mean()
miebrdf.layer_albedos(0.5, mu_in=0.5).converged.all()
miebrdf.materials.add("ink", [400.0], [1.5], title="black")
s.solve(550).export("x.bsdf", resolution=12, accept_error=True)[0]["bytes"] + 1
s.roughness + 1.0, s.replace(roughness=0.2).solve(550).scene.host
s.roughness = 0.2  # wrong
s.coats = ()  # wrong
s.rougness = 0.2  # wrong
s.solve(550).wavelengths_nm = [450.0]  # wrong
s.solve(550).export("x.bsdf", resolutoin=12)  # wrong
s.solve(550).export("x.bsdf", rgb="cei")  # wrong
miebrdf.export(lambda i, o, a: i, 550, "x.bsdf", acept_error=True)  # wrong
miebrdf.Scene("TiO2", radius=1)  # wrong
s.brdf(550, 0.5, 0.5, tolerence=1)  # wrong
s.solve(550, stream=3)  # wrong
s.solve(550, grid="best")  # wrong
s.replace(roughnes=1)  # wrong
s.albedo(550, 0.5, tolerence=3)  # wrong
s.roughnes  # wrong
s.solve(550).albdo(0.5)  # wrong
miebrdf.medium("TiO2", radius=1)  # wrong
miebrdf.coat("TiO2", depht=1)  # wrong
miebrdf.set_options(thread=1)  # wrong
miebrdf.layer_albedos(0.5, optical_dept=1)  # wrong
miebrdf.sphere(1.5, 1.0).qext  # wrong
miebrdf.materials.add("ink", [400.0], [1.5], titel="black")  # wrong
miebrdf.fit("x.toml", tolerance=1)  # wrong
"""


def test_misspelt_words_are_found_before_the_program_runs(tmp_path):
    checker = shutil.which("mypy")
    if checker is None:
        pytest.skip("mypy is not installed")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    settings = tmp_path / "mypy.ini"
    settings.write_text(
        "[mypy]\nenable_incomplete_feature = Unpack\nignore_missing_imports = True\n"
        f"mypy_path = {Path(miebrdf.__file__).parents[1]}\n"
    )
    done = subprocess.run(
        [checker, "--config-file", settings, "--cache-dir", tmp_path / "cache", program],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "program.py:" in done.stdout, done.stdout + done.stderr
    found = {
        int(line.split(":")[1])
        for line in done.stdout.splitlines()
        if "program.py:" in line and " error: " in line
    }
    wrong = {n for n, line in enumerate(PROGRAM.splitlines(), 1) if line.endswith("# wrong")}
    assert found == wrong, done.stdout
