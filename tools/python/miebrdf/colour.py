"""From spectral reflectance to colour: XYZ, Lab, LCh, sRGB, and the differences between colours.

The same numbers as `miebrdf albedo --colour`: illuminants D65, D50, A and E, the CIE 1931 and 1964
observers.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, numbers, wavelength_list
from .errors import UsageError

__all__ = [
    "acescg",
    "colour_error",
    "delta_e_76",
    "delta_e_2000",
    "encode_srgb",
    "lab",
    "lch",
    "linear_srgb",
    "srgb",
    "xyz",
]


_LARGEST_FACTOR = 2.0


def _require_visible(nm: list[float]) -> None:
    if not _core.covers_the_visible(nm):
        raise UsageError(
            "wavelengths_nm: a colour needs at least eight wavelengths, ascending, from 430 nm or "
            "less to 650 nm or more"
        )


def _columns(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None, illuminant: str, columns: slice
) -> Floats:
    """Some of what the module computes, as the last axis."""
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
    _require_visible(nm)
    rows = values.reshape(len(nm), -1).T
    # A glossy lobe is above 1 in some directions; percentages are so everywhere.
    if rows.size and float(rows.max(axis=1).min()) > _LARGEST_FACTOR:
        warnings.warn(
            f"reflectance: up to {float(rows.max()):g} in every row; percent? Shares of 1 are "
            "expected: divide by 100",
            stacklevel=3,
        )
    table = _core.colours(nm, rows, illuminant)[:, columns]
    return table.reshape([*values.shape[1:], table.shape[1]])


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
        "d65", "d50", "a" or "e", by the 2-degree observer or, after a comma, that of 10: "d65,10".

    Returns
    -------
    numpy.ndarray
        Of shape ``(*other axes, 3)``.

    Raises
    ------
    UsageError
        For another illuminant or observer, and wavelengths that are no colour.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> xyz(green, nm)
    """
    return _columns(reflectance, wavelengths_nm, illuminant, slice(0, 3))


def lab(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """CIE 1976 L*, a*, b*; white is (100, 0, 0). Arguments as for `xyz`.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> lab(green, nm, illuminant="d50,10")
    """
    return _columns(reflectance, wavelengths_nm, illuminant, slice(3, 6))


def lch(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Lab in polar form: L*, chroma, hue angle in degrees. Arguments as for `xyz`.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> lch(green, nm)
    """
    return _columns(reflectance, wavelengths_nm, illuminant, slice(9, 12))


def colour_error(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """What the wavelengths leave, at most: dE76 to the colour from every other one of them.

    Of shape ``(*other axes)``. Arguments as for `xyz`.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> colour_error(green, nm)
    """
    return _columns(reflectance, wavelengths_nm, illuminant, slice(12, 13))[..., 0]


def _difference(formula: Any, first: ArrayLike, second: ArrayLike) -> Floats:
    colours = []
    for name, value in (("first", first), ("second", second)):
        array = numbers(name, value)
        if array.ndim == 0 or array.shape[-1] != 3:
            raise UsageError(
                f"{name}: L*, a*, b* are needed as the last axis, not shape {array.shape}"
            )
        colours.append(array)
    try:
        one, other = np.broadcast_arrays(*colours)
    except ValueError as error:
        raise UsageError(f"first, second: the colours do not broadcast ({error})") from None
    return np.asarray(formula(*np.moveaxis(one, -1, 0), *np.moveaxis(other, -1, 0)))


def delta_e_76(first: ArrayLike, second: ArrayLike) -> Floats:
    """CIE 1976 difference of Lab colours: the distance in Lab.

    Parameters
    ----------
    first, second : array
        L*, a*, b* as the last axis (`lab`); the other axes broadcast.

    Returns
    -------
    numpy.ndarray or float

    Raises
    ------
    UsageError
        For arrays without a last axis of three.

    Examples
    --------
    >>> delta_e_76([50, 0, 0], [52, 1, 0])
    """
    return _difference(_core.delta_e_76, first, second)


def delta_e_2000(first: ArrayLike, second: ArrayLike) -> Floats:
    """CIEDE2000 (ISO/CIE 11664-6) with all weights 1. Arguments as for `delta_e_76`.

    Examples
    --------
    >>> delta_e_2000([50, 2.6772, -79.7751], [50, 0, -82.7485])  # Sharma et al. 2005: 2.0425
    """
    return _difference(_core.delta_e_2000, first, second)


def linear_srgb(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Linear light in the primaries of sRGB, not clipped. Arguments as for `xyz`.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> linear_srgb(green, nm)
    """
    return _columns(reflectance, wavelengths_nm, illuminant, slice(6, 9))


def acescg(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Linear ACEScg (primaries AP1) for renderers; white is (1, 1, 1). Arguments as for `xyz`.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> acescg(green, nm)
    """
    return _columns(reflectance, wavelengths_nm, illuminant, slice(13, 16))


def encode_srgb(linear: ArrayLike) -> Floats:
    """The transfer curve of sRGB (IEC 61966-2-1), [0, 1] to [0, 1]; values are clipped first.

    Parameters
    ----------
    linear : float or array
        In [0, 1].

    Returns
    -------
    numpy.ndarray
        Of the same shape.

    Examples
    --------
    >>> encode_srgb([0.0, 0.18, 1.0])
    """
    light = np.clip(numbers("linear", linear), 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def srgb(
    reflectance: ArrayLike, wavelengths_nm: ArrayLike | None = None, *, illuminant: str = "d65"
) -> Floats:
    """Encoded sRGB in [0, 1], clipped, for display. Arguments as for `xyz`.

    Examples
    --------
    >>> nm = np.arange(400, 701, 10)
    >>> green = np.exp(-(((nm - 540) / 40) ** 2))
    >>> srgb(green, nm)
    """
    return encode_srgb(linear_srgb(reflectance, wavelengths_nm, illuminant=illuminant))
