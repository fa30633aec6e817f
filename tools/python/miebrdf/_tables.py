"""Tables that `miebrdf sweep` wrote: values between their nodes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from . import _core
from ._options import use_xarray
from .errors import UsageError


class LookedUp(NamedTuple):
    """A variable of a table, interpolated.

    Examples
    --------
    >>> found = miebrdf.lookup("snow.nc", radius=220, soot=3e-8, mu_in=0.5, wavelength=510)  # doctest: +SKIP
    >>> found.value, found.interpolation_error, found.unit  # doctest: +SKIP
    """

    value: Any  #: a number, or an array over the axes that nothing was asked of
    #: Absolute, from nodes that the interpolation leaves out; NaN where an axis has none to leave
    #: out. The error of the nodes themselves is the table's variable error_estimate.
    interpolation_error: Any
    unit: str


def lookup(
    table: str | os.PathLike[str],
    *,
    variables: str | Sequence[str] | None = None,
    interpolation: str = "linear",
    **values: float | str,
) -> Any:
    """Values of a sweep's table between its nodes, with the error of the interpolation.

    Parameters
    ----------
    table : path
        A NetCDF file that `miebrdf sweep` wrote.
    variables : str or list of str, optional
        Which of the table's variables; default: all but error_estimate.
    interpolation : {"linear", "cubic"}
        Along every axis; over the logarithm of logarithmic axes. Cubic needs five nodes, with
        fewer an axis is linear.
    **values : float or str
        One for each axis, by its name or the beginning of it if it is the only one: `radius_um` or
        `radius`. Within the table. Axes that are not given are listed at all their nodes.

    Returns
    -------
    LookedUp, or dict of str to LookedUp
        Of one variable, named or the table's only one, the result itself; of several by name.
        Values are numbers or, where axes are listed, arrays: `xarray.DataArray` as everywhere
        (`set_options`).

    Raises
    ------
    UsageError
        For axes, variables and texts that the table has not, values outside of it, and in a build
        without NetCDF.
    InputError
        For a file that cannot be read.

    Examples
    --------
    >>> found = miebrdf.lookup("snow.nc", radius_um=220, soot=3e-8, mu_in=0.55, wavelength_nm=510)  # doctest: +SKIP
    >>> found.value, found.interpolation_error  # doctest: +SKIP
    """
    asked = {name: _as_text(name, value) for name, value in values.items()}
    wanted = [variables] if isinstance(variables, str) else list(variables or [])
    found = _core.look_up_table(os.fspath(table), wanted, asked, interpolation)
    results = {
        one["name"]: LookedUp(
            _labelled(one, one["values"]), _labelled(one, one["errors"]), one["unit"]
        )
        for one in found
    }
    if variables is None and len(results) > 1:
        results.pop("error_estimate", None)
    return next(iter(results.values())) if len(results) == 1 else results


def _as_text(name: str, value: float | str) -> str:
    if isinstance(value, str):
        return value
    if np.ndim(value) != 0:
        raise UsageError(f"{name}: one value is needed, not an array of shape {np.shape(value)}")
    try:
        return repr(float(value))
    except (TypeError, ValueError):
        raise UsageError(f"{name}: a number or a text is needed, not {value!r}") from None


def _labelled(found: dict[str, Any], values: Any) -> Any:
    if not found["axes"]:
        return float(values)
    if not use_xarray():
        return values
    try:
        import xarray
    except ImportError as error:
        from .errors import MissingPackage

        raise MissingPackage(
            f"xarray is not installed ({error}); install it (`apt install python3-xarray` or "
            "`pip install xarray`) or call miebrdf.set_options(xarray=False)"
        ) from None
    coords = {
        axis["name"]: ([axis["name"]], axis["values"], {"units": axis["unit"] or "1"})
        for axis in found["axes"]
    }
    return xarray.DataArray(
        values,
        dims=list(coords),
        coords=coords,
        name=found["name"],
        attrs={"units": found["unit"]},
    )
