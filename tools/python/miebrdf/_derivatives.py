"""How the values of a solved scene change with numbers of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Axes, Floats, Values, broadcast
from ._directions import (
    BRDF_ATTRIBUTES,
    Report,
    at_wavelengths,
    axes_of,
    cosine,
    evaluate_exactly,
)
from ._options import Call
from .colour import _require_visible
from .errors import UsageError

#: Columns of a colour, as the program names them.
_COLOURS = (
    "x", "y", "z", "lab_l", "lab_a", "lab_b",
    "srgb_red", "srgb_green", "srgb_blue", "lch_c", "lch_h",
)  # fmt: skip


class Derivatives:
    """Derivatives of what a scene reflects by its numbers, each by its name.

    Made by `Brdf.derivatives` and `Scene.derivatives`. What is asked comes as a dict of arrays,
    which are laid out as the values themselves, per unit in which the number is written.

    Attributes
    ----------
    names : tuple of str
        Of the numbers.

    Examples
    --------
    >>> scene = Scene("hg:{w=0.9},{g=0.6}", coats=["isotropic:0.99@{tau=0.5}"])
    >>> by = scene.derivatives(550, ["w", "tau"])
    >>> by.albedo(0.5)["tau"]
    """

    def __init__(
        self,
        solved: _core.SolvedScene,
        names: tuple[str, ...],
        wavelengths_nm: tuple[list[float], bool],
        call: tuple[Any, ...],
        scene: Mapping[str, str],
    ) -> None:
        self.names = names
        self._solved = solved
        self._wavelengths_nm, self._single = wavelengths_nm
        self._call = call
        self._scene = dict(scene)

    def brdf(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        part: str = "total",
    ) -> dict[str, Values]:
        """Of the BRDF at these directions, exactly, as `Brdf.exact`.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg, part
            As of `Brdf`: cosines in (0, 1], azimuths in degrees, 0 = mirror side, or angles in [0, 90).
            `part`: total, subsurface, surface.

        Returns
        -------
        dict of xarray.DataArray or numpy.ndarray
            1/sr per unit of each number, of shape ``(wavelengths, *broadcast directions)``.

        Raises
        ------
        UsageError
            For directions out of range, and where a derivative has no bound: by the albedo of a
            half-space that absorbs nothing.

        Examples
        --------
        >>> scene = Scene("hg:{w=0.9},{g=0.6}")
        >>> scene.derivatives([450, 550], ["g"]).brdf(0.5, [0.3, 0.9], 180.0)["g"].shape
        (2, 2)
        """
        axes = axes_of((mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg))
        if 0 in axes.shape:
            empty: Floats = np.empty((len(self.names) * len(self._wavelengths_nm), *axes.shape))
            return self._by_name(empty, axes, {}, "brdf")
        with Call(*self._call) as options:
            values, report = evaluate_exactly(
                lambda i, o, azimuth: self._solved.evaluate_derivatives(
                    self.names, i, o, azimuth, part, options
                ),
                axes,
            )
        report.warn()
        attributes = {**BRDF_ATTRIBUTES, "part": part, **report.attributes()}
        return self._by_name(values, axes, attributes, "brdf")

    def hdrf(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        diffuse_fraction: float = 0.0,
        sky: str = "uniform",
    ) -> dict[str, Values]:
        """Of the reflectance factor under a sky, as ``miebrdf brdf --quantity hdrf``.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg
            As of `Brdf`; ``mu_in`` is the sun's.
        diffuse_fraction : float
            Share of the sky in the light, 0 (sun alone) to 1.
        sky : str
            As of `Brdf.hdrf`.

        Returns
        -------
        dict of xarray.DataArray or numpy.ndarray
            Per unit of each number, of shape ``(wavelengths, *broadcast directions)``.

        Raises
        ------
        UsageError
            As of `brdf`, and for a sky over an opaque lobe.

        Examples
        --------
        >>> scene = Scene("hg:{w=0.9},{g=0.6}")
        >>> scene.derivatives(550, ["g"]).hdrf(0.5, 0.9, 180.0, diffuse_fraction=0.3)["g"]
        """
        axes = axes_of((mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg))
        if 0 in axes.shape:
            empty: Floats = np.empty((len(self.names) * len(self._wavelengths_nm), *axes.shape))
            return self._by_name(empty, axes, {}, "hdrf")
        with Call(*self._call) as options:
            values, report = evaluate_exactly(
                lambda i, o, azimuth: self._solved.hdrf(
                    self.names, i, o, azimuth, diffuse_fraction, sky, options
                ),
                axes,
            )
        report.warn()
        return self._by_name(values, axes, report.attributes(), "hdrf")

    def colour(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        illuminant: str = "d65",
    ) -> dict[str, dict[str, Floats]]:
        """Of the colour of the plane albedo, or where ``mu_out`` is given of pi times the BRDF.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg
            As of `albedo` or `brdf`.
        illuminant : str
            "d65", "d50", "a" or "e", by the 2-degree observer or, after a comma, that of 10:
            "d65,10".

        Returns
        -------
        dict of dict of numpy.ndarray
            By the name of each number and the columns of ``miebrdf albedo --colour``: x, y, z,
            lab_l, lab_a, lab_b, srgb_red, srgb_green, srgb_blue (encoded), lch_c, lch_h (degrees;
            not a number where there is no chroma), of the shape of the directions.

        Raises
        ------
        UsageError
            For wavelengths that are no colour (eight or more, from 430 to 650 nm or beyond), and as
            of `brdf`.

        Examples
        --------
        >>> scene = Scene("TiO2,radius={r=0.2} + Fe2O3,radius=0.1,volume={c=1}%")
        >>> scene.derivatives(range(400, 701, 10), ["c"]).colour(0.5)["c"]["lab_b"]
        """
        _require_visible(self._wavelengths_nm)
        if mu_out is None and theta_out_deg is None:
            axes = broadcast({"mu_in": cosine("in", mu_in, theta_in_deg)})
            cosines = axes.arrays[0].reshape(-1).tolist()
            with Call(*self._call) as options:
                columns, _ = self._solved.albedo(cosines, options)
            reflectance = columns["plane_albedo"]
            slopes = self.albedo(mu_in, theta_in_deg=theta_in_deg)
        else:
            given = (mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg)
            axes = axes_of(given)
            with Call(*self._call) as options:
                reflectance, _ = evaluate_exactly(
                    lambda i, o, azimuth: self._solved.evaluate(i, o, azimuth, "total", options),
                    axes,
                )
            reflectance = np.pi * reflectance
            of_brdf = self.brdf(mu_in, mu_out, azimuth_deg, theta_in_deg=theta_in_deg,
                                theta_out_deg=theta_out_deg)  # fmt: skip
            slopes = {name: np.pi * slope for name, slope in of_brdf.items()}
        nm = self._wavelengths_nm
        rows = np.ascontiguousarray(np.asarray(reflectance).reshape(len(nm), -1).T)
        result = {}
        for name, slope in slopes.items():
            change = np.ascontiguousarray(np.asarray(slope).reshape(len(nm), -1).T)
            table = _core.colour_derivatives(nm, rows, change, illuminant)
            result[name] = {
                column: table[:, i].reshape(axes.shape) for i, column in enumerate(_COLOURS)
            }
        return result

    def albedo(
        self,
        mu_in: ArrayLike | None = None,
        *,
        theta_in_deg: ArrayLike | None = None,
        transmitted: bool = False,
    ) -> dict[str, Values]:
        """Of the plane albedo, or with `transmitted` the transmittance, as `Brdf.albedo`.

        Parameters
        ----------
        mu_in, theta_in_deg : float or array
            Cosines of incidence in (0, 1], or angles in [0, 90).
        transmitted : bool
            The plane transmittance instead.

        Returns
        -------
        dict of xarray.DataArray or numpy.ndarray
            Per unit of each number, of shape ``(wavelengths, *shape of mu_in)``.

        Raises
        ------
        UsageError
            As of `brdf`, and for a transmittance where there is none.

        Examples
        --------
        >>> scene = Scene("hg:{w=0.9},{g=0.6}")
        >>> scene.derivatives(550, ["w", "g"]).albedo([0.2, 1.0])["w"]
        """
        axes = broadcast({"mu_in": cosine("in", mu_in, theta_in_deg)})
        name = "plane_transmittance" if transmitted else "plane_albedo"
        return self._albedo(name, axes.arrays[0].reshape(-1).tolist(), axes)

    def spherical_albedo(self, *, transmitted: bool = False) -> dict[str, Values]:
        """Of the spherical albedo, or with `transmitted` the transmittance.

        Parameters
        ----------
        transmitted : bool
            The spherical transmittance instead.

        Returns
        -------
        dict of xarray.DataArray or numpy.ndarray
            Per unit of each number, one value for each wavelength.

        Raises
        ------
        UsageError
            As of `albedo`.

        Examples
        --------
        >>> scene = Scene(substrate="lambert:{ground=0.3}", coats=["hg:0.9,0.6@{tau=2}"])
        >>> scene.derivatives(550, ["ground", "tau"]).spherical_albedo(transmitted=True)["tau"]
        """
        name = "spherical_transmittance" if transmitted else "spherical_albedo"
        return self._albedo(name, [1.0], Axes([], [], {}, ()))

    def _albedo(self, name: str, mu_in: list[float], axes: Axes) -> dict[str, Values]:
        if 0 in axes.shape:
            empty: Floats = np.empty((len(self.names) * len(self._wavelengths_nm), *axes.shape))
            return self._by_name(empty, axes, {}, name)
        with Call(*self._call) as options:
            columns, facts = self._solved.albedo_derivatives(self.names, mu_in, options)
        if any(each[name] is None for each in columns):
            raise UsageError(f"{name}: only scenes on a substrate without a surface have one")
        report = Report(**facts)
        report.warn()
        values = np.concatenate([each[name] for each in columns])
        values = values.reshape([values.shape[0], *axes.shape])
        return self._by_name(values, axes, report.attributes(), name)

    def _by_name(
        self, values: Floats, axes: Axes, attributes: Mapping[str, Any], quantity: str
    ) -> dict[str, Values]:
        """Values of shape (names x wavelengths, *axes.shape)."""
        of_each = values.reshape([len(self.names), len(self._wavelengths_nm), *axes.shape])
        return {
            name: at_wavelengths(
                np.ascontiguousarray(one),
                self._wavelengths_nm,
                self._single,
                axes,
                {**attributes, **self._scene, "units": f"{attributes.get('units', '1')} per {name}"},
                f"{quantity}_d_{name}",
            )
            for name, one in zip(self.names, of_each, strict=True)
        }

    def __repr__(self) -> str:
        return f"<miebrdf.Derivatives by {', '.join(self.names)}>"
