"""From spectral reflectance to colour: the CIE 1931 observer, XYZ, Lab and sRGB."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, numbers, wavelength_list
from .errors import UsageError

__all__ = ["encode_srgb", "lab", "linear_srgb", "srgb", "xyz"]


def _columns(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None, illuminant: str, first: int
) -> Floats:
    """Three columns of what the module computes, as the last axis."""
    from ._media import choice

    if wavelengths_nm is None:
        coordinates: Any = getattr(reflectance, "coords", {})
        if "wavelength_nm" not in coordinates:
            raise UsageError("wavelengths_nm: needed, as the reflectance does not carry them")
        wavelengths_nm = coordinates["wavelength_nm"].values
    nm, _ = wavelength_list(wavelengths_nm)
    values = numbers("reflectance", getattr(reflectance, "values", reflectance))
    if values.ndim == 0 or values.shape[0] != len(nm):
        raise UsageError(
            f"reflectance: shape {values.shape} does not have {len(nm)} wavelengths as its first axis"
        )
    if not _core.covers_the_visible(nm):
        raise UsageError(
            "wavelengths_nm: a colour needs at least eight wavelengths, ascending, from 430 nm or "
            "less to 650 nm or more"
        )
    rows = values.reshape(len(nm), -1).T
    table = _core.colours(nm, rows, choice(_core.Illuminant, "illuminant", illuminant))
    return table[:, first : first + 3].reshape([*values.shape[1:], 3])


def xyz(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Tristimulus values; a reflectance of 1 everywhere has Y = 1.

    Parameters
    ----------
    reflectance : array
        Albedo, or pi times a BRDF, with the wavelengths as its first axis.
    wavelengths_nm : array, optional
        Ascending; eight or more that cover the visible. Default: those that a DataArray carries.
    illuminant : str
        d65, a, e.

    Returns
    -------
    numpy.ndarray
        Of shape (*other axes, 3).
    """
    return _columns(reflectance, wavelengths_nm, illuminant, 0)


def lab(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """CIE 1976 L*, a*, b*; white is (100, 0, 0). Arguments as for `xyz`."""
    return _columns(reflectance, wavelengths_nm, illuminant, 3)


def linear_srgb(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Linear light in the primaries of sRGB, not clipped. Arguments as for `xyz`."""
    return _columns(reflectance, wavelengths_nm, illuminant, 6)


def encode_srgb(linear: ArrayLike) -> Floats:
    """The transfer curve of sRGB (IEC 61966-2-1), [0, 1] to [0, 1]; values are clipped first."""
    light = np.clip(numbers("linear", linear), 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def srgb(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Encoded sRGB in [0, 1], clipped, for display. Arguments as for `xyz`."""
    return encode_srgb(linear_srgb(reflectance, wavelengths_nm, illuminant=illuminant))
