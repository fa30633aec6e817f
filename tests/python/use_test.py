"""The package as people use it: nothing before it is asked for, names that carry over, files and back."""

import inspect
import time

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene, coat, medium

NM = np.arange(400.0, 701.0, 10.0)
SNOW = Scene(medium("H2O_ice", radius_um=200.0))


def _seconds(work):
    begin = time.process_time()
    work()
    return time.process_time() - begin


def test_solve_computes_nothing_that_is_not_asked_for():
    solved = SNOW.solve(NM)
    assert not solved.is_tabulated and "SNOW" not in solved._repr_html_()
    by_scene = SNOW.albedo(NM, 0.5)
    np.testing.assert_array_equal(solved.albedo(0.5), by_scene)
    assert not solved.is_tabulated
    # The table costs some thirty times the albedos; a factor of 5 leaves room for a busy machine.
    assert 5 * _seconds(lambda: SNOW.solve(NM).albedo(0.5)) < _seconds(lambda: SNOW.solve(NM)(0.5, 0.5))


@pytest.mark.parametrize(
    ("ask", "nearest"),
    [
        (lambda: medium("TiO2", radius=0.2), "radius_um"),
        (lambda: coat("TiO2", depth=1, radius=0.2), "radius_um"),
        (lambda: Scene("TiO2", efective_radius_um=2.0), "effective_radius_um"),
        (lambda: SNOW.solve(550, tolerence=1e-3), "tolerance"),
        (lambda: SNOW.brdf(550, 0.5, 0.5, stream=4), "streams"),
        (lambda: SNOW.albedo(550, 0.5, thread=1), "threads"),
        (lambda: SNOW.replace(hosts=1.3), "host"),
        (lambda: miebrdf.set_options(thread=1), "threads"),
        (lambda: miebrdf.phase("TiO2", 550, [0.0], radius=1.0), "radius_um"),
        (lambda: SNOW.solve(550).export("x.npz", acept_error=True), "accept_error"),
        (lambda: miebrdf.export(np.ones_like, 550, "x.npz", resolutoin=4), "resolution"),
    ],
)
def test_a_misspelt_keyword_names_the_nearest(ask, nearest):
    with pytest.raises(miebrdf.UsageError, match=rf"did you mean {nearest}\?\)"):
        ask()


def test_arguments_of_scenes_for_checkers_are_those_of_scene():
    from miebrdf._keywords import ExportOptions, OfMedium
    from miebrdf._scene import DEFAULTS
    from miebrdf._scene_arguments import SceneArguments

    own = set(inspect.signature(Scene).parameters)
    assert own == set(SceneArguments.__annotations__)
    assert set(inspect.signature(medium).parameters) - {"words"} == set(OfMedium.__annotations__)
    of_formats = {option for each in miebrdf.formats() for option in each["options"]}
    assert of_formats == set(ExportOptions.__annotations__)
    plain = Scene("TiO2")
    assert all(getattr(plain, name) == DEFAULTS[name] for name in own - {"base"})


def test_scenes_show_what_makes_them_different_and_can_be_read():
    scene = Scene("TiO2", coats="hg:0.9,0.1@0.2[grey]", k_floor=1e-3, host=1.5, interpolation="linear")
    assert repr(scene) == (
        "miebrdf.Scene(base='TiO2', coats=['hg:0.9,0.1@0.2[grey]'], host=(1.5+0j), k_floor=0.001, "
        "interpolation='linear')"
    )
    assert scene.host == 1.5 and str(scene.base) == "TiO2" and scene.roughness == 0.0
    assert repr(scene.coats[0]) == "<miebrdf.Layer hg:0.9,0.1@0.2[grey]>"
    with pytest.raises(AttributeError, match=r"scene.replace\(host=...\)"):
        scene.host = 1.3
    with pytest.raises(AttributeError, match="no attribute 'hosts'"):
        scene.hosts = 1.3
    solved = scene.solve([450, 550])
    solved.wavelengths_nm.append(650.0)  # of a copy
    assert solved.wavelengths_nm == [450, 550] and solved.scene == scene
    with pytest.raises(AttributeError):
        solved.scene = scene
    assert scene != scene.replace(k_floor=0.0) and repr(scene) != repr(scene.replace(k_floor=0.0))
    html = scene._repr_html_()
    assert "hg:0.9,0.1" in html and "50 um (the default)" in html


def test_results_say_of_what_they_are():
    pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    scene = Scene("TiO2", coats=coat("Au", depth=0.5, radius_um=0.03), host=1.5)
    for values in (scene.brdf(550, 0.5, 0.5), scene.albedo(550, 0.5), scene.solve(550)(0.5, 0.5)):
        particles = values.attrs["particles"].splitlines()
        assert particles[0].startswith("TiO2: effective radius 50 um (the default), ")
        assert particles[1].startswith("Au: effective radius 0.03 um, effective variance 0.2, power")
        assert values.attrs["host"] == "1.5" and "Au" in values.attrs["scene"]
        assert "TiO2" in values.attrs["sources"]


