"""Albedos of many layers in one call."""

import numpy as np
import pytest

import miebrdf


def test_layers_are_those_of_scenes():
    albedo, g = np.array([0.5, 0.9, 1.0]), np.array([[0.0], [0.6]])
    found = miebrdf.layer_albedos(albedo, g, mu_in=[0.3, 1.0])
    assert found.plane_albedo.shape == (2, 3, 2)
    assert found.spherical_albedo.shape == found.converged.shape == (2, 3)
    assert found.converged.all()
    for i, j in np.ndindex(2, 3):
        scene = miebrdf.Scene(f"hg:{albedo[j]},{g[i, 0]}")
        exact = np.asarray(scene.albedo(550, mu_in=[0.3, 1.0], tolerance=1e-3)).reshape(-1)
        assert found.plane_albedo[i, j] == pytest.approx(exact, abs=2e-3)  # both within 1e-3


def test_films_keep_energy():
    found = miebrdf.layer_albedos(
        1.0,
        0.5,
        optical_depth=[0.1, 1.0, 10.0],
        host_index=1.5,
        ground_albedo=0.2,
        mu_in=0.5,
        tolerance=1e-6,
    )
    # What is not reflected arrives in the ground: the layers absorb nothing.
    assert found.plane_albedo + found.plane_transmittance == pytest.approx(np.ones(3), abs=2e-6)


def test_numbers_give_numbers_and_degrees_are_cosines():
    one = miebrdf.layer_albedos(0.9, theta_in_deg=60)
    assert np.ndim(one.plane_albedo) == 0
    beside = miebrdf.layer_albedos(0.9, mu_in=np.cos(np.pi / 3)).plane_albedo
    assert abs(one.plane_albedo - beside) <= 4e-16  # cosines differ in the last digit


def test_strange_arrays():
    albedo = np.linspace(0, 1, 12, dtype=np.float32).reshape(3, 4)
    plain = miebrdf.layer_albedos(albedo.astype(float), mu_in=0.5).plane_albedo
    for strange in (albedo, np.asfortranarray(albedo), albedo.T.copy().T, albedo.tolist()):
        assert np.array_equal(miebrdf.layer_albedos(strange, mu_in=0.5).plane_albedo, plain)
    assert miebrdf.layer_albedos([], mu_in=0.5).plane_albedo.shape == (0,)


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({"single_scattering_albedo": [0.5, 1.5]}, "single_scattering_albedo[1]: 1.5"),
        ({"single_scattering_albedo": np.nan}, "single_scattering_albedo"),
        ({"single_scattering_albedo": 0.5, "asymmetry": 1.0}, "(-1, 1)"),
        ({"single_scattering_albedo": 0.5, "host_index": 0.9}, "[1, 3]"),
        ({"single_scattering_albedo": 0.5, "mu_in": 0.0}, "mu_in"),
        ({"single_scattering_albedo": [0.5, 0.6], "asymmetry": [0, 0, 0]}, "do not broadcast"),
    ],
)
def test_errors_name_the_value(arguments, words):
    with pytest.raises(miebrdf.UsageError) as error:
        miebrdf.layer_albedos(**{"mu_in": 0.5, **arguments})
    assert words in str(error.value)


def test_a_subsurface_albedo_gives_its_colour_in_the_shape_of_the_arguments():
    g = np.array([[0.0], [0.9]])
    colour = [0.1, 0.5, 0.95]
    albedo = miebrdf.subsurface_albedo(colour, g, host_index=1.5)
    assert albedo.shape == (2, 3)
    # A hundredth of the tolerance of 1e-3.
    assert np.max(np.abs(miebrdf.subsurface_colour(albedo, g, host_index=1.5) - colour)) <= 1e-5
    with pytest.raises(miebrdf.UsageError, match=r"colour\[0\]"):
        miebrdf.subsurface_albedo(1.2)
