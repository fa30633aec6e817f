"""From the arguments of a `Scene` to the scene of the module."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, TypedDict

from numpy.typing import ArrayLike

from . import _core
from ._arrays import complexes, numbers
from ._core import Layer, Medium, Substrate
from ._media import (
    MediumLike,
    choice,
    coat,
    host_words,
    lambertian,
    medium_of_words,
    number,
    optional,
)
from .errors import UsageError


class SceneArguments(TypedDict, total=False):
    """Those of `Scene`."""

    base: MediumLike | None
    substrate: str | float | Substrate | None
    coats: Iterable[str | Layer]
    roughness: float
    surface_distribution: str
    shadowing: str
    fresnel: str
    coupling: str | None
    surface_index: complex | None
    effective_radius_um: float
    effective_variance: float
    size_distribution: str | tuple[ArrayLike, ArrayLike]
    host: str | complex
    k_floor: float
    mie_tolerance: float
    layer_density_kg_m3: float | None
    packing: str
    boundary: str | None
    interpolation: str
    extrapolate: str
    missing_k_zero: bool
    database: str


def words(value: Any) -> str:
    """A value of an argument as one would write it."""
    if isinstance(value, (Medium, Layer, Substrate)):
        return repr(str(value))
    if isinstance(value, tuple):
        return "[" + ", ".join(words(each) for each in value) + "]"
    return repr(value)


def particles(of: dict[str, Any], default_radius_um: float) -> list[str]:
    """The sizes of every kind of particle, one line each, and which of them are the defaults."""
    media = [] if of["base"] is None else [of["base"]]
    media += [layer.medium for layer in of["coats"]]
    own_law = not isinstance(of["size_distribution"], str)
    lines = []
    for name, radius, variance, law in dict.fromkeys(
        each for medium in media for each in medium.particles
    ):
        if radius is None and own_law:
            lines.append(f"{name}: a table of sizes")
            continue
        shown = of["effective_radius_um"] if radius is None else radius
        default = radius is None and shown == default_radius_um
        lines.append(
            f"{name}: effective radius {shown:g} um{' (the default)' if default else ''}, "
            f"effective variance {of['effective_variance'] if variance is None else variance:g}, "
            f"{law or ('power-law' if own_law else of['size_distribution'])}"
        )
    return lines


def settled(given: dict[str, Any]) -> dict[str, Any]:
    """The same arguments, what may be written in several ways in one of them: they can be compared,
    pickled and given to `Scene` again."""
    base, substrate, coats, host = (given[each] for each in ("base", "substrate", "coats", "host"))
    if (base is None) == (substrate is None):
        raise UsageError("scene: give either base or substrate")
    if isinstance(coats, (str, Layer)):
        coats = [coats]
    layers = tuple(coat(each) for each in coats)
    roughness = number("roughness", given["roughness"])
    if substrate is not None and not isinstance(substrate, (str, Substrate)):
        substrate = lambertian(substrate)
    return {
        **given,
        "coats": layers,
        "roughness": roughness,
        "substrate": Substrate(substrate) if isinstance(substrate, str) else substrate,
        "base": None if base is None else medium_of_words(base),
        "size_distribution": _law(given["size_distribution"]),
        "host": host if isinstance(host, str) else complex(complexes("host", host).reshape(-1)[0]),
        "database": str(given["database"]),
    }


#: Arguments whose words may give numbers names, and the words as the library says them.
NAMED = {
    "base": "base",
    "substrate": "substrate",
    "coats": "coat",
    "boundary": "boundary",
    "roughness": "roughness",
    "surface_index": "surface-index",
    "host": "host-index",
    "effective_radius_um": "effective-radius",
    "effective_variance": "effective-variance",
    "layer_density_kg_m3": "layer-density",
    "k_floor": "k-floor",
}


#: Those of them that are numbers.
NUMBERS = {
    "roughness",
    "effective_radius_um",
    "effective_variance",
    "layer_density_kg_m3",
    "k_floor",
}


def without_names(given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The arguments with plain numbers in their words, and those whose numbers have names."""
    values: dict[str, str] = {}

    def value_of(place: re.Match[str]) -> str:
        name, value = place.groups()
        if value is not None:
            values.setdefault(name, value)
        if name not in values:
            raise UsageError(f"'{{{name}}}': its value is missing; say {{{name}=0.13}} first")
        return values[name] if value is None else value

    def plain(text: str) -> str:
        return re.sub(r"\{([A-Za-z_]\w*)(?:=([^{}]*))?\}", value_of, text)

    result, named = dict(given), {}
    for argument in NAMED:
        said = given[argument]
        several = argument == "coats" and not isinstance(said, (str, Layer))
        texts = tuple(said) if several else (said,)
        result[argument] = texts if several else said
        if not any(isinstance(text, str) and "{" in text for text in texts):
            continue
        if not all(isinstance(text, str) for text in texts):
            raise UsageError("coats: where numbers have names all coats must be words")
        numbers_only = [plain(text) for text in texts]
        named[argument] = texts if several else said
        result[argument] = numbers_only if several else numbers_only[0]
        if argument == "surface_index":
            result[argument] = complex(*(float(part) for part in numbers_only[0].split(",")))
        elif argument in NUMBERS:
            result[argument] = float(numbers_only[0])
    return result, named


