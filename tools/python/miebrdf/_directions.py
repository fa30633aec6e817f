"""Values at directions: how they are asked for, and what they say of themselves."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Axes, Floats, Values, broadcast, labelled, numbers, varying_axes
from ._keywords import unknown
from ._version import __version__
from .errors import NotConverged, UsageError

#: More combinations than directions that were asked for: so many are computed all the same.
_SPARE_COMBINATIONS = 4096


@dataclass(frozen=True)
class Report:
    """How a result came about.

    Attributes
    ----------
    tolerance, error_estimate : float
        Relative to the largest value at the same incidence.
    converged : bool
        error_estimate <= tolerance, and every step says so.
    sources : list of str
        Where the figures come from, one line for each medium.
    notes : list of str
        What holds within limits only.
    shortfall : str
        What missed the tolerance and where; empty when converged.
    summary : str
        One sentence.
    polarisation : list of str
        How many components of light were computed, or what leaving polarisation out may change;
        empty where it does not matter.
    wavelengths : list of dict
        Of each wavelength: error_estimate, mie_error_estimate, phase_noise, optical_depths,
        stokes (components of light), polarisation_left_out, streams, moments, fourier_orders,
        iterations, method, converged.

    Examples
    --------
    >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
    >>> b = scene.solve(550)
    >>> report = b.report
    >>> report.converged, report.error_estimate, report.wavelengths[0]["streams"]
    """

    tolerance: float
    converged: bool
    error_estimate: float
    sources: list[str]
    notes: list[str]
    polarisation: list[str]
    shortfall: str
    summary: str
    wavelengths: list[dict[str, Any]]

    def attributes(self) -> dict[str, Any]:
        """For the attributes of a DataArray.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.report.attributes()["sources"]
        """
        return {
            "version": f"miebrdf {__version__}",
            "sources": list(self.sources),
            "error_estimate": self.error_estimate,
            "tolerance": self.tolerance,
            "converged": self.converged,
        }

    def warn(self) -> None:
        """Warn of what has not converged, at the line of the caller of this package.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.report.warn()  # nothing: it has converged
        """
        if not self.converged:
            warnings.warn(self.shortfall, NotConverged, stacklevel=_level_of_caller())


def _level_of_caller() -> int:
    """Of the first frame outside of the package, counted from the function that calls this."""
    level, frame = 0, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        level, frame = level + 1, frame.f_back
    return level


def _worst(reports: list[Report]) -> Report:
    """Of several calls for one result."""
    return min(reports, key=lambda report: (report.converged, -report.error_estimate))


def cosine(name: str, mu: ArrayLike | None, theta_deg: ArrayLike | None) -> ArrayLike:
    """A cosine, given as such or as an angle. Exact at 0 and 60 degrees."""
    if (mu is None) == (theta_deg is None):
        raise UsageError(f"mu_{name}: give either mu_{name} or theta_{name}_deg")
    if theta_deg is None:
        assert mu is not None
        return mu
    if hasattr(theta_deg, "copy") and hasattr(theta_deg, "dims"):
        labelled_angles: Any = theta_deg
        copied: ArrayLike = labelled_angles.copy(data=_cosine_of(name, labelled_angles.values))
        return copied
    return _cosine_of(name, theta_deg)


def _cosine_of(name: str, theta_deg: ArrayLike) -> Floats:
    angle = numbers(f"theta_{name}_deg", theta_deg)
    wrong = angle[~((angle >= 0.0) & (angle < 90.0))]
    if wrong.size > 0:
        raise UsageError(f"theta_{name}_deg: {float(wrong[0])!r} is out of range; allowed: [0, 90)")
    return np.where(angle == 60.0, 0.5, np.cos(np.deg2rad(angle)))


Directions = tuple[Any, Any, Any, Any, Any]


def axes_of(directions: Directions) -> Axes:
    """mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg, brought to one shape."""
    mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg = directions
    return broadcast(
        {
            "mu_in": cosine("in", mu_in, theta_in_deg),
            "mu_out": cosine("out", mu_out, theta_out_deg),
            "azimuth_deg": azimuth_deg,
        }
    )


def solver_options(method: Mapping[str, Any]) -> _core.SolverOptions:
    from ._media import choice

    kinds = {
        "grid": _core.Grid,
        "half_space_method": _core.HalfSpaceMethod,
        "coat_method": _core.CoatMethod,
    }
    options = _core.SolverOptions()
    for name, value in method.items():
        if name == "stokes":
            value = _stokes(value)
        if not hasattr(options, name):
            allowed = [known for known in dir(options) if not known.startswith("_")]
            raise UsageError(unknown("option", name, allowed))
        if name in kinds:
            value = choice(kinds[name], name, value)
        try:
            setattr(options, name, value)
        except TypeError:
            raise UsageError(f"{name}: {value!r} is no value for it") from None
    return options


def _stokes(value: Any) -> int:
    allowed = {"auto": 0, "1": 1, "3": 3, "4": 4}
    if isinstance(value, bool) or str(value) not in allowed:
        raise UsageError(f"stokes: {value!r} is out of range; allowed: 'auto', 1, 3, 4")
    return allowed[str(value)]


#: Values at all combinations of mu_in, mu_out and azimuth_deg, and facts for a Report: of shape
#: (wavelengths, mu_in, mu_out, azimuth_deg, ...).
Solve = Callable[[list[float], list[float], list[float]], tuple[Floats, dict[str, Any]]]


def evaluate_exactly(solve: Solve, axes: Axes) -> tuple[Floats, Report]:
    """Values of shape (wavelengths, *axes.shape, ...)."""
    dimensions = len(axes.shape)
    lists = list(axes.given.values())
    own = [varying_axes(array, dimensions) for array in lists]
    if sum(len(each) for each in own) == len(set().union(*own)):
        # Every axis belongs to one of the three: all combinations, as the solver has them.
        flat = [array.reshape(-1).tolist() for array in lists]
        values, facts = solve(flat[0], flat[1], flat[2])
        inner = values.shape[4:]
        shape = [axes.shape[axis] for each in own for axis in each]
        order = [axis for each in own for axis in each]
        values = values.reshape([values.shape[0], *shape, *inner])
        behind = 1 + len(order) + np.arange(len(inner))
        if order:
            values = values.transpose([0, *(1 + np.argsort(order)), *behind])
        return values.reshape([values.shape[0], *axes.shape, *inner]), Report(**facts)
    return _evaluate_scattered(solve, axes)


def _evaluate_scattered(solve: Solve, axes: Axes) -> tuple[Floats, Report]:
    """Directions that are no combinations of lists."""
    flat = [array.reshape(-1) for array in axes.arrays]
    unique, places = zip(*(np.unique(array, return_inverse=True) for array in flat))
    count = flat[0].size
    if unique[0].size * unique[1].size * unique[2].size <= max(4 * count, _SPARE_COMBINATIONS):
        values, facts = solve(unique[0].tolist(), unique[1].tolist(), unique[2].tolist())
        chosen = values[:, places[0], places[1], places[2]]
        return chosen.reshape([values.shape[0], *axes.shape, *values.shape[4:]]), Report(**facts)
    # One solution for each pair of cosines.
    pair = places[0] * unique[1].size + places[1]
    result: Floats = np.empty((0, count))
    reports = []
    for each in np.unique(pair):
        where = np.flatnonzero(pair == each)
        values, facts = solve(
            [float(flat[0][where[0]])], [float(flat[1][where[0]])], flat[2][where].tolist()
        )
        if result.shape[0] == 0:
            result = np.empty((values.shape[0], count, *values.shape[4:]))
        result[:, where] = values[:, 0, 0, :]
        reports.append(Report(**facts))
    return result.reshape([result.shape[0], *axes.shape, *result.shape[2:]]), _worst(reports)


BRDF_ATTRIBUTES = {"units": "1/sr", "long_name": "BRDF, without the cosine"}


def at_wavelengths(
    values: Floats,
    wavelengths: list[float],
    single: bool,
    axes: Axes,
    attributes: dict[str, Any],
    name: str = "brdf",
    stokes: int = 0,
) -> Values:
    """A result of values of shape (wavelengths, *axes.shape); `single`: without the first axis."""
    if single:
        return labelled(values[0], name, wavelengths[0], axes, attributes, stokes)
    return labelled(values, name, wavelengths, axes, attributes, stokes)


MUELLER_ATTRIBUTES = {
    "units": "1/sr",
    "long_name": "Mueller matrix of the BRDF, without the cosine",
    "planes": "Q = parallel minus perpendicular to the meridian plane of each ray (ray and normal)",
}
