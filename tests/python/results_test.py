"""What comes back: names and units, memory, the solved object."""

import warnings

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene, coat

MU = np.linspace(0.05, 1, 20)
PHI = np.linspace(0, 180, 13)
PAINT = Scene("TiO2,radius=0.2", coats=[coat("Au", depth=0.5, radius_um=0.03)])


@pytest.fixture(scope="module")
def solved():
    return PAINT.solve([450, 550, 650], progress=False)


def address(array):
    return array.__array_interface__["data"][0]


def test_data_arrays_carry_names_units_and_facts():
    xarray = pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    values = PAINT.brdf([450, 550], 0.5, MU[:, None], PHI[None, :])
    assert isinstance(values, xarray.DataArray)
    assert values.dims == ("wavelength_nm", "mu_out", "azimuth_deg")
    assert values.name == "brdf" and values.attrs["units"] == "1/sr"
    assert values.attrs["version"] == f"miebrdf {miebrdf.__version__}"
    assert "TiO2" in values.attrs["sources"]
    assert values.attrs["error_estimate"] > 0
    assert values.attrs["converged"] == (
        values.attrs["error_estimate"] <= values.attrs["tolerance"]
    )
    assert values.mu_in == 0.5 and values.azimuth_deg.attrs["units"] == "degree"
    at = values.sel(wavelength_nm=550, azimuth_deg=180).sel(mu_out=0.5, method="nearest")
    assert float(at) > 0


def test_axes_of_several_arguments_keep_them_as_coordinates():
    pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    values = PAINT.solve(550)(MU, MU[::-1], 0.0)
    assert values.dims == ("dim_0",)
    np.testing.assert_array_equal(values.mu_out, MU[::-1])


def test_data_arrays_broadcast_by_name():
    xarray = pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    mu_out = xarray.DataArray(MU, dims="view")
    phi = xarray.DataArray(PHI, dims="around")
    values = PAINT.solve([450, 550])(0.5, mu_out, phi)
    assert values.dims == ("wavelength_nm", "view", "around")
    miebrdf.set_options(xarray=False)
    np.testing.assert_array_equal(values, PAINT.solve([450, 550])(0.5, MU[:, None], PHI))


def test_the_same_shape_without_xarray(solved):
    plain = solved(0.5, MU[:, None], PHI)
    assert type(plain) is np.ndarray
    pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    labelled = solved(0.5, MU[:, None], PHI)
    assert labelled.shape == plain.shape
    np.testing.assert_array_equal(labelled.values, plain)


def test_large_results_are_not_copied(solved, monkeypatch):
    pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    out = np.empty((3, MU.size, PHI.size))
    values = solved(0.5, MU[:, None], PHI, out=out)
    assert address(values.values) == address(out)
    # What the solver returns is on the library's own memory, and so is the DataArray.
    from miebrdf import _core

    real, seen = _core.SolvedScene.evaluate, []

    def watched(self, *arguments):
        result = real(self, *arguments)
        seen.append(address(result[0]))
        return result

    monkeypatch.setattr(_core.SolvedScene, "evaluate", watched)
    exact = PAINT.brdf(550, 0.5, MU[:, None], PHI)
    assert [address(exact.values)] == seen
    assert not exact.values.flags.owndata


def test_arguments_are_not_copied_either(solved):
    """A million directions broadcast from two short lists take the memory of the result alone."""
    tracemalloc = pytest.importorskip("tracemalloc")
    mu, phi = np.linspace(0.01, 1, 1000), np.linspace(0, 180, 500)
    out = np.empty((3, 1000, 500))
    tracemalloc.start()
    solved(0.5, mu[:, None], phi, out=out)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e6  # the arguments broadcast would be 12e6


def test_out_must_fit(solved):
    for wrong in (np.empty(5), np.empty((3, 20), np.float32), np.empty((20, 3)).T):
        with pytest.raises(miebrdf.UsageError, match="out"):
            solved(0.5, MU, out=wrong)


def test_the_table_is_within_the_stated_error(solved):
    assert solved.report.converged
    exact = solved.exact(MU[:, None, None], MU[:, None], PHI)
    table = solved(MU[:, None, None], MU[:, None], PHI)
    largest = exact.max(axis=(2, 3), keepdims=True)
    # Both are within the tolerance of the truth.
    assert np.max(np.abs(table - exact) / largest) <= 2 * solved.report.tolerance


