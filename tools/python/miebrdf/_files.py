"""Files of other programs: what formats there are, files of a BRDF of one's own, what a file says,
and its physics."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, Values, labelled, numbers, wavelength_list
from ._directions import axes_of
from ._keywords import ExportOptions, checked
from ._options import Call, Progress
from .errors import UsageError


class FormatFacts(TypedDict):
    """A format of `Brdf.export` and `export`."""

    name: str
    readers: str  #: programs that read it
    holds: str
    endings: list[str]
    options: list[str]  #: arguments of `Brdf.export` that it takes


class ExportedFile(TypedDict):
    """A file that was written."""

    path: Path
    bytes: int
    rms_deviation: dict[str, float]  #: from the BRDF, by kind of directions; empty: exact


@dataclass(frozen=True)
class FileCheck:
    """Physics of a BRDF file, as the program that reads it will see it.

    Attributes
    ----------
    reciprocity_rms : float or None
        Of ``|f(i, o) - f(o, i)|`` over the mean of both; None where no pair is listed both ways.
    largest_albedo : float or None
        Over all channels and incidences.
    largest_albedo_error, largest_albedo_mu : float
    largest_albedo_channel : str
    least_value : float
        Of the BRDF, 1/sr.
    missing, directions : int
        Directions without a value, and those that were looked at.
    sampled_albedo_error : float or None
        Of albedos by the file's own importance sampling.

    Examples
    --------
    >>> Scene("hg:0.9,0.4").solve(550).export("grey.npz")
    >>> check("grey.npz").largest_albedo
    """

    reciprocity_rms: float | None
    largest_albedo: float | None
    largest_albedo_error: float
    largest_albedo_mu: float
    largest_albedo_channel: str
    least_value: float
    missing: int
    directions: int
    sampled_albedo_error: float | None


def check(path: str | Path) -> FileCheck:
    """Reciprocity, albedo and least value of a BRDF file in any format that is known.

    Raises
    ------
    InputError
        For an unknown, damaged or truncated file.

    Parameters
    ----------
    path : str or Path
        What it is, is recognised by its content.

    Returns
    -------
    FileCheck

    Examples
    --------
    >>> Scene("hg:0.9,0.4").solve(550).export("grey.npz")
    >>> check("grey.npz").least_value
    """
    return FileCheck(**_core.check(str(path)))


def formats() -> list[FormatFacts]:
    """Formats of `Brdf.export`.

    Returns
    -------
    list of dict
        name, readers (programs), holds, endings, options (arguments that it takes).

    Examples
    --------
    >>> [each["name"] for each in formats() if "Mitsuba" in each["readers"]]
    """
    return [
        {
            "name": each["name"],
            "readers": each["readers"],
            "holds": each["holds"],
            "endings": each["endings"],
            "options": each["options"],
        }
        for each in _core.formats()
        if each["brdf"]
    ]


def export_arguments(
    how: ExportOptions,
) -> tuple[int, _core.Directions, str, float, bool, dict[str, int]]:
    """Those of the module: resolution, directions, rgb, largest and accepted error, and what single
    formats take."""
    given: dict[str, Any] = {**how}
    listed = (
        numbers(name, given.get(name, ())).reshape(-1).tolist()
        for name in ("mu_in", "mu_out", "azimuth_deg")
    )
    of_single_formats = ("incident_angles", "bin_centres", "acescg", "subsurface")
    return (
        how.get("resolution", 0),
        _core.Directions(*listed),
        how.get("rgb", "auto"),
        how.get("largest_error", 0.0),
        how.get("accept_error", False),
        {name: int(value) for name, value in given.items() if name in of_single_formats},
    )


@checked(ExportOptions)
def export(
    function: Callable[[Floats, Floats, Floats], ArrayLike],
    wavelengths_nm: ArrayLike,
    path: str | Path,
    format: str | None = None,
    *,
    title: str = "",
    threads: int | None = None,
    progress: Progress = None,
    **how: Unpack[ExportOptions],
) -> list[ExportedFile]:
    """Write files for renderers and tools of a BRDF of one's own, whole or not at all.

    Parameters
    ----------
    function : callable
        ``function(mu_in, mu_out, azimuth_deg)``: the BRDF in 1/sr, without the cosine, at cosines
        in (0, 1] and azimuths in degrees (0 = mirror side), three arrays of n numbers. It returns
        an array of shape ``(wavelengths, n)``, or of n numbers for one wavelength. It is called for
        many directions at a time. A `BrdfFile` is such a function.
    wavelengths_nm : float or array of one dimension
        In vacuum.
    path, format, **how
        As of `Brdf.export`.
    title : str
        What the file says it is.
    threads, progress
        As in `set_options`.

    Returns
    -------
    list of dict
        path, bytes, rms_deviation by kind of directions.

    Raises
    ------
    UsageError
        For an unknown format, options out of range, and values of another shape.
    InputError
        When a file cannot be written.
    TooCoarse
        When a file would be further from the function than accepted.

    Examples
    --------
    >>> def lambertian(mu_in, mu_out, azimuth_deg):
    ...     return np.full((3, mu_in.size), 0.8 / np.pi)
    >>> miebrdf.export(lambertian, [450, 550, 650], "white.npz")
    """
    chosen = format_of(Path(path)) if format is None else format
    nm, _ = wavelength_list(wavelengths_nm)

    def values(mu_in: Floats, mu_out: Floats, azimuth_deg: Floats) -> Floats:
        given = numbers("function", np.asarray(function(mu_in, mu_out, azimuth_deg)))
        if given.ndim == 1 and len(nm) == 1:
            given = given[None]
        if given.shape != (len(nm), mu_in.size):
            raise UsageError(
                f"function: an array of shape ({len(nm)}, {mu_in.size}) is needed, "
                f"not {given.shape}"
            )
        return np.ascontiguousarray(given.T)

    with Call(threads, progress, None) as options:
        command = " ".join(["Python:", *sys.argv])
        arguments = export_arguments(how)
        return _core.export_function(values, nm, title, command, path, chosen, *arguments, options)


class BrdfFile:
    """A BRDF file in any format that is known, evaluated as the program that reads it does.

    Parameters
    ----------
    path : str or Path
        What it is, is recognised by its content.

    Attributes
    ----------
    format, description : str
    channels : list of str
        ``"550 nm"``, or ``"R"``, ``"G"``, ``"B"``.
    wavelengths_nm : list of float
        Of each channel; empty where these are colours.

    Raises
    ------
    InputError
        For an unknown, damaged or truncated file.

    Examples
    --------
    >>> Scene("hg:0.9,0.4").solve([450, 650]).export("grey.npz")
    >>> file = miebrdf.BrdfFile("grey.npz")
    >>> file(0.5, [0.3, 0.9], azimuth_deg=180.0)
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._file = _core.BrdfFile(str(path))
        self.format = self._file.format
        self.description = self._file.description
        self.channels = self._file.channels
        self.wavelengths_nm = self._file.wavelengths_nm

    def __call__(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
    ) -> Values:
        """The BRDF in 1/sr, without the cosine; not a number where the file has none.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg
            As of `Brdf`.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(channels, *broadcast directions)``.
        """
        axes = axes_of((mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg))
        flat = [np.ascontiguousarray(array).reshape(-1) for array in axes.arrays]
        values = self._file.evaluate(*flat).T.reshape([len(self.channels), *axes.shape])
        attributes = {"units": "1/sr", "long_name": "BRDF, without the cosine",
                      "file": str(self.path), "format": self.format}  # fmt: skip
        nm = self.wavelengths_nm or None
        channels = None if nm else self.channels
        return labelled(values, "brdf", nm, axes, attributes, channels=channels)

    def __repr__(self) -> str:
        return f"<miebrdf.BrdfFile {self.path}: {self.format}, {self.description}>"


def needs_whole_matrix(format: str) -> bool:
    """Whether a format of `Brdf.export` holds Mueller matrices."""
    return any(each["name"] == format and each["whole_matrix"] for each in _core.formats())


def format_of(path: Path) -> str:
    """The format of `Brdf.export` that the ending of a file says."""
    known = [each for each in _core.formats() if each["brdf"]]
    fitting = [each["name"] for each in known if path.suffix in each["endings"]]
    if path.suffix == ".bsdf":
        return "rgl"
    if len(fitting) != 1:
        names = ", ".join(fitting or [each["name"] for each in known])
        raise UsageError(f"format: '{path.name}' does not say which; allowed: {names}")
    return str(fitting[0])
