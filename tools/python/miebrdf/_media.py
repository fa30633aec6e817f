"""Media, layers and grounds: what scenes are made of."""

from __future__ import annotations

from typing import Any, Unpack

from numpy.typing import ArrayLike

from . import _core
from ._arrays import complexes, numbers
from ._core import Depth, Layer, Medium, Substrate
from ._keywords import OfMedium, checked
from .errors import UsageError

MediumLike = str | Medium
DepthLike = str | float | Depth


def choice(kind: Any, name: str, value: str) -> Any:
    """The member of an enumeration of the module by its name; '-' is as good as '_'."""
    member = kind.__members__.get(str(value).replace("-", "_"))
    if member is None:
        allowed = ", ".join(kind.__members__).replace("_", "-")
        raise UsageError(f"{name}: unknown '{value}'; allowed: {allowed}")
    return member


def number(name: str, value: Any) -> float:
    array = numbers(name, value)
    if array.size != 1:
        raise UsageError(f"{name}: one number is needed, not {array.size}")
    return float(array.reshape(-1)[0])


def optional(name: str, value: Any) -> float | None:
    return None if value is None else number(name, value)


def host_words(host: str | complex) -> str:
    """A host as the words of the library: a name, or ``index:N,K``."""
    if isinstance(host, str):
        return host
    index = complex(complexes("host", host).reshape(-1)[0])
    return f"index:{index.real!r},{index.imag!r}"


def host_shown(host: str | complex) -> str:
    """A host as people read it: a name, n, or n + ik."""
    if isinstance(host, str):
        return host
    return f"{host.real:g}" + (f" + {host.imag:g}i" if host.imag else "")


@checked()
def medium(
    words: MediumLike | None = None,
    *,
    radius_um: float | None = None,
    variance: float | None = None,
    distribution: str | None = None,
    density_g_cm3: float | None = None,
    layer_density_kg_m3: float | None = None,
    volume: float | None = None,
    mass: float | None = None,
    number_per_cm3: float | None = None,
    host: str | complex | None = None,
    index: complex | ArrayLike | None = None,
    wavelengths_nm: ArrayLike | None = None,
    name: str = "own",
) -> Medium:
    """What a layer is made of: scattering particles in a host, or a medium given by its optics.

    Parameters
    ----------
    words : str or Medium, optional
        As on the command line: ``"TiO2"``, ``"index:1.5,0.01"``, ``"hg:0.9,0.4"``,
        ``"isotropic:0.9"``, ``"rayleigh:1"``, ``"moments:FILE"``, with sizes and amounts of their
        own (``"TiO2,radius=0.13,volume=15% in PMMA"``), several joined by ``" + "``.
        `media_forms` lists them all.
    radius_um : float, optional
        Effective radius <r^3>/<r^2> in um, > 0, of the last species; default: that of the scene,
        which is 50 um unless `Scene` is told another.
    variance : float, optional
        Effective variance, > 0 and up to 10.
    distribution : str, optional
        Law of the radii: power-law, gamma, log-normal, rosin-rammler, mono.
    density_g_cm3 : float, optional
        Of the particles' material in g/cm3; default: that of the database.
    layer_density_kg_m3 : float, optional
        Bulk density of the layer; default: that of the scene. For shares of the mass.
    volume, mass : float, optional
        Share of the layer's volume or mass, in [0, 1].
    number_per_cm3 : float, optional
        Particles in a cubic centimetre.
    host : str or complex, optional
        What lies between the particles: a material's name, or n + ik.
    index : complex or array, optional
        n + ik (k >= 0 absorbs) of the particles, in place of `words`: one number, or one for each
        of `wavelengths_nm`; between these it is interpolated monotonically in photon energy.
    wavelengths_nm : array, optional
        Of `index`: nm in vacuum, ascending.
    name : str
        What results call a material given by `index`.

    Returns
    -------
    Medium
        Can be added to others (a mixture), compared, copied and pickled.

    Raises
    ------
    UsageError
        For words and numbers that are wrong, with what is allowed.
    InputError
        For a moments file that is missing or wrong.

    Examples
    --------
    >>> paint = medium("TiO2", radius_um=0.13, volume=0.15) + medium("C_graphite,radius=0.04", volume=0.001)
    >>> own = medium(index=[1.6 + 0.01j, 1.5 + 0.001j], wavelengths_nm=[400, 700], radius_um=0.2)
    """
    if (words is None) == (index is None):
        raise UsageError("medium: give either words or index (with wavelengths_nm)")
    result = _of_index(index, wavelengths_nm, name) if words is None else medium_of_words(words)
    result = result.with_sizes(
        optional("radius_um", radius_um),
        optional("variance", variance),
        distribution,
        optional("density_g_cm3", density_g_cm3),
        optional("layer_density_kg_m3", layer_density_kg_m3),
    )
    amounts = {"volume": volume, "mass": mass, "number": number_per_cm3}
    given = {kind: value for kind, value in amounts.items() if value is not None}
    if len(given) > 1:
        raise UsageError(f"medium: one amount is needed, not {' and '.join(given)}")
    for kind, value in given.items():
        result = result.with_amount(kind, number(kind, value))
    if host is not None:
        result = result.in_host(host_words(host))
    return result