def core_scene(of: dict[str, Any], named: dict[str, Any]) -> _core.Scene:
    """The scene of settled arguments, checked.

    Parameters
    ----------
    named : dict
        As `without_names` gives them.
    """
    scene = _core.Scene(of["base"], of["substrate"], list(of["coats"]), _surface(of))
    extrapolate = of["extrapolate"]
    if extrapolate not in ("refuse", "clamp"):
        raise UsageError(f"extrapolate: unknown '{extrapolate}'; allowed: refuse, clamp")
    scene.set_particles(
        _sizes(of["size_distribution"], of["effective_radius_um"], of["effective_variance"]),
        host_words(of["host"]),
        number("k_floor", of["k_floor"]),
        number("mie_tolerance", of["mie_tolerance"]),
        optional("layer_density_kg_m3", of["layer_density_kg_m3"]),
        choice(_core.Packing, "packing", str(of["packing"]).replace(",", "_")),
    )
    if of["boundary"] is not None:
        scene.set_boundary(of["boundary"])
    if of["coupling"] is not None:
        scene.coupling = choice(_core.Coupling, "coupling", of["coupling"])
    index = of["surface_index"]
    scene.surface_index = None if index is None else complex(index)
    scene.database = of["database"]
    scene.index = _core.IndexOptions(
        choice(_core.Interpolation, "interpolation", of["interpolation"]),
        extrapolate == "clamp",
        bool(of["missing_k_zero"]),
    )
    for argument, said in named.items():
        scene.say(NAMED[argument], [said] if isinstance(said, str) else list(said))
    scene.validate()
    return scene


def _surface(of: dict[str, Any]) -> _core.SurfaceOptions | None:
    if of["roughness"] == 0.0:
        return None
    return _core.SurfaceOptions(
        of["roughness"],
        choice(_core.MicrofacetDistribution, "surface_distribution", of["surface_distribution"]),
        choice(_core.Shadowing, "shadowing", of["shadowing"]),
        choice(_core.Fresnel, "fresnel", of["fresnel"]),
    )


def _law(given: Any) -> Any:
    """The name of a law of sizes, or radii and densities as lists."""
    if isinstance(given, str):
        return given
    radii, density = given
    return numbers("radii_um", radii).tolist(), numbers("number_density", density).tolist()


def _sizes(law: Any, radius_um: float, variance: float) -> _core.SizeDistribution:
    if isinstance(law, str):
        return _core.SizeDistribution(
            law, number("effective_radius_um", radius_um), number("effective_variance", variance)
        )
    return _core.SizeDistribution(radii_um=law[0], number_density=law[1])