def test_cosines_of_unit_vectors_in_single_precision_count_as_one(solved):
    beyond = float(np.float32(1.0000001))
    assert beyond > 1
    np.testing.assert_array_equal(solved(beyond, [0.5, beyond]), solved(1.0, [0.5, 1.0]))
    for wrong in (1.00001, 0.0, np.nan):
        with pytest.raises(miebrdf.UsageError, match=r"mu_out: .* is out of range; allowed: \(0, 1\]"):
            solved(0.5, wrong)


def test_values_do_not_depend_on_their_company(solved):
    together = solved(MU[:, None], MU, 30.0)
    alone = [[solved(a, b, 30.0) for b in MU[:3]] for a in MU[:3]]
    np.testing.assert_array_equal(together[:, :3, :3], np.moveaxis(alone, -1, 0))


def test_albedo_is_the_integral_of_the_brdf(solved):
    # Gauss-Legendre in mu, trapezia in azimuth: exact to the table's own error.
    x, w = np.polynomial.legendre.leggauss(24)
    mu, weight = (x + 1) / 2, w / 2
    phi = np.linspace(0, 360, 64, endpoint=False)
    values = solved(0.6, mu[:, None], phi)
    integral = 2 * np.pi * np.einsum("wma,m->w", values, weight * mu) / phi.size
    np.testing.assert_allclose(integral, solved.albedo(0.6), rtol=2e-3)


def test_not_converged_is_a_warning_at_the_line_of_the_caller():
    scene = Scene("hg:0.99,0.9")
    solved = scene.solve(550, streams=2)
    for ask in (lambda: scene.brdf(550, 0.1, MU, streams=2), lambda: solved.exact(0.1, MU)):
        with pytest.warns(miebrdf.NotConverged, match="nm") as warned:
            ask()
        assert [each.filename for each in warned] == [__file__]


