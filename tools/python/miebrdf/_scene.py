"""Scenes: what lies on what."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from ._albedos import LayerFacts
from ._arrays import Values
from ._brdf import Brdf
from ._core import Layer, Medium, Substrate
from ._derivatives import Derivatives
from ._directions import BRDF_ATTRIBUTES, at_wavelengths, axes_of
from ._keywords import Argument, CallAndMethod, checked
from ._media import MediumLike, host_shown
from ._scene_arguments import (
    SceneArguments,
    core_scene,
    particles,
    settled,
    without_names,
    words,
)


class Scene:
    """A half-space or a ground, layers on it and, if wanted, a rough surface above them.

    A number in words may have a name, ``"hg:{w=0.9},{g=0.6}"``: `derivatives` asks for it. A scene
    does not change once it is made, and nothing is looked up or computed until it is
    asked. It can be compared, copied and pickled. Its arguments are attributes by the same names;
    `repr` shows those that are not the defaults.

    Parameters
    ----------
    base : str or Medium, optional
        What lies at the bottom, infinitely deep (see `medium`).
    substrate : str, Substrate or float, optional
        In place of a base: ``"black"``, ``"none"`` (a free film), ``"lambert:0.05"``,
        ``"lambert:FILE.csv"``, `lambertian`, or the albedo of a Lambertian ground.
    coats : list of Layer or str
        In painting order, the last one on top: `coat` or ``"MEDIUM@DEPTH"``.
    roughness : float
        Beckmann slope parameter of a rough surface, in [1e-4, 4]; 0: no surface.
    surface_distribution : str
        Normals of the surface's mirrors: beckmann, ggx.
    shadowing : str
        smith-correlated, smith-separable, v-cavity.
    fresnel : str
        exact, schlick.
    coupling : str, optional
        How the surface weakens the layers' light: paper (on the way in), reciprocal (both ways).
        Default: paper for values, reciprocal in exported files.
    surface_index : complex, optional
        n + ik of the surface; default: that of the top medium.
    boundary : str, optional
        Refracting boundary between air and the host of the top layer: smooth, rough:ALPHA,
        rough:ALPHA,beckmann; ALPHA in [0.02, 1]. Not together with `roughness`.
    effective_radius_um : float
        Of the particles that do not say their own: <r^3>/<r^2> in um, > 0. Default: 50, that of
        the paper's coarse powders; pigments have .1 to .3.
    effective_variance : float
        Of the same, > 0 and up to 10.
    size_distribution : str or (radii_um, number_density)
        Law of the radii (see `medium`), or a table of ascending radii in um and densities n(r) in
        any unit.
    host : str or complex
        What lies between the particles, of media that do not say it: a material, or n + ik.
    k_floor : float
        k of materials below this is raised to it.
    mie_tolerance : float
        Relative error of size averages; 0: a share of the whole tolerance.
    layer_density_kg_m3 : float, optional
        Bulk density of the layers, where mass fractions and thicknesses meet (snow: 50 to 550).
    packing : str
        independent, percus-yevick (crowded hard spheres), effective-host (each scatters in the
        host with the others dissolved in it), or both, ``"percus-yevick,effective-host"``.
    interpolation : str
        Of n and k between their rows: pchip, linear, linear-energy.
    extrapolate : str
        Where a material has no data: refuse, clamp (to the nearer end).
    missing_k_zero : bool
        k = 0 where n is known and k is not.
    database : str
        File of the user's materials; empty: the default one.

    Raises
    ------
    UsageError
        For words and numbers that no scene can have, with what is allowed.

    Notes
    -----
    Values are f in 1/sr without the cosine. ``mu_in`` and ``mu_out`` are cosines from the outward
    normal, both in (0, 1]; ``azimuth_deg`` is 0 on the mirror side and 180 back towards the source.
    The first axis of results is the wavelength, unless that is a single number; the directions
    broadcast like NumPy arrays behind it.

    Examples
    --------
    >>> scene = Scene(
    ...     base=medium("TiO2", radius_um=0.2), coats=[coat("Au", depth=0.5, radius_um=0.03)]
    ... )
    >>> mu_out, azimuth_deg = np.linspace(0.1, 1, 10), np.array([0.0, 90.0, 180.0])
    >>> scene.brdf(550, 0.5, mu_out[:, None], azimuth_deg[None, :])
    >>> b = scene.solve([450, 550, 650])
    >>> b(0.5, mu_out, 0.0)
    """

    __slots__ = ("_arguments", "_core", "_given", "__weakref__")

    base = Argument[Medium | None]()
    substrate = Argument[Substrate | None]()
    coats = Argument[tuple[Layer, ...]]()
    roughness = Argument[float]()
    surface_distribution = Argument[str]()
    shadowing = Argument[str]()
    fresnel = Argument[str]()
    coupling = Argument[str | None]()
    surface_index = Argument[complex | None]()
    effective_radius_um = Argument[float]()
    effective_variance = Argument[float]()
    size_distribution = Argument[str | tuple[list[float], list[float]]]()
    host = Argument[str | complex]()
    k_floor = Argument[float]()
    mie_tolerance = Argument[float]()
    layer_density_kg_m3 = Argument[float | None]()
    packing = Argument[str]()
    boundary = Argument[str | None]()
    interpolation = Argument[str]()
    extrapolate = Argument[str]()
    missing_k_zero = Argument[bool]()
    database = Argument[str]()

    @checked()
    def __init__(
        self,
        base: MediumLike | None = None,
        *,
        substrate: str | float | Substrate | None = None,
        coats: Iterable[str | Layer] = (),
        roughness: float = 0.0,
        surface_distribution: str = "beckmann",
        shadowing: str = "smith-correlated",
        fresnel: str = "exact",
        coupling: str | None = None,
        surface_index: complex | None = None,
        effective_radius_um: float = 50.0,
        effective_variance: float = 0.2,
        size_distribution: str | tuple[ArrayLike, ArrayLike] = "power-law",
        host: str | complex = 1.0,
        k_floor: float = 0.0,
        mie_tolerance: float = 0.0,
        layer_density_kg_m3: float | None = None,
        packing: str = "independent",
        boundary: str | None = None,
        interpolation: str = "pchip",
        extrapolate: str = "refuse",
        missing_k_zero: bool = False,
        database: str = "",
    ) -> None:
        given = {name: value for name, value in locals().items() if name != "self"}
        plain, named = without_names(given)
        self._arguments = settled(plain)
        self._core = core_scene(self._arguments, named)
        #: As they were given where numbers have names.
        self._given = {**self._arguments, **named}

    @checked(SceneArguments)
    def replace(self, **changes: Unpack[SceneArguments]) -> Scene:
        """The same scene with other arguments, e.g. ``scene.replace(roughness=0.3)``.

        Parameters
        ----------
        **changes
            As of `Scene`.

        Returns
        -------
        Scene
            Another one; this one does not change.

        Raises
        ------
        UsageError
            For arguments that `Scene` does not have or take.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> scene.replace(roughness=0.3) == scene
        False
        """
        arguments = {**self._given, **changes}
        if "base" in changes and changes["base"] is not None:
            arguments["substrate"] = changes.get("substrate")
        if "substrate" in changes and changes["substrate"] is not None:
            arguments["base"] = changes.get("base")
        return Scene(**arguments)

    @checked(CallAndMethod)
    def brdf(
        self,
        wavelengths_nm: ArrayLike,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        part: str = "total",
        **options: Unpack[CallAndMethod],
    ) -> Values:
        """The BRDF at these directions, exactly: nothing is interpolated.

        For more than some thousand directions, `solve` once and ask the result.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
            In vacuum.
        mu_in, mu_out : float or array
            Cosines of incidence and reflection, in (0, 1].
        azimuth_deg : float or array
            0 = mirror side, 180 = back towards the source.
        theta_in_deg, theta_out_deg : float or array
            Angles from the normal, in [0, 90), in place of the cosines.
        part : str
            total, subsurface (layers alone), surface (lobe alone).
        **options
            As in `solve`: ``tolerance=1e-4``, ``streams=32``, ``threads=1``, ...

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            1/sr, without the cosine, of shape ``(wavelengths, *broadcast directions)``; attributes:
            units, version, sources, error_estimate, tolerance, converged.

        Warns
        -----
        NotConverged
            Where the estimated error is above the tolerance.

        Raises
        ------
        UsageError
            For values out of range and shapes that do not broadcast.
        InputError
            For unknown names and wavelengths that a material does not cover.
        KeyboardInterrupt
            Ctrl-C ends the computation.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> scene.brdf([450, 550], mu_in=0.5, mu_out=[0.3, 0.9], azimuth_deg=180.0)
        >>> scene.brdf(550, theta_in_deg=60, theta_out_deg=np.arange(0, 90, 10), streams=32)
        """
        directions = (mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg)
        if np.size(wavelengths_nm) == 0:
            axes = axes_of(directions)
            attributes = {**BRDF_ATTRIBUTES, "part": part, **self.attributes()}
            return at_wavelengths(np.empty((0, *axes.shape)), [], False, axes, attributes)
        return Brdf(self, wavelengths_nm, options).exact(*directions[:3], theta_in_deg=theta_in_deg,
                                                         theta_out_deg=theta_out_deg, part=part)  # fmt: skip

    @checked(CallAndMethod)
    def mueller(
        self,
        wavelengths_nm: ArrayLike,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        **options: Unpack[CallAndMethod],
    ) -> Values:
        """The Mueller matrix of the BRDF at these directions: light with its polarisation.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
            In vacuum.
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg
            As in `brdf`.
        **options
            As in `solve`; ``stokes=4``: with V (default: I, Q and U).

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            1/sr, without the cosine, of shape ``(wavelengths, *broadcast directions, outgoing,
            incident)``: what it makes of the Stokes vector (I, Q, U[, V]) of the incident light, Q =
            parallel minus perpendicular to the meridian plane of each ray.

        Raises
        ------
        UsageError
            Also for scenes that polarised light cannot be computed of, with the reason.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> scene.mueller(550, 0.5, 0.9, 180.0, stokes=4).shape
        (4, 4)
        """
        solved = Brdf(self, wavelengths_nm, options)
        return solved.mueller(mu_in, mu_out, azimuth_deg, theta_in_deg=theta_in_deg,
                              theta_out_deg=theta_out_deg)  # fmt: skip

    @checked(CallAndMethod)
    def solve(
        self,
        wavelengths_nm: ArrayLike,
        **options: Unpack[CallAndMethod],
    ) -> Brdf:
        """Solve once, to be asked at any number of directions.

        Names are looked up and everything is checked at once; nothing is computed before it is
        asked for: albedos and layers take a fraction of the time of the table for all directions,
        which is made when directions are first asked for.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
            In vacuum.
        **options
            threads, progress, cache (as in `set_options`; also of what the result is asked),
            tolerance (largest error relative to the largest value at the same incidence, in (0, 1);
            default 1e-3), stokes ("auto", 1, 3, 4: components of light), streams (2 to 256; 0: by
            the tolerance), grid (auto, gauss, mapped-gauss, paper), half_space_method (auto,
            fixed-point, doubling), coat_method (auto, first-order, first-order-patched,
            exponential), coat_substeps, delta_m, single_scattering_correction.

        Returns
        -------
        Brdf

        Raises
        ------
        UsageError, InputError
            As `brdf`.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve(np.arange(400, 701, 20), tolerance=1e-3)
        >>> b.albedo(0.5)
        """
        return Brdf(self, wavelengths_nm, options)

    @checked(CallAndMethod)
    def albedo(
        self,
        wavelengths_nm: ArrayLike,
        mu_in: ArrayLike | None = None,
        *,
        theta_in_deg: ArrayLike | None = None,
        **options: Unpack[CallAndMethod],
    ) -> Values:
        """Plane albedo, the share of the light from one direction that is reflected.

        Without a direction: the spherical albedo, of light from all directions alike.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
        mu_in : float or array, optional
            Cosines of incidence, in (0, 1].
        theta_in_deg : float or array, optional
            In place of `mu_in`.
        **options
            As in `solve`.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(wavelengths, *shape of mu_in)``.

        Raises
        ------
        UsageError, InputError
            As `brdf`.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> scene.albedo([450, 550, 650], theta_in_deg=60)
        >>> scene.albedo(550)  # spherical
        """
        solved = Brdf(self, wavelengths_nm, options)
        if mu_in is None and theta_in_deg is None:
            return solved.spherical_albedo()
        return solved.albedo(mu_in, theta_in_deg=theta_in_deg)

    @checked(CallAndMethod)
    def derivatives(
        self,
        wavelengths_nm: ArrayLike,
        names: Iterable[str],
        **options: Unpack[CallAndMethod],
    ) -> Derivatives:
        """How what it reflects changes with numbers of it; see `Brdf.derivatives`.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
            In vacuum.
        names : iterable of str
            As of `Brdf.derivatives`.
        **options
            As of `solve`.

        Returns
        -------
        Derivatives

        Raises
        ------
        UsageError, InputError
            As `brdf`.

        Examples
        --------
        >>> scene = Scene("hg:{w=0.9},{g=0.6}", coats=["isotropic:0.99@{tau=0.5}"])
        >>> scene.derivatives(550, ["w", "g", "tau"]).brdf(0.5, 0.7, 30.0)["w"]
        """
        return Brdf(self, wavelengths_nm, options).derivatives(names)

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers that have names in its words, ``{w=0.9}``, each once.

        Examples
        --------
        >>> Scene("hg:{w=0.9},{g=0.6}").numbers
        {'w': 0.9, 'g': 0.6}
        """
        return self._core.numbers

    @checked(CallAndMethod)
    def layers(
        self, wavelengths_nm: ArrayLike, **options: Unpack[CallAndMethod]
    ) -> list[LayerFacts]:
        """Single scattering by every layer at every wavelength, from the lowest up.

        Returns
        -------
        list of dict
            wavelength_nm, layer, optical_depth, single_scattering_albedo, asymmetry,
            scattering_per_um, absorption_per_um, reduced_scattering_per_um, k_km and s_km
            (Kubelka-Munk's, 1/um), mass_extinction_m2_per_kg; None where amounts or densities are
            not known. Albedo and asymmetry of a layer without depth are NaN: nothing is there.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
            In vacuum.
        **options
            As of `solve`.

        Raises
        ------
        UsageError, InputError
            As `brdf`.

        Examples
        --------
        >>> Scene(substrate="black", coats="TiO2,radius=0.13,volume=15% in index:1.5@40um").layers(550)[0]["s_km"]
        """
        return Brdf(self, wavelengths_nm, options).layers()

    def attributes(self) -> dict[str, str]:
        """What results say of their scene in their attributes: scene, host, particles.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> scene.attributes()["particles"]
        """
        return {
            "scene": str(self),
            "host": host_shown(self._arguments["host"]),
            "particles": "\n".join(particles(self._arguments, DEFAULTS["effective_radius_um"])),
        }

    def __str__(self) -> str:
        return str(self._core)

    def __repr__(self) -> str:
        given = [
            f"{name}={words(value)}"
            for name, value in self._given.items()
            if value is not None and value != DEFAULTS[name]
        ]
        return f"miebrdf.Scene({', '.join(given)})"

    def _repr_html_(self) -> str:
        from ._plots import scene_html

        return scene_html(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self._given == other._given

    def __hash__(self) -> int:
        return hash(repr(self))

    def __reduce__(self) -> Any:
        return _scene_of, (self._given,)


#: Of the arguments of `Scene`, as its signature says them.
DEFAULTS = {name: each.default for name, each in inspect.signature(Scene).parameters.items()}


def _scene_of(arguments: dict[str, Any]) -> Scene:
    return Scene(**arguments)
