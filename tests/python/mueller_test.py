"""Mueller matrices: light with its polarisation."""

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene

GAS = Scene("rayleigh:0.9")


def test_mueller_matrices_are_those_of_the_program(program):
    csv = program("brdf", "--base", "rayleigh:0.9", "--stokes", 4, "--wavelengths", "550",
                  "--mu-in", "0.8", "--mu-out", "0.5,1", "--azimuth", "0,90")  # fmt: skip
    values = GAS.mueller(550, 0.8, np.array([[0.5], [1.0]]), np.array([0.0, 90.0]), stokes=4)
    assert values.shape == (2, 2, 4, 4)
    flat = values.reshape(4, 4, 4)
    for row in range(4):
        for column in range(4):
            np.testing.assert_array_equal(flat[:, row, column], csv[f"m{row + 1}{column + 1}"])


def test_three_components_unless_four_are_asked_for():
    assert GAS.mueller([450, 550], 0.5, 0.5).shape == (2, 3, 3)
    assert GAS.solve(550, stokes=4).mueller(0.5, [0.3, 0.6, 1.0]).shape == (3, 4, 4)
    assert GAS.solve(550, stokes=1).mueller(0.5, 0.5).shape == (3, 3)
    assert GAS.mueller(550, 0.5, []).shape == (0, 3, 3)


def test_element_11_is_the_brdf_where_auto_finds_that_polarisation_shows():
    mu_out, azimuth = np.linspace(0.2, 1, 5)[:, None], np.array([0.0, 60.0, 180.0])
    m11 = GAS.mueller(550, 0.6, mu_out, azimuth)[..., 0, 0]
    brdf = GAS.brdf(550, 0.6, mu_out, azimuth)
    # Both are one solution, but for elements that auto does not judge.
    np.testing.assert_allclose(brdf, m11, rtol=2e-3)
    scalar = GAS.brdf(550, 0.6, mu_out, azimuth, stokes=1)
    assert np.max(np.abs(scalar / m11 - 1)) > 0.01
    table = GAS.solve(550)
    np.testing.assert_allclose(table(0.6, mu_out, azimuth), m11, rtol=2e-3)
    assert table.report.polarisation == ["3 components of light at 1 of 1 wavelengths"]
    assert table.report.wavelengths[0]["stokes"] == 3


def test_scattered_directions_are_those_of_lists():
    mu = np.array([0.3, 0.5, 0.9])
    together = GAS.mueller(550, mu, mu[::-1], mu * 100)
    for k in range(3):
        alone = GAS.mueller(550, mu[k], mu[2 - k], mu[k] * 100)
        np.testing.assert_allclose(together[k], alone, atol=2e-3 * alone[0, 0])


def test_axes_have_names():
    xarray = pytest.importorskip("xarray")
    miebrdf.set_options(xarray=True)
    values = GAS.mueller([450, 550], 0.5, [0.3, 0.6], stokes=4)
    assert isinstance(values, xarray.DataArray)
    assert values.dims == ("wavelength_nm", "mu_out", "outgoing", "incident")
    assert values.name == "mueller" and values.attrs["units"] == "1/sr"
    assert list(values.coords["outgoing"].values) == ["I", "Q", "U", "V"]
    q_of_unpolarised = values.sel(outgoing="Q", incident="I")
    np.testing.assert_array_equal(q_of_unpolarised.values, values.values[..., 1, 0])
    assert GAS.mueller(550, 0.5, 0.3).dims == ("outgoing", "incident")


def test_what_cannot_be_is_refused():
    with pytest.raises(miebrdf.UsageError, match="'auto', 1, 3, 4"):
        GAS.mueller(550, 0.5, 0.5, stokes=2)
    with pytest.raises(miebrdf.UsageError, match="surface"):
        GAS.replace(roughness=0.3, surface_index=1.5).mueller(550, 0.5, 0.5)


def test_polarised_files_are_written(tmp_path):
    solved = GAS.solve([500, 600])
    files = solved.export(tmp_path / "gas.pbsdf", resolution=12)
    assert files[0]["bytes"] > 25 * 13 * 13 * 2 * 16 * 4
    assert files[0]["rms_deviation"]["mu > 0.2"] < 0.05
    GAS.solve(500, stokes=3).export(
        tmp_path / "gas.npz", mu_in=[0.5], mu_out=[0.3], azimuth_deg=[0]
    )
    with np.load(tmp_path / "gas.npz") as arrays:
        assert arrays["mueller"].shape == (1, 1, 1, 1, 3, 3)
        assert arrays["mueller"][0, 0, 0, 0, 0, 0] == pytest.approx(arrays["brdf"].item())