def test_data_arrays_named_like_the_arguments():
    xarray = pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)

    def axis(name, values):
        return xarray.DataArray(values, dims=name, coords={name: values}, name=name)

    mu_in, mu_out = axis("mu_in", [0.3, 0.5]), axis("mu_out", [0.2, 0.5, 0.9])
    azimuth = axis("azimuth_deg", [0.0, 90.0])
    scene = Scene("hg:0.9,0.4")
    values = scene.brdf([450, 650], mu_in, mu_out, azimuth)
    assert values.dims == ("wavelength_nm", "mu_in", "mu_out", "azimuth_deg")
    plain = scene.brdf([450, 650], mu_in.values[:, None, None], mu_out.values[:, None], azimuth.values)
    np.testing.assert_array_equal(values.values, plain.values)
    for name in ("mu_in", "mu_out", "azimuth_deg"):
        assert list(values[name].values) == list(locals()["azimuth" if name == "azimuth_deg" else name].values)
    # What comes out goes in again.
    again = scene.solve(450)(values.mu_in, values.mu_out, values.azimuth_deg)
    assert again.dims == values.dims[1:]
    # A ray for each time: the coordinate of the axis is kept, and the cosines lie along it.
    sun = xarray.DataArray([0.3, 0.5], dims="time", coords={"time": [9.0, 12.0]})
    at_times = scene.brdf(550, sun, mu_out)
    assert at_times.dims == ("time", "mu_out") and list(at_times.time.values) == [9.0, 12.0]
    assert at_times.mu_in.dims == ("time",)
    other = xarray.DataArray([0.3, 0.5], dims="time", coords={"time": [9.0, 13.0]})
    with pytest.raises(miebrdf.UsageError, match="coordinate time differs"):
        scene.brdf(550, sun, other)


def test_results_go_through_netcdf_and_back(tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("scipy")
    miebrdf.set_options(xarray=True)
    scene = Scene("hg:0.9,0.4", coats="TiO2,radius=0.2@0.3")
    for place, values in enumerate(
        (scene.brdf([450, 650], 0.5, [0.2, 0.9], 180.0), scene.albedo(550), scene.mueller(550, 0.5, 0.5))
    ):
        file = tmp_path / f"{place}.nc"
        values.to_netcdf(file, engine="scipy")
        with xarray.open_dataarray(file, engine="scipy") as back:
            xarray.testing.assert_equal(back.load(), values)
            assert back.attrs == values.attrs and back.name == values.name


def test_a_brdf_of_ones_own_is_exported_and_read_back(tmp_path):
    nm = [450.0, 650.0]

    def minnaert(mu_in, mu_out, azimuth_deg):  # Minnaert 1941
        return np.array([[0.2], [0.3]]) * (mu_in * mu_out) ** 0.2

    (written, *_) = miebrdf.export(minnaert, nm, tmp_path / "own.npz", title="Minnaert",
                                   mu_in=[0.2, 0.6, 1.0], mu_out=[0.2, 0.6, 1.0], azimuth_deg=[0, 180])  # fmt: skip
    file = miebrdf.BrdfFile(written["path"])
    assert file.wavelengths_nm == nm and file.format in repr(file)
    mu = np.array([0.2, 0.6, 1.0])
    expected = np.array([0.2, 0.3])[:, None, None] * (mu[:, None] * mu) ** 0.2
    np.testing.assert_allclose(file(mu[:, None], mu), expected, rtol=1e-6)
    with pytest.raises(miebrdf.UsageError, match=r"shape \(2, \d+\) is needed, not \(1, "):
        miebrdf.export(lambda i, o, a: np.zeros((1, i.size)), nm, tmp_path / "wrong.npz")
    with pytest.raises(ZeroDivisionError):
        miebrdf.export(lambda i, o, a: 1 / 0, nm, tmp_path / "wrong.npz")
    assert not (tmp_path / "wrong.npz").exists()


def test_exported_files_are_evaluated_as_their_programs_do(tmp_path):
    solved = Scene("TiO2,radius=0.2").solve([450, 550, 650])
    files = solved.export(tmp_path / "paint.bsdf", "rgl", accept_error=True)
    mu_out = np.linspace(0.3, 1.0, 8)
    for written in files:
        file = miebrdf.BrdfFile(written["path"])
        assert file(0.7, mu_out, 90.0).shape == (len(file.channels), 8)
        if file.wavelengths_nm:
            # What the export itself measures of plain directions is 5 % rms at most.
            np.testing.assert_allclose(file(0.7, mu_out, 90.0), solved(0.7, mu_out, 90.0), rtol=0.15)
    with pytest.raises(miebrdf.InputError):
        miebrdf.BrdfFile(tmp_path / "nothing.bsdf")
