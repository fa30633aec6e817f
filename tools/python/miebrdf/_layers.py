"""Albedos of many layers at once, without names and Mie theory."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, broadcast, numbers
from ._directions import cosine
from ._keywords import checked
from ._options import Call, Progress


class LayerAlbedos(NamedTuple):
    """Of each layer.

    Arrays of the layers' common shape, directional ones with the axes of `mu_in` behind it.

    Examples
    --------
    >>> found = layer_albedos([0.5, 0.9], 0.7, optical_depth=2, mu_in=0.5)
    >>> found.plane_albedo, found.error_estimate, found.converged
    """

    plane_albedo: Floats
    spherical_albedo: Floats
    plane_transmittance: Floats  #: net flux into the ground; 0 below infinite depth
    error_estimate: Floats  #: relative to the largest value at that incidence
    converged: NDArray[np.bool_]  #: whether that is within the tolerance


@checked()
def layer_albedos(
    single_scattering_albedo: ArrayLike,
    asymmetry: ArrayLike = 0.0,
    *,
    optical_depth: ArrayLike = np.inf,
    host_index: ArrayLike = 1.0,
    ground_albedo: ArrayLike = 0.0,
    mu_in: ArrayLike | None = None,
    theta_in_deg: ArrayLike | None = None,
    tolerance: float = 1e-3,
    threads: int | None = None,
    progress: Progress = None,
) -> LayerAlbedos:
    """Albedos of homogeneous layers of Henyey-Greenstein media on Lambertian grounds.

    Parameters
    ----------
    single_scattering_albedo : float or array
        In [0, 1]. This and the following four broadcast.
    asymmetry : float or array
        g in (-1, 1).
    optical_depth : float or array
        >= 0; infinite (default): half-spaces.
    host_index : float or array
        In [1, 3], of what lies between the particles, below a smooth boundary; 1: no boundary.
    ground_albedo : float or array
        In [0, 1].
    mu_in, theta_in_deg : float or array
        Incidences of every layer, as cosines in (0, 1] or in degrees.
    tolerance : float
        Relative to the largest value at an incidence.
    threads, progress
        As for `set_options`.

    Returns
    -------
    LayerAlbedos
        plane_albedo, spherical_albedo, plane_transmittance, error_estimate, converged.

    Raises
    ------
    UsageError
        For shapes that do not broadcast, and for a value out of range with its place among the
        layers (flat, in C order).

    Examples
    --------
    >>> albedo, g = np.linspace(0, 1, 100), np.array([0.0, 0.5, 0.8])
    >>> layer_albedos(albedo[None, :], g[:, None], mu_in=[0.5, 1.0]).plane_albedo.shape
    (3, 100, 2)
    """
    layers = {
        "single_scattering_albedo": single_scattering_albedo,
        "asymmetry": asymmetry,
        "optical_depth": optical_depth,
        "host_index": host_index,
        "ground_albedo": ground_albedo,
    }
    incidence = numbers("mu_in", cosine("in", mu_in, theta_in_deg))
    axes = broadcast({name: np.asarray(value) for name, value in layers.items()})

    def flat(given: Floats, array: Floats) -> Floats:
        return given.reshape(-1) if given.size == 1 else array.reshape(-1)

    options = _core.SolverOptions()
    options.tolerance = tolerance
    columns = {
        name: flat(given, array) for (name, given), array in zip(axes.given.items(), axes.arrays)
    }
    with Call(threads, progress, False) as call:
        found = _core.layer_albedos(
            **columns, mu_in=incidence.reshape(-1), solver=options, options=call
        )
    shapes = dict.fromkeys(("plane_albedo", "plane_transmittance"), axes.shape + incidence.shape)
    shaped = {name: found[name].reshape(shapes.get(name, axes.shape)) for name in found}
    shaped["converged"] = shaped["converged"].astype(bool)
    return LayerAlbedos(**{name: values[()] for name, values in shaped.items()})


def _subsurface(
    function: Any,
    name: str,
    values: ArrayLike,
    asymmetry: ArrayLike,
    host_index: ArrayLike,
    tolerance: float,
    threads: int | None,
    progress: Progress,
) -> Floats:
    media = {name: values, "asymmetry": asymmetry, "host_index": host_index}
    axes = broadcast({key: np.asarray(value) for key, value in media.items()})
    options = _core.SolverOptions()
    options.tolerance = tolerance
    columns = {key: array.reshape(-1) for key, array in zip(axes.given, axes.arrays)}
    with Call(threads, progress, False) as call:
        found = function(**columns, solver=options, options=call)
    shaped: Floats = found.reshape(axes.shape)[()]
    return shaped


@checked()
def subsurface_colour(
    single_scattering_albedo: ArrayLike,
    asymmetry: ArrayLike = 0.0,
    *,
    host_index: ArrayLike = 1.0,
    tolerance: float = 1e-3,
    threads: int | None = None,
    progress: Progress = None,
) -> Floats:
    """The colour of half-spaces of Henyey-Greenstein scatterers, as renderers name it.

    Of uniform light that enters, the share that comes out again: (A - r) / (1 - r), A the spherical
    albedo and r what a smooth boundary of `host_index` reflects (0 for 1).

    Parameters
    ----------
    single_scattering_albedo : float or array
        In [0, 1]. This and the following two broadcast.
    asymmetry : float or array
        g in (-1, 1).
    host_index : float or array
        In [1, 3]; 1: no boundary.
    tolerance : float
        Of the albedo.
    threads, progress
        As for `set_options`.

    Returns
    -------
    array
        In [0, 1].

    Raises
    ------
    UsageError
        As `layer_albedos`.

    Examples
    --------
    >>> subsurface_colour([0.5, 0.9, 0.99], 0.5, host_index=1.5)
    """
    return _subsurface(
        _core.subsurface_colour,
        "single_scattering_albedo",
        single_scattering_albedo,
        asymmetry,
        host_index,
        tolerance,
        threads,
        progress,
    )


@checked()
def subsurface_albedo(
    colour: ArrayLike,
    asymmetry: ArrayLike = 0.0,
    *,
    host_index: ArrayLike = 1.0,
    tolerance: float = 1e-3,
    threads: int | None = None,
    progress: Progress = None,
) -> Floats:
    """The single-scattering albedo that gives a colour: the inverse of `subsurface_colour`.

    Parameters
    ----------
    colour : float or array
        In [0, 1]. This and the following two broadcast.
    asymmetry : float or array
        g in (-1, 1).
    host_index : float or array
        In [1, 3]; 1: no boundary.
    tolerance : float
        Of the albedo; the colour is met to a hundredth of it.
    threads, progress
        As for `set_options`.

    Returns
    -------
    array
        In [0, 1].

    Raises
    ------
    UsageError
        As `layer_albedos`.

    Examples
    --------
    >>> subsurface_albedo([0.8, 0.5, 0.3], 0.0, host_index=1.5)
    """
    return _subsurface(
        _core.subsurface_albedo,
        "colour",
        colour,
        asymmetry,
        host_index,
        tolerance,
        threads,
        progress,
    )
