"""Arrays in and out: numbers of any kind become float64, results get names and units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._options import use_xarray
from .errors import UsageError

if TYPE_CHECKING:
    import xarray

Floats = NDArray[np.float64]
#: Results: where xarray is installed and wanted DataArrays, else arrays of NumPy's.
Values: TypeAlias = "xarray.DataArray"


def numbers(name: str, value: ArrayLike) -> Floats:
    """The values as float64, without a copy where they are that already.

    Raises
    ------
    UsageError
        For what is no array of real numbers.
    """
    try:
        array = np.asarray(value)
    except ValueError as error:  # ragged lists
        raise UsageError(f"{name}: an array of numbers is needed ({error})") from None
    if array.size == 0 and array.dtype == object:
        array = array.astype(np.float64)
    if array.dtype.kind not in "iuf":
        raise UsageError(f"{name}: an array of real numbers is needed, not of {array.dtype}")
    return array.astype(np.float64, copy=False)


def complexes(name: str, value: ArrayLike) -> NDArray[np.complex128]:
    """The same for n + ik."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise UsageError(f"{name}: an array of numbers is needed ({error})") from None
    if array.dtype.kind not in "iufc":
        raise UsageError(f"{name}: an array of numbers n + ik is needed, not of {array.dtype}")
    return array.astype(np.complex128, copy=False)


def wavelength_list(value: ArrayLike) -> tuple[list[float], bool]:
    """Wavelengths in nm, and whether there was one alone, without a list."""
    if is_labelled(value):
        value = value.values  # type: ignore[union-attr]
    array = numbers("wavelengths_nm", value)
    if array.ndim > 1:
        raise UsageError(
            f"wavelengths_nm: a number or a list is needed, not an array of shape {array.shape}; "
            "wavelengths are the first axis of every result, directions broadcast behind it"
        )
    return array.reshape(-1).tolist(), array.ndim == 0


def is_labelled(value: Any) -> bool:
    """Whether it is an xarray.DataArray (which then has been imported already)."""
    return hasattr(value, "dims") and hasattr(value, "coords") and hasattr(value, "values")


class Axes(NamedTuple):
    """Arguments brought to one shape, and what its axes are called."""

    arrays: list[Floats]  #: strided views of what was given, all of one shape
    names: list[str]  #: of the axes
    given: dict[str, Floats]  #: the arguments before they were broadcast
    shape: tuple[int, ...]
    labels: dict[str, Any] = {}  #: coordinates of the axes that DataArrays brought with them