def test_export_and_check(solved, tmp_path):
    files = solved.export(tmp_path / "paint.bsdf", "pbrt", accept_error=True)
    assert [file["bytes"] for file in files] == [file["path"].stat().st_size for file in files]
    check = miebrdf.check(files[0]["path"])
    assert check.largest_albedo is not None and 0 < check.largest_albedo < 1
    with pytest.raises(miebrdf.UsageError, match="rgl"):
        solved.export(tmp_path / "x", "rlg")
    with pytest.raises(miebrdf.InputError, match="nowhere"):
        solved.export(tmp_path / "nowhere" / "x.csv", "csv")
    solved.export(tmp_path / "x.csv", mu_in=[0.5], mu_out=[0.5, 1], azimuth_deg=[0])
    lines = (tmp_path / "x.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines if not line.startswith("#")]
    assert len(rows) == 1 + 3 * 2 and "mu_out" in rows[0]


def test_pictures(solved):
    html = solved._repr_html_()
    assert html.count("<polyline") == 3 and "450 to 650 nm" in html
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    ax = solved.plot_lobe(theta_in_deg=30)
    assert len(ax.lines) == 3
    assert len(miebrdf.materials["TiO2"].plot().lines) == 2


def test_charts_without_matplotlib_say_what_is_missing(solved, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib", None)
    with pytest.raises(miebrdf.MissingPackage, match="python3-matplotlib"):
        solved.plot_lobe()


def test_ensembles_and_phase_functions():
    angles = np.linspace(0, 180, 181)
    phase = miebrdf.phase("TiO2", [450, 550], angles, radius_um=0.2, host_index=1.5)
    assert phase.shape == (2, 181)
    mu = np.cos(np.deg2rad(angles))
    mean = -np.sum((phase[:, 1:] + phase[:, :-1]) / 2 * np.diff(mu), axis=1) / 2
    np.testing.assert_allclose(mean, 1, atol=2e-3)  # trapezia of one degree
    optics = miebrdf.ensemble("TiO2", 550, radius_um=0.2, host_index=1.5, highest_moment=3)
    assert optics.chi.shape == (4,) and optics.chi[0] == 1 and optics.converged
    np.testing.assert_allclose(optics.chi[1], optics.asymmetry, rtol=1e-4)  # the tolerance
    one = miebrdf.ensemble(1.5 + 0.01j, 550, radius_um=0.5, distribution="mono")
    single = miebrdf.sphere(1.5 + 0.01j, 2 * np.pi * 0.5 / 0.55)
    np.testing.assert_allclose(one.q_ext, single.q_ext, rtol=1e-12)


def test_colours():
    nm = np.arange(400, 701, 10)
    white = np.ones(nm.size)
    np.testing.assert_allclose(miebrdf.colour.lab(white, nm), [100, 0, 0], atol=1e-6)
    np.testing.assert_allclose(miebrdf.colour.srgb(np.stack([white] * 5, 1), nm), 1, atol=1e-6)
    with pytest.raises(miebrdf.UsageError, match="eight"):
        miebrdf.colour.xyz([1, 1], [450, 550])


def test_white_is_white_under_every_light():
    nm = np.arange(400, 701, 10)
    white = np.ones(nm.size)
    for light in ("d65", "d50", "a", "e", "d65,10", "d50,10", "a,10", "e,10"):
        np.testing.assert_allclose(
            miebrdf.colour.lab(white, nm, illuminant=light), [100, 0, 0], atol=1e-6, err_msg=light
        )
    reddish = np.linspace(0.2, 0.8, nm.size)
    lab, lch = miebrdf.colour.lab(reddish, nm), miebrdf.colour.lch(reddish, nm)
    np.testing.assert_allclose(lch[1], np.hypot(lab[1], lab[2]))
    np.testing.assert_allclose(lch[2], np.rad2deg(np.arctan2(lab[2], lab[1])))
    # A straight spectrum is the same from every other wavelength.
    assert miebrdf.colour.colour_error(reddish, nm) < 1e-9
    with pytest.raises(miebrdf.UsageError, match="'f2'; allowed: d65, d50"):
        miebrdf.colour.lab(white, nm, illuminant="f2")


def test_colour_differences():
    # The first and the last pair of Sharma, Wu & Dalal, Color Res. Appl. 30, 21 (2005), table 1.
    first = [[50, 2.6772, -79.7751], [2.0776, 0.0795, -1.1350]]
    second = [[50, 0, -82.7485], [0.9033, -0.0636, -0.5514]]
    np.testing.assert_allclose(
        miebrdf.colour.delta_e_2000(first, second), [2.0425, 0.9082], atol=5e-5
    )
    np.testing.assert_allclose(
        miebrdf.colour.delta_e_76([50, 0, 0], [[50, 3, 4], [51, 0, 0]]), [5, 1]
    )
    assert miebrdf.colour.delta_e_2000(np.zeros((4, 1, 3)), np.zeros((5, 3))).shape == (4, 5)
    with pytest.raises(miebrdf.UsageError, match="last axis"):
        miebrdf.colour.delta_e_2000([1, 2], [1, 2, 3])
    with pytest.raises(miebrdf.UsageError, match="broadcast"):
        miebrdf.colour.delta_e_76(np.ones((2, 3)), np.ones((5, 3)))


def test_values_do_not_depend_on_their_neighbours():
    b = miebrdf.Scene("hg:0.9,0.5").solve([500, 600])
    draw = np.random.default_rng(3)
    n = 5000  # more than are ordered together
    mu_in, mu_out = draw.uniform(0.02, 1, n), draw.uniform(0.02, 1, n)
    azimuth = draw.uniform(0, 360, n)
    together = np.asarray(b(mu_in, mu_out, azimuth))
    for i in (*range(0, n, 97), n - 1):
        one = np.asarray(b(mu_in[i], mu_out[i], azimuth[i]))
        np.testing.assert_array_equal(together[:, i], one)


def test_materials(tmp_path):
    own = miebrdf.Materials(tmp_path / "own.sqlite")
    nm, n, k = [400, 500, 600, 700], [1.6, 1.58, 1.57, 1.56], [0.1, 0.05, 0.02, 0.01]
    assert own.add("ink", nm, n, k, reference="measured here") == "added"
    assert own.add("ink", nm, n, k) == "unchanged"
    assert own["ink"].nk(500) == 1.58 + 0.05j
    assert own["ink"].reference == "measured here"
    assert "ink" in own and "ink" not in miebrdf.materials and "ink" in list(own)
    with pytest.raises(miebrdf.MaterialFileError):
        own.add("ink", nm, k, n)
    for wrong in ([n, n[:2]], [[-1, 1, 1, 1], k], [[np.nan] * 4, k]):
        with pytest.raises((miebrdf.InputError, miebrdf.UsageError)):
            own.add("bad", nm, *wrong)
    assert "bad" not in own
    scene = Scene("ink,radius=0.3", database=str(own.database))
    assert scene.brdf(550, 0.5, 0.5) > 0
    assert own.remove("ink") and "ink" not in own
    assert any(each["name"] == "TiO2" for each in own.search("titanium", covers_nm=(400, 700)))
    # The table is given by arrays here.
    ink = miebrdf.medium(index=np.array(n) + 1j * np.array(k), wavelengths_nm=nm, radius_um=0.3)
    np.testing.assert_array_equal(Scene(ink).brdf(550, 0.5, MU), scene_without(own, nm, n, k))


def scene_without(own, nm, n, k):
    own.add("ink", nm, n, k)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return Scene("ink,radius=0.3", database=str(own.database)).brdf(550, 0.5, MU)