def medium_of_words(words: MediumLike) -> Medium:
    if isinstance(words, Medium):
        return words
    if not isinstance(words, str):
        raise UsageError(f"medium: words or a Medium are needed, not {type(words).__name__}")
    return Medium(words)


def _of_index(index: Any, wavelengths_nm: ArrayLike | None, name: str) -> Medium:
    values = complexes("index", index)
    if wavelengths_nm is None:
        if values.size != 1:
            raise UsageError("index: several values need as many wavelengths_nm")
        one = complex(values.reshape(-1)[0])
        return Medium(f"index:{one.real!r},{one.imag!r}")
    wavelengths = numbers("wavelengths_nm", wavelengths_nm)
    if wavelengths.ndim != 1 or values.shape != wavelengths.shape:
        raise UsageError(
            f"index: shape {values.shape} does not fit wavelengths_nm {wavelengths.shape}; "
            "a list of each is needed"
        )
    return Medium.of_table(name, wavelengths.tolist(), values.tolist())


@checked(OfMedium)
def coat(
    what: MediumLike | Layer | None = None,
    depth: DepthLike | None = None,
    *,
    grey: bool = False,
    thickness_um: float | None = None,
    **of_medium: Unpack[OfMedium],
) -> Layer:
    """A layer of some depth.

    Parameters
    ----------
    what : str or Medium, optional
        A medium, or ``"MEDIUM@DEPTH"`` where no depth is given besides.
    depth : float or str, optional
        Vertical optical depth of extinction at 550 nm, >= 0; it follows the extinction of the
        particles at other wavelengths. Or words: ``"0.1[450nm]"``, ``"0.1[grey]"``, ``"40um"``,
        ``"2kg/m2"``, ``"inf"``.
    grey : bool
        The same optical depth at every wavelength.
    thickness_um : float, optional
        In place of an optical depth; needs an amount (``volume=``, ...).
    **of_medium
        As for `medium`: ``radius_um=0.03``, ``volume=0.01``, ...

    Returns
    -------
    Layer

    Raises
    ------
    UsageError
        For words and numbers that are wrong, with what is allowed.

    Examples
    --------
    >>> coat("Au", depth=0.5, radius_um=0.03)
    >>> coat("AlGaAs7@0.1[grey]")
    >>> coat("TiO2", thickness_um=40, radius_um=0.13, volume=0.15, host="PMMA")
    """
    if isinstance(what, Layer):
        return what
    if depth is not None and thickness_um is not None:
        raise UsageError("coat: give either depth or thickness_um")
    if depth is None and thickness_um is None:
        if isinstance(what, str) and "@" in what and not of_medium:
            return Layer(what)
        raise UsageError("coat: a depth is needed: depth=0.1, thickness_um=40 or 'MEDIUM@DEPTH'")
    return Layer(medium(what, **of_medium), _depth(depth, grey, thickness_um))


def _depth(depth: DepthLike | None, grey: bool, thickness_um: float | None) -> Depth:
    if thickness_um is not None:
        return Depth.thickness_um(number("thickness_um", thickness_um))
    if isinstance(depth, Depth):
        return depth
    if isinstance(depth, str):
        return Depth(depth)
    value = number("depth", depth)
    return Depth.grey(value) if grey else Depth(value)


def lambertian(albedo: ArrayLike, wavelengths_nm: ArrayLike | None = None) -> Substrate:
    """A ground that reflects a share of the flux alike in all directions.

    Parameters
    ----------
    albedo : float or array
        In [0, 1]; one for each of `wavelengths_nm`, linear between them.
    wavelengths_nm : array, optional
        nm in vacuum, ascending.

    Returns
    -------
    Substrate

    Raises
    ------
    UsageError
        For albedos outside of [0, 1], and lists of different lengths.

    Examples
    --------
    >>> Scene(substrate=lambertian([0.1, 0.3], [400, 700]), coats="hg:0.9,0.4@1")
    """
    values = numbers("albedo", albedo).reshape(-1).tolist()
    nm = [] if wavelengths_nm is None else numbers("wavelengths_nm", wavelengths_nm).tolist()
    if len(nm) != (0 if len(values) == 1 and wavelengths_nm is None else len(values)):
        raise UsageError(f"albedo: {len(values)} values do not fit {len(nm)} wavelengths_nm")
    return Substrate(values, nm)


def media_forms() -> list[tuple[str, str, str]]:
    """How media are written in words: (form, example, what it is).

    Returns
    -------
    list of (str, str, str)

    Examples
    --------
    >>> [form for form, example, meaning in media_forms()]
    """
    return _core.media()