def broadcast(arguments: dict[str, ArrayLike]) -> Axes:
    """Broadcast like NumPy; DataArrays by the names of their dimensions.

    Raises
    ------
    UsageError
        For shapes that do not fit, with all of them.
    """
    names: list[str] | None = None
    labels: dict[str, Any] = {}
    if any(is_labelled(value) for value in arguments.values()):
        arguments, names, labels = _by_names(arguments)
    given = {name: numbers(name, value) for name, value in arguments.items()}
    try:
        shape = np.broadcast_shapes(*(array.shape for array in given.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in given.items())
        raise UsageError(
            f"shapes do not broadcast: {shapes}; for every combination write e.g. "
            "mu_out[:, None], azimuth_deg[None, :]"
        ) from None
    arrays = [np.broadcast_to(array, shape) for array in given.values()]
    if names is None:
        names = [_axis_name(given, shape, axis) for axis in range(len(shape))]
    return Axes(arrays, names, given, shape, labels)


def _by_names(arguments: dict[str, Any]) -> tuple[dict[str, Any], list[str], dict[str, Any]]:
    """Arrays that broadcast like NumPy's, their axes in the order in which they were named first;
    the axes' names; their coordinates."""
    names: list[str] = []
    labels: dict[str, Any] = {}
    for argument, value in arguments.items():
        if not is_labelled(value):
            if np.ndim(value) > 0:
                raise UsageError(
                    f"{argument}: a DataArray or a number is needed where others are DataArrays"
                )
            continue
        names += [str(name) for name in value.dims if str(name) not in names]
        for name in value.dims:
            if name not in value.coords:
                continue
            label = np.asarray(value.coords[name].values)
            if name in labels and not np.array_equal(labels[name], label):
                raise UsageError(
                    f"{argument}: the coordinate {name} differs from that of another argument"
                )
            labels[str(name)] = label
    arrays: dict[str, Any] = {}
    for argument, value in arguments.items():
        array = value
        if is_labelled(value):
            own = [str(name) for name in value.dims]
            order = sorted(range(len(own)), key=lambda axis: names.index(own[axis]))
            lengths = dict(zip(own, np.shape(value.values)))
            array = value.values.transpose(order).reshape([lengths.get(each, 1) for each in names])
        arrays[argument] = array
    return arrays, names, labels


def varying_axes(array: Floats, dimensions: int) -> list[int]:
    """Axes of the common shape along which an argument has more than one value."""
    missing = dimensions - array.ndim
    return [missing + axis for axis, length in enumerate(array.shape) if length != 1]


def _axis_name(given: dict[str, Floats], shape: tuple[int, ...], axis: int) -> str:
    """That of the only argument that varies along it and nowhere else."""
    varying = [name for name, array in given.items() if axis in varying_axes(array, len(shape))]
    if len(varying) == 1 and len(varying_axes(given[varying[0]], len(shape))) == 1:
        return varying[0]
    return f"dim_{axis}"


_UNITS = {
    "wavelength_nm": "nm",
    "mu_in": "1",
    "mu_out": "1",
    "azimuth_deg": "degree",
    "angle_deg": "degree",
    "theta_in_deg": "degree",
    "theta_out_deg": "degree",
}


def labelled(
    values: NDArray[Any],
    name: str,
    wavelengths_nm: Sequence[float] | float | None,
    axes: Axes | None,
    attributes: dict[str, Any],
    stokes: int = 0,
    channels: list[str] | None = None,
) -> Values:
    """A DataArray on the same memory, where these are wanted; else the values themselves.

    Parameters
    ----------
    wavelengths_nm
        A list: the first axis. A number: a coordinate without an axis.
    stokes
        Components of Mueller matrices, the last two axes ``outgoing`` and ``incident``; 0: none.
    channels
        Names along the first axis, where these are no wavelengths.
    """
    if not use_xarray():
        plain: Any = values
        return plain  # type: ignore[no-any-return]
    try:
        import xarray
    except ImportError as error:
        from .errors import MissingPackage

        raise MissingPackage(
            f"xarray is not installed ({error}); install it (`apt install python3-xarray` or "
            "`pip install xarray`) or call miebrdf.set_options(xarray=False)"
        ) from None
    dims: list[str] = []
    coords: dict[str, Any] = {}

    def add(coordinate: str, where: list[str], data: Any) -> None:
        coords[coordinate] = (where, data, {"units": _UNITS.get(coordinate, "1")})

    if channels is not None:
        dims.append("channel")
        coords["channel"] = (["channel"], channels)
    if wavelengths_nm is not None:
        if isinstance(wavelengths_nm, float):
            add("wavelength_nm", [], wavelengths_nm)
        else:
            dims.append("wavelength_nm")
            add("wavelength_nm", dims[:], wavelengths_nm)
    if axes is not None:
        dims += axes.names
        for label, data in axes.labels.items():
            add(label, [label], data)
        for argument, array in axes.given.items():
            if argument in axes.names and varying_axes(array, len(axes.shape)) != [axes.names.index(argument)]:
                continue  # the name of an axis belongs to what varies along it
            own = varying_axes(array, len(axes.shape))
            add(
                argument,
                [axes.names[axis] for axis in own],
                array.reshape([axes.shape[axis] for axis in own]),
            )
    for axis in ("outgoing", "incident") if stokes else ():
        dims.append(axis)
        coords[axis] = ([axis], list("IQUV")[:stokes], {"long_name": f"Stokes component, {axis}"})
    result: Values = xarray.DataArray(
        values, dims=dims, coords=coords, name=name, attrs=storable(attributes)
    )
    return result


def storable(attributes: dict[str, Any]) -> dict[str, Any]:
    """Attributes that files keep (`to_netcdf`): numbers and texts; lists become lines."""
    kept = {}
    for name, value in attributes.items():
        if isinstance(value, bool):
            value = int(value)
        elif isinstance(value, (list, tuple)):
            value = "\n".join(map(str, value))
        kept[name] = value
    return kept
