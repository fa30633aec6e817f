"""Fits: the same as the program's, as an object."""

import json
import math
import os
import signal
import subprocess
import threading

import numpy as np
import pytest
from conftest import PROGRAM

import miebrdf
from miebrdf import _core

pytestmark = pytest.mark.skipif(not _core.has_fit(), reason="this build has no Ceres")

MU = [0.2, 0.5, 0.8, 1.0]


def problem(**more):
    truth = np.asarray(miebrdf.Scene("hg:0.95,0.3").albedo(550, MU, tolerance=1e-5))
    data = [{"values": [value], "wavelength_nm": 550, "mu_in": mu, "quantity": "plane_albedo",
             "sigma": 1e-3, "name": f"mu {mu}"}
            for mu, value in zip(MU, truth.ravel(), strict=True)]  # fmt: skip
    return {
        "scene": {"base": "hg:{w},{g}"},
        "unknowns": {"w": "0.9 in 0.1:0.9999 log1m", "g": "0 in -0.5:0.9"},
        "measured": data,
        **more,
    }


def test_a_dict_gives_back_the_medium():
    found = miebrdf.fit(problem())
    assert found.converged and found.degrees_of_freedom == 2
    assert found["w"] == pytest.approx(0.95, abs=2e-3)
    assert found["g"] == pytest.approx(0.3, abs=5e-2)
    low, high = found.interval("w")
    assert low < 0.95 < high and found.standard_error("w") > 0
    assert found.correlation.shape == (2, 2)
    assert len(found.residuals["model"]) == 4
    with pytest.raises(miebrdf.UsageError, match="the fit has: w, g"):
        found["v"]


def test_reprs_have_values_and_what_is_not_determined():
    found = miebrdf.fit(problem())
    assert "w = 0.9" in repr(found)
    assert "<table>" in found._repr_html_() and "degrees of freedom" in found._repr_html_()


def test_ctrl_c_gives_the_best_so_far():
    slow = {
        "scene": {"base": "index:1.5,{k},radius={r},distribution=mono"},
        "unknowns": {"k": "1e-5 in 1e-7:1e-2 log", "r": "30 in 5:80 log"},
        "measured": [{"values": [0.6] * 20, "wavelength_nm": np.arange(500, 700, 10),
                      "quantity": "spherical_albedo", "sigma": 1e-4}],
    }  # fmt: skip
    timer = threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    try:
        found = miebrdf.fit(slow, threads=1)
        timer.join()  # a fit that has ended before is interrupted here
    except KeyboardInterrupt:
        pytest.skip("the fit has ended before")
    assert found.interrupted and not found.converged
    assert found["k"] > 0 and "interrupted" in repr(found)


def test_wrong_problems_say_what_would_help():
    with pytest.raises(miebrdf.UsageError, match="outside its bounds"):
        miebrdf.fit(problem(unknowns={"w": "2 in 0:1", "g": "0 in -0.5:0.9"}))
    with pytest.raises(miebrdf.InputError, match="cannot be read"):
        miebrdf.fit("no such file.toml")


def test_the_program_says_the_same(tmp_path):
    if not PROGRAM:
        pytest.skip("MIEBRDF_PROGRAM does not name the program")
    file = tmp_path / "fit.toml"
    file.write_text("""
[scene]
base = "hg:{w},0.3"
[unknowns]
w = "0.9 in 0.1:0.9999 log1m"
[[measured]]
values = [0.6, 0.61]
wavelength_nm = [500, 600]
quantity = "hemispherical"
sigma = 0.01
""")
    run = subprocess.run(
        [PROGRAM, "fit", file, "--json", "-q"], check=True, capture_output=True, text=True
    )
    told = json.loads(run.stdout)
    row = dict(zip(told["columns"], told["rows"][0], strict=True))
    found = miebrdf.fit(file)
    assert found["w"] == row["value"]
    assert found.standard_error("w") == row["standard_error"]
    assert math.isnan(found.values["wavelength_nm"][0])


def test_mistakes_of_a_dict_have_no_lines_of_a_file():
    with pytest.raises(miebrdf.UsageError) as caught:
        miebrdf.fit({"scene": {"base": "hg:{w},0.8"}, "unknowns": {"w": "0.9 from 0.1:0.99"},
                     "measured": [{"values": [0.4], "quantity": "spherical_albedo"}]})
    assert "unknown 'w'" in str(caught.value)
    assert "line" not in str(caught.value) and "fit file" not in str(caught.value)
