"""Keyword arguments that several functions have, for type checkers too; and what is said of one that
there is not."""

from __future__ import annotations

import difflib
import functools
import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, Literal, Never, ParamSpec, TypedDict, TypeVar, overload

from numpy.typing import ArrayLike

from .errors import UsageError

if TYPE_CHECKING:
    from ._options import Progress

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")


class Argument(Generic[T]):
    """An argument of a `Scene` as an attribute of it, which type checkers, too, refuse to change."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, scene: None, owner: type) -> Argument[T]: ...
    @overload
    def __get__(self, scene: object, owner: type) -> T: ...
    def __get__(self, scene: Any, owner: type) -> Any:
        return self if scene is None else scene._arguments[self._name]

    def __set__(self, scene: object, value: Never) -> None:
        raise AttributeError(
            f"scenes do not change; scene.replace({self._name}=...) is another one"
        )


class Method(TypedDict, total=False):
    """How a scene is solved; `Scene.solve` says what each means."""

    tolerance: float
    stokes: Literal["auto", 1, 3, 4]
    streams: int
    grid: Literal["auto", "gauss", "mapped-gauss", "paper"]
    half_space_method: Literal["auto", "fixed-point", "doubling"]
    coat_method: Literal["auto", "first-order", "first-order-patched", "exponential"]
    coat_substeps: int
    delta_m: bool
    single_scattering_correction: bool


class CallAndMethod(Method, total=False):
    """The same, and the options of long calls (`set_options`)."""

    threads: int | None
    progress: Progress
    cache: bool | None


class ExportOptions(TypedDict, total=False):
    """How a BRDF is written to files; `Brdf.export` says what each means."""

    resolution: int
    mu_in: ArrayLike
    mu_out: ArrayLike
    azimuth_deg: ArrayLike
    rgb: Literal["auto", "cie", "wavelengths"]
    largest_error: float
    accept_error: bool
    incident_angles: int
    bin_centres: int
    acescg: bool
    subsurface: bool


class OfMedium(TypedDict, total=False):
    """Keyword arguments of `medium`."""

    radius_um: float | None
    variance: float | None
    distribution: str | None
    density_g_cm3: float | None
    layer_density_kg_m3: float | None
    volume: float | None
    mass: float | None
    number_per_cm3: float | None
    host: str | complex | None
    index: complex | ArrayLike | None
    wavelengths_nm: ArrayLike | None
    name: str


def checked(*kinds: type) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """A function that refuses a keyword argument that it does not have with the nearest one and all
    that there are. `kinds`: the TypedDicts of its ``**`` argument."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        parameters = inspect.signature(function).parameters.values()
        allowed = [
            each.name
            for each in parameters
            if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)
        ]
        for kind in kinds:
            allowed += list(kind.__annotations__)  # those of its bases, too
        allowed = list(dict.fromkeys(name for name in allowed if name != "self"))

        @functools.wraps(function)
        def wrapper(*arguments: P.args, **named: P.kwargs) -> R:
            for name in named:
                if name not in allowed:
                    raise UsageError(f"{_title(function)}: {unknown('argument', name, allowed)}")
            return function(*arguments, **named)

        return wrapper

    return decorate


def unknown(what: str, name: str, allowed: list[str]) -> str:
    """What is said of a name that there is not."""
    nearest = [known for known in allowed if known.startswith(f"{name}_")]
    nearest += difflib.get_close_matches(name, allowed, 1)
    hint = f" (did you mean {nearest[0]}?)" if nearest else ""
    return f"unknown {what} '{name}'{hint}; allowed: {', '.join(sorted(allowed))}"


def _title(function: Any) -> str:
    return str(function.__qualname__).removesuffix(".__init__")
