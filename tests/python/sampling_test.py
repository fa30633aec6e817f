"""Directions drawn by Brdf.sample follow the density that Brdf.pdf says."""

import numpy as np
import pytest

from miebrdf import Scene

SCENES = {
    "white": Scene("isotropic:1"),
    "forward": Scene("hg:0.95,0.8"),
    "rough": Scene("hg:0.9,0.4", roughness=0.15, surface_index=1.5),
}


@pytest.fixture(scope="module", params=SCENES)
def solved(request):
    return SCENES[request.param].solve(550, progress=False)


@pytest.mark.parametrize("mu_in", [0.05, 0.37, 1.0])
def test_the_density_integrates_to_one(solved, mu_in):
    # The density is constant in cells of (mu^2, azimuth), times mu: midpoints are exact.
    s = (np.arange(480) + 0.5) / 480
    phi = (np.arange(960) + 0.5) / 960 * 360
    density = solved.pdf(mu_in, np.sqrt(s)[:, None], phi)
    integral = np.mean(density / (2 * np.sqrt(s)[:, None])) * 2 * np.pi
    assert abs(integral - 1) <= 1e-12
    assert density.min() > 0


@pytest.mark.parametrize("mu_in", [0.2, 0.9])
def test_directions_are_distributed_as_the_density_says(solved, mu_in):
    draw = np.random.default_rng(7)
    count = 200_000
    mu, phi, density = solved.sample(mu_in, *draw.random((2, count)))
    np.testing.assert_allclose(density, solved.pdf(mu_in, mu, phi), rtol=1e-12)
    assert np.all((mu > 0) & (mu <= 1) & (phi >= 0) & (phi < 360))
    bins = 8
    seen = np.histogram2d(mu**2, phi, bins=bins, range=[[0, 1], [0, 360]])[0]
    s = (np.arange(bins * 60) + 0.5) / (bins * 60)
    angle = (np.arange(bins * 60) + 0.5) / (bins * 60) * 360
    cells = solved.pdf(mu_in, np.sqrt(s)[:, None], angle) / (2 * np.sqrt(s)[:, None])
    expected = cells.reshape(bins, 60, bins, 60).mean(axis=(1, 3)) * 2 * np.pi / bins**2 * count
    chi_squared = np.sum((seen - expected) ** 2 / expected)
    # 63 degrees of freedom: mean 63, deviation 11.2; six deviations are never seen by chance.
    assert chi_squared <= 63 + 6 * 11.3


@pytest.mark.parametrize("mu_in", [0.2, 0.9])
def test_estimates_of_the_albedo_are_unbiased_and_better_than_the_cosine(solved, mu_in):
    draw = np.random.default_rng(3)
    u = draw.random((2, 20_000))
    mu, phi, density = solved.sample(mu_in, *u)
    estimates = solved(mu_in, mu, phi) * mu / density
    error = estimates.std() / np.sqrt(estimates.size)
    # The table's own error, 1e-3, comes on top of six standard deviations.
    assert abs(estimates.mean() - solved.albedo(mu_in)) <= 6 * error + 2e-3
    by_cosine = solved(mu_in, np.sqrt(1 - u[0]), 360 * u[1]) * np.pi
    assert estimates.std() <= 1.02 * by_cosine.std() + 1e-3
