"""What a solved scene is asked without a table: albedos and layers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Axes, Floats, Values, broadcast
from ._directions import Report, at_wavelengths, cosine
from ._options import Call
from .errors import UsageError


class LayerFacts(TypedDict):
    """One layer at one wavelength; None where amounts or densities are not known."""

    wavelength_nm: float
    layer: str  #: "base", "coat 1", ...
    optical_depth: float
    single_scattering_albedo: float
    asymmetry: float
    scattering_per_um: float | None
    absorption_per_um: float | None
    reduced_scattering_per_um: float | None
    k_km: float | None  #: Kubelka and Munk's K, 1/um
    s_km: float | None
    mass_extinction_m2_per_kg: float | None


class Albedos:
    """The part of `Brdf` that needs no table."""

    _nm: list[float]
    _single: bool
    _call: tuple[Any, ...]
    _solved: _core.SolvedScene

    def _scene_attributes(self) -> dict[str, str]:
        raise NotImplementedError

    def albedo(
        self,
        mu_in: ArrayLike | None = None,
        *,
        theta_in_deg: ArrayLike | None = None,
        transmitted: bool = False,
    ) -> Values:
        """Plane albedo at each incidence, surface included.

        Parameters
        ----------
        mu_in : float or array
            Cosines of incidence, in (0, 1].
        theta_in_deg : float or array
            In place of `mu_in`.
        transmitted : bool
            The plane transmittance instead: net flux into what lies below the layers, of a scene
            on a substrate without a surface.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(wavelengths, *shape of mu_in)``.

        Raises
        ------
        UsageError
            For cosines out of range, and a transmittance where there is none.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.albedo([0.2, 0.5, 1.0]).shape
        (3, 3)
        """
        axes = broadcast({"mu_in": cosine("in", mu_in, theta_in_deg)})
        name = "plane_transmittance" if transmitted else "plane_albedo"
        return self._albedo(name, axes.arrays[0].reshape(-1).tolist(), axes)

    def mirror_reflectance(
        self, mu_in: ArrayLike | None = None, *, theta_in_deg: ArrayLike | None = None
    ) -> Values:
        """What of the plane albedo goes into the mirror direction alone.

        A delta function that values of the BRDF are without; only scenes with a smooth boundary or
        a mirror have one.

        Parameters and result are those of `albedo`.

        Parameters
        ----------
        mu_in, theta_in_deg : float or array
            Cosines of incidence in (0, 1], or angles in [0, 90).

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(wavelengths, *shape of mu_in)``.

        Raises
        ------
        UsageError
            For scenes without a smooth boundary or a mirror.

        Examples
        --------
        >>> varnish = Scene("hg:0.9,0.4", host=1.5, boundary="smooth").solve(550)
        >>> varnish.mirror_reflectance(theta_in_deg=[0, 60])
        """
        axes = broadcast({"mu_in": cosine("in", mu_in, theta_in_deg)})
        return self._albedo("mirror_reflectance", axes.arrays[0].reshape(-1).tolist(), axes)

    def unscattered_transmittance(
        self, mu_in: ArrayLike | None = None, *, theta_in_deg: ArrayLike | None = None
    ) -> Values:
        """What passes the layers without being scattered, a part of the plane transmittance.

        Parameters
        ----------
        mu_in, theta_in_deg : float or array
            Cosines of incidence in (0, 1], or angles in [0, 90).

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            In [0, 1], of shape ``(wavelengths, *shape of mu_in)``.

        Raises
        ------
        UsageError
            For scenes without a substrate, and with a rough surface.

        Examples
        --------
        >>> film = Scene(substrate="none", coats=["hg:0.9,0.4@2"]).solve(550)
        >>> film.unscattered_transmittance(1.0)
        """
        axes = broadcast({"mu_in": cosine("in", mu_in, theta_in_deg)})
        return self._albedo("unscattered_transmittance", axes.arrays[0].reshape(-1).tolist(), axes)

    def sphere_reading(
        self,
        mu_in: ArrayLike | None = None,
        *,
        theta_in_deg: ArrayLike | None = None,
        sphere: Mapping[str, float],
        other_sphere: Mapping[str, float] | None = None,
        transmitted: bool = False,
    ) -> Values:
        """The reflectance or transmittance that an integrating sphere reads of this sample.

        Light that leaves the sample beside the ports is not counted.

        Parameters
        ----------
        mu_in, theta_in_deg : float or array
            Of the beam: cosines of incidence in (0, 1], or angles in [0, 90).
        sphere : mapping
            Numbers by their words: diameter, sample_port, third_port, detector_port (mm), wall,
            detector, standard (reflectances), baffle, dual_beam (True, False),
            unscattered_reflectance, unscattered_transmittance, hits_wall (shares).
        other_sphere : mapping, optional
            The second of two spheres that measure at once, below the sample.
        transmitted : bool
            The transmittance, of a scene on a substrate.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(wavelengths, *shape of mu_in)``.

        Raises
        ------
        UsageError
            For words and numbers that are wrong, with what is allowed.

        Examples
        --------
        >>> slab = Scene(substrate="none", coats=["turbid:0.01,1@1mm"]).solve(600)
        >>> slab.sphere_reading(1.0, sphere={"diameter": 200, "sample_port": 25, "wall": 0.97})
        """
        axes = broadcast({"mu_in": cosine("in", mu_in, theta_in_deg)})
        with Call(*self._call) as options:
            columns, facts = self._solved.albedo(axes.arrays[0].reshape(-1).tolist(), options)
        report = Report(**facts)
        report.warn()
        shape = columns["plane_albedo"].shape
        light = []
        for name in ("plane_albedo", "plane_transmittance", "mirror_reflectance",
                     "unscattered_transmittance", "spherical_albedo", "spherical_transmittance"):  # fmt: skip
            column = columns[name]
            full = np.zeros(shape) if column is None else np.asarray(column)
            full = full if full.ndim == 2 else np.repeat(full[:, None], shape[1], axis=1)
            light.append(full.reshape(-1).tolist())
        readings = _core.sphere_reading(
            {word: float(value) for word, value in sphere.items()},
            {word: float(value) for word, value in (other_sphere or {}).items()},
            transmitted,
            light,
        )
        name = "sphere_transmittance" if transmitted else "sphere_reflectance"
        values = np.asarray(readings).reshape([shape[0], *axes.shape])
        attributes = {"units": "1", **self._scene_attributes(), **report.attributes()}
        return at_wavelengths(values, self._nm, self._single, axes, attributes, name)

    def spherical_albedo(self, *, transmitted: bool = False) -> Values:
        """Share that is reflected of light from all directions alike; one for each wavelength.

        `transmitted`: the spherical transmittance instead.

        Parameters
        ----------
        transmitted : bool
            The spherical transmittance: of films.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            In [0, 1], one for each wavelength.

        Raises
        ------
        UsageError
            For a transmittance where there is none.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.spherical_albedo()
        """
        name = "spherical_transmittance" if transmitted else "spherical_albedo"
        return self._albedo(name, [1.0], Axes([], [], {}, ()))

    def gloss(self, *, illuminant: str = "d65") -> Floats:
        """Gloss units at 20, 60 and 85 degrees, as a glossmeter reads them (ISO 2813, ASTM D523).

        100 is polished black glass of index 1.567. A smooth boundary reflects into the receptor as
        a whole; lobes of rough ones are integrated over the standard's apertures. Light from the
        layers that reaches the receptor counts, too.

        Parameters
        ----------
        illuminant : str
            Weighs the wavelengths, which must ascend: "d65", "d50", "a" or "e", then perhaps the
            observer's degrees, "d65,10".

        Returns
        -------
        numpy.ndarray
            Of shape (3,).

        Raises
        ------
        UsageError
            For another illuminant, and wavelengths that do not ascend.

        Examples
        --------
        >>> varnish = Scene("hg:0.9,0.4", host=1.5, boundary="smooth").solve(550)
        >>> varnish.gloss()
        """
        with Call(*self._call) as options:
            units, _ = self._solved.gloss(illuminant, options)
        return units

    def _albedo(self, name: str, mu_in: list[float], axes: Axes) -> Values:
        """One of the columns that the module computes at these cosines."""
        if 0 in axes.shape:
            empty: Floats = np.empty((len(self._nm), *axes.shape))
            return at_wavelengths(empty, self._nm, self._single, axes, {}, name)
        with Call(*self._call) as options:
            columns, facts = self._solved.albedo(mu_in, options)
        if columns[name] is None:
            have = (
                "with a smooth boundary or a mirror"
                if name == "mirror_reflectance"
                else "on a substrate without a surface"
            )
            raise UsageError(f"{name}: only scenes {have} have one")
        report = Report(**facts)
        report.warn()
        column = columns[name]
        values = column.reshape([column.shape[0], *axes.shape])
        attributes = {"units": "1", **self._scene_attributes(), **report.attributes()}
        return at_wavelengths(values, self._nm, self._single, axes, attributes, name)

    def layers(self) -> list[LayerFacts]:
        """Single scattering by every layer; see `Scene.layers`.

        Returns
        -------
        list of dict
            As of `Scene.layers`.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.layers()[0]["single_scattering_albedo"]
        """
        with Call(*self._call) as options:
            return self._solved.layers(options)
