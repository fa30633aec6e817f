"""Measurements as instruments write them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from . import _core


@dataclass(frozen=True)
class Measurements:
    """The values of a file of measurements: arrays of one length, NaN where there is no number.

    Attributes
    ----------
    quantity : array of str
        reflectance and transmittance (shares of the incident light), brdf (1/sr),
        reflectance_factor (white Lambertian = 1), lab_l, lab_a, lab_b.
    geometry : array of str
        directional, d8-sci, d8-sce, 45-0, hemispherical, hdrf, directions; empty where the file
        does not say it.
    wavelength_nm, mu_in, mu_out, azimuth_deg : array of float
        Azimuth 0 is the mirror side.
    value, sigma : array of float
        Sigma is the standard error, in the unit of the value.
    sample : array of str
        The sample or column that each value belongs to.
    samples : list of str
    file, format : str
    facts : dict
        What was understood.
    doubts : list of str
        What may be wrong, with its line.

    Examples
    --------
    >>> found = miebrdf.read_measured("panel.cxf")  # doctest: +SKIP
    >>> found.value[found.sample == found.samples[0]], found.doubts  # doctest: +SKIP
    """

    file: str
    format: str
    samples: list[str]
    facts: dict[str, str]
    doubts: list[str]
    quantity: NDArray[np.str_]
    geometry: NDArray[np.str_]
    wavelength_nm: NDArray[np.float64]
    mu_in: NDArray[np.float64]
    mu_out: NDArray[np.float64]
    azimuth_deg: NDArray[np.float64]
    value: NDArray[np.float64]
    sigma: NDArray[np.float64]
    sample: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.value)

    def __repr__(self) -> str:
        return f"<Measurements {self.file}: {len(self)} values of {len(self.samples)} samples>"


def read_measured(
    path: str | Path,
    *,
    format: str = "",
    column: str = "",
    quantity: str = "",
    percent: bool | None = None,
    wavelength_nm: float | None = None,
    mu_in: float | None = None,
    mu_out: float | None = None,
    azimuth_deg: float | None = None,
    sigma: float | None = None,
    relative_sigma: float | None = None,
    azimuth_zero: str = "",
    wavelengths: str | Path = "",
) -> Measurements:
    """Read a file of an instrument, a spectral library or a table; its format is recognised.

    Parameters
    ----------
    path : path
        A table (CSV), CxF3, CGATS, ASD, AvaSoft, JCAMP-DX, iad's .rxt, ECOSTRESS, USGS splib, a
        BRDF file.
    format, column : str
        A format by name, and one sample or column alone.
    quantity : str
        What the values are, in place of what the file says: plane_albedo, spherical_albedo,
        hemispherical, plane_transmittance, spherical_transmittance,
        unscattered_transmittance, brdf, reflectance_factor,
        hdrf, d8-sci, d8-sce, 45-0, reflectance, transmittance.
    percent : bool, optional
        Whether the values are percent; by default as the file says, else shares of 1.
    wavelength_nm, mu_in, mu_out, azimuth_deg : float, optional
        Of values that have none.
    sigma, relative_sigma : float, optional
        Standard errors of values that have none; both: the root of the sum of squares.
    azimuth_zero : {"", "mirror", "back"}
        What azimuth 0 means in a goniometer's file; by default as the file says or shows.
    wavelengths : path
        The wavelengths of a spectrum of the USGS library; by default looked for near it.

    Raises
    ------
    UsageError
        For options that are out of range.
    InputError
        With file and line, for files that are damaged, values in percent where shares are meant,
        wavelengths that are there twice, directions whose convention is not known.

    Examples
    --------
    >>> paint = miebrdf.read_measured("paint.cxf", column="blue 12")
    >>> paint.wavelength_nm, paint.value
    """
    given = {
        "wavelength_nm": wavelength_nm,
        "mu_in": mu_in,
        "mu_out": mu_out,
        "azimuth_deg": azimuth_deg,
        "sigma": sigma,
        "relative_sigma": relative_sigma,
    }
    facts = _core.read_measured(
        str(path),
        format,
        column,
        quantity,
        percent,
        {name: number for name, number in given.items() if number is not None},
        azimuth_zero,
        str(wavelengths),
    )
    facts["facts"] = dict(facts["facts"])
    for words in ("quantity", "geometry", "sample"):
        facts[words] = np.asarray(facts[words], dtype=np.str_)
    return Measurements(**facts)
