"""Solved scenes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._albedos import Albedos, LayerFacts
from ._arrays import Floats, Values, broadcast, wavelength_list
from ._derivatives import Derivatives
from ._directions import (
    BRDF_ATTRIBUTES,
    MUELLER_ATTRIBUTES,
    Directions,
    Report,
    at_wavelengths,
    axes_of,
    cosine,
    evaluate_exactly,
    solver_options,
)
from ._files import ExportedFile, export_arguments, format_of, needs_whole_matrix
from ._keywords import ExportOptions, checked
from ._options import Call
from .errors import UsageError

if TYPE_CHECKING:
    from ._scene import Scene


class Brdf(Albedos):
    """A scene solved at some wavelengths, to be asked at any directions.

    Made by `Scene.solve`. Calling it reads a table, which is made at the first call: light scattered more than once is interpolated
    between 49 x 49 cosines; what has sharp features, the first order of scattering and the surface
    lobe, is evaluated at every direction. Copies and pickles keep what was asked for and solve it
    again when they are used, to the same bits. May be used from several threads.

    Examples
    --------
    >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
    >>> b = scene.solve([450, 550, 650])
    >>> b(0.5, [0.3, 0.9], azimuth_deg=180.0).shape
    (3, 2)
    >>> b.albedo(theta_in_deg=60), b.report.error_estimate
    """

    def __init__(self, scene: Scene, wavelengths_nm: ArrayLike, options: Mapping[str, Any]) -> None:
        self._scene = scene
        self._nm, self._single = wavelength_list(wavelengths_nm)
        self._method = dict(options)
        self._call = tuple(self._method.pop(name, None) for name in ("threads", "progress", "cache"))
        self._solved = _core.SolvedScene(scene._core, self._nm, solver_options(self._method))
        self._tables: dict[str, _core.SolvedTable] = {}
        self._sampler: _core.DirectionSampler | None = None

    @property
    def scene(self) -> Scene:
        """What is solved."""
        return self._scene

    @property
    def wavelengths_nm(self) -> list[float]:
        """Where it is solved, in vacuum."""
        return list(self._nm)

    def _scene_attributes(self) -> dict[str, str]:
        return self._scene.attributes()

    def __call__(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        part: str = "total",
        out: Floats | None = None,
    ) -> Values:
        """The BRDF in 1/sr, without the cosine, from the table.

        Parameters
        ----------
        mu_in, mu_out : float or array
            Cosines, in (0, 1]; up to 1e-6 more, as of unit vectors in single precision, counts as 1.
        azimuth_deg : float or array
            0 = mirror side, 180 = back towards the source.
        theta_in_deg, theta_out_deg : float or array
            Angles in [0, 90), in place of the cosines.
        part : str
            total, subsurface, surface.
        out : numpy.ndarray, optional
            float64, C-contiguous, of the shape of the result: it is written there.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(wavelengths, *broadcast directions)``.
        """
        axes = axes_of((mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg))
        table = self._table(part)
        shape = (() if self._single else (len(self._nm),)) + axes.shape
        if out is None:
            out = np.empty(shape)
        elif out.shape != shape or out.dtype != np.float64:
            raise UsageError(f"out: {out.dtype} {out.shape} is not float64 of shape {shape}")
        with Call(*self._call) as options:
            table.evaluate(axes.arrays[0], axes.arrays[1], axes.arrays[2], out, options)
        values = out[None] if self._single else out
        attributes = {
            **BRDF_ATTRIBUTES,
            "part": part,
            **self._scene_attributes(),
            **self._report_of(table).attributes(),
        }
        return at_wavelengths(values, self._nm, self._single, axes, attributes)

    def exact(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
        part: str = "total",
    ) -> Values:
        """The same without a table, as `Scene.brdf`; single scattering is not computed again.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg, part
            As of `Brdf`: cosines in (0, 1], azimuths in degrees, 0 = mirror side, or angles in [0, 90).
            `part`: total, subsurface, surface.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            1/sr, of shape ``(wavelengths, *broadcast directions)``.

        Raises
        ------
        UsageError
            For directions out of range.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.exact(0.5, 0.9, 180.0)
        """
        return self._exactly(
            lambda mu_in, mu_out, azimuth, options: self._solved.evaluate(
                mu_in, mu_out, azimuth, part, options
            ),
            (mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg),
            {**BRDF_ATTRIBUTES, "part": part},
        )

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
    ) -> Values:
        """The hemispherical-directional reflectance factor, as ``miebrdf brdf --quantity hdrf``.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg
            As of `Brdf`; ``mu_in`` is the sun's.
        diffuse_fraction : float
            Share of the sky in the light, 0 (sun alone) to 1.
        sky : str
            uniform, cie-clear, cie-overcast, or a CSV file ``zenith_deg,azimuth_deg,radiance``.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Of shape ``(wavelengths, *broadcast directions)``; a white Lambertian surface has 1.

        Raises
        ------
        UsageError
            For directions and shares out of range, and for a sky over an opaque lobe.
        InputError
            For a file that is no sky.

        Examples
        --------
        >>> b = Scene("hg:0.95,0.6").solve(550)
        >>> b.hdrf(0.5, [0.3, 0.9], 180.0, diffuse_fraction=0.3, sky="cie-clear").shape
        (2,)
        """
        return self._exactly(
            lambda i, o, azimuth, options: self._solved.hdrf(
                [], i, o, azimuth, diffuse_fraction, sky, options
            ),
            (mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg),
            {"diffuse_fraction": diffuse_fraction, "sky": sky},
            "hdrf",
        )

    def mueller(
        self,
        mu_in: ArrayLike | None = None,
        mu_out: ArrayLike | None = None,
        azimuth_deg: ArrayLike = 0.0,
        *,
        theta_in_deg: ArrayLike | None = None,
        theta_out_deg: ArrayLike | None = None,
    ) -> Values:
        """The Mueller matrix of the BRDF at these directions, exactly, as `Scene.mueller`.

        Of (I, Q, U), or with ``stokes=4`` in `Scene.solve` of (I, Q, U, V); solved with
        ``stokes=1`` or "auto", it is that of three components all the same.

        Parameters
        ----------
        mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg
            As of `Brdf`: cosines in (0, 1], azimuths in degrees, 0 = mirror side, or angles in [0, 90).

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            As of `Scene.mueller`.

        Raises
        ------
        UsageError
            Also for scenes that polarised light cannot be computed of, with the reason.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.mueller(0.5, 0.9, 180.0).shape
        (3, 3, 3)
        """
        return self._exactly(
            self._solved.mueller,
            (mu_in, mu_out, azimuth_deg, theta_in_deg, theta_out_deg),
            MUELLER_ATTRIBUTES,
            "mueller",
            4 if str(self._method.get("stokes")) == "4" else 3,
        )

    def _exactly(
        self,
        solve: Callable[..., tuple[Floats, dict[str, Any]]],
        directions: Directions,
        attributes: dict[str, Any],
        name: str = "brdf",
        stokes: int = 0,
    ) -> Values:
        """What `solve` has at all combinations of cosines and azimuths; matrices of `stokes`
        components."""
        axes = axes_of(directions)
        values: Floats = np.empty((len(self._nm), *axes.shape, *[stokes] * (2 if stokes else 0)))
        facts: dict[str, Any] = {}
        if 0 not in axes.shape:
            with Call(*self._call) as options:
                values, report = evaluate_exactly(lambda *lists: solve(*lists, options), axes)
            report.warn()
            facts = report.attributes()
        return at_wavelengths(values, self._nm, self._single, axes,
                              {**attributes, **self._scene_attributes(), **facts}, name, stokes)  # fmt: skip

    def derivatives(self, names: Iterable[str]) -> Derivatives:
        """How what the scene reflects changes with numbers of it.

        Parameters
        ----------
        names : iterable of str
            Of numbers that have a name in the words of the scene, ``{w=0.9}`` (`Scene.numbers`), or
            ``n(NAME)`` and ``k(NAME)``: the index of a material or host at each wavelength.

        Returns
        -------
        Derivatives

        Raises
        ------
        UsageError
            For numbers that the scene does not have, once they are asked for.

        Examples
        --------
        >>> b = Scene("hg:{w=0.9},{g=0.6}").solve([450, 550])
        >>> b.derivatives(["w", "g"]).albedo(0.5)["g"].shape
        (2,)
        """
        if isinstance(names, str):
            names = [names]
        return Derivatives(
            self._solved,
            tuple(names),
            (self._nm, self._single),
            self._call,
            self._scene_attributes(),
        )

    @property
    def is_tabulated(self) -> bool:
        """Whether the table for all directions has been made."""
        return "total" in self._tables

    @property
    def report(self) -> Report:
        """How well the scene is solved, at directions of all kinds."""
        return self._report_of(self._table("total"))

    def sample(self, mu_in: ArrayLike, u1: ArrayLike, u2: ArrayLike) -> tuple[Floats, Floats, Floats]:
        """Draw outgoing directions about as the BRDF times the cosine, mean of all wavelengths.

        Parameters
        ----------
        mu_in : float or array
            In (0, 1].
        u1, u2 : float or array
            Uniform in [0, 1). All broadcast.

        Returns
        -------
        mu_out, azimuth_deg, pdf : numpy.ndarray
            Cosines in (0, 1], azimuths in [0, 360), densities per unit of solid angle. The mean of
            ``b(mu_in, mu_out, azimuth_deg) * mu_out / pdf`` estimates the albedo without bias.

        Raises
        ------
        UsageError
            For cosines and numbers out of range.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> draw = np.random.default_rng(1)
        >>> mu_out, azimuth_deg, pdf = b.sample(0.5, draw.random(1000), draw.random(1000))
        >>> estimate = (b(0.5, mu_out, azimuth_deg) * mu_out / pdf).mean(axis=-1)  # of the albedos
        """
        axes = broadcast({"mu_in": mu_in, "u1": u1, "u2": u2})
        return self._directions().sample(*axes.arrays)

    def pdf(self, mu_in: ArrayLike, mu_out: ArrayLike, azimuth_deg: ArrayLike) -> Floats:
        """Density of `sample` at a direction, per unit of solid angle; integrates to 1.

        Parameters
        ----------
        mu_in, mu_out : float or array
            Cosines in (0, 1].
        azimuth_deg : float or array
            0 = mirror side.

        Returns
        -------
        numpy.ndarray
            1/sr, > 0.

        Raises
        ------
        UsageError
            For directions out of range.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.pdf(0.5, [0.2, 0.9], 180.0)
        """
        axes = broadcast({"mu_in": mu_in, "mu_out": mu_out, "azimuth_deg": azimuth_deg})
        return self._directions().density(*axes.arrays)

    @checked(ExportOptions)
    def export(
        self,
        path: str | Path,
        format: str | None = None,
        *,
        part: str = "total",
        **how: Unpack[ExportOptions],
    ) -> list[ExportedFile]:
        """Write files for renderers and tools, whole or not at all.

        Parameters
        ----------
        path : str or Path
            Where; some formats write several files with suffixes of their own.
        format : str, optional
            A name of `miebrdf.formats`; default: by the ending of `path`, where one format has it
            (``.bsdf`` is ``rgl``; ``pbrt`` must be asked for).
        part : str
            total, subsurface, surface.
        **how
            resolution (int; how fine, in the format's own unit; 0: its standard), mu_in, mu_out,
            azimuth_deg (directions of formats that list them; default: by the resolution), rgb
            (auto, cie, wavelengths), largest_error (accepted relative rms error of a file that is
            read back; 0: that of the format), accept_error (write the file whatever was found);
            incident_angles and bin_centres of single formats; acescg (bool: colours of mtlx in
            ACEScg) and subsurface (bool; the program alone knows the medium that it needs).

        Returns
        -------
        list of dict
            path, bytes, rms_deviation by kind of directions.

        Raises
        ------
        UsageError
            For an unknown format and options out of range.
        InputError
            When a file cannot be written.
        TooCoarse
            When a file would be further from the BRDF than accepted.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> [file["path"] for file in b.export("paint.npz")]
        """
        chosen = format_of(Path(path)) if format is None else format
        with Call(*self._call) as options:
            table = self._solved.table(
                part, options, needs_whole_matrix(chosen), " ".join(["Python:", *sys.argv])
            )
            return _core.export_table(table, path, chosen, *export_arguments(how), options)

    def plot_lobe(
        self,
        mu_in: float | None = None,
        *,
        theta_in_deg: float | None = None,
        wavelength_nm: float | None = None,
        ax: Any = None,
        **line: Any,
    ) -> Any:
        """Draw the BRDF in the plane of incidence as polar curves (needs matplotlib).

        Parameters
        ----------
        mu_in, theta_in_deg : float, optional
            Incidence; default: 45 degrees.
        wavelength_nm : float, optional
            The nearest one is drawn; default: all, at most nine.
        ax : matplotlib polar axes, optional
        **line
            For ``ax.plot``.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        MissingPackage
            Without matplotlib.

        Examples
        --------
        >>> scene = Scene("TiO2,radius=0.2", coats=["hg:0.9,0.4@0.3"])
        >>> b = scene.solve([450, 550, 650])
        >>> b.plot_lobe(theta_in_deg=30)  # doctest: +SKIP
        """
        from ._plots import plot_lobe

        if mu_in is None and theta_in_deg is None:
            theta_in_deg = 45.0
        mu = float(np.asarray(cosine("in", mu_in, theta_in_deg)))
        return plot_lobe(self, mu, wavelength_nm, ax, line)

    def _repr_html_(self) -> str:
        from ._plots import html

        return html(self)

    def __repr__(self) -> str:
        return f"<miebrdf.Brdf: {self.scene}, {_wavelengths(self._nm)}>"

    def __getstate__(self) -> dict[str, Any]:
        nm: Any = self._nm[0] if self._single else self._nm
        return {"scene": self.scene, "wavelengths_nm": nm,
                "options": {**self._method, "threads": self._call[0]}}  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        Brdf.__init__(self, **state)

    def _table(self, part: str) -> _core.SolvedTable:
        if part not in self._tables:
            with Call(*self._call) as options:
                self._tables[part] = self._solved.table(part, options)
            self._report_of(self._tables[part]).warn()
        return self._tables[part]

    def _report_of(self, table: _core.SolvedTable) -> Report:
        return Report(**table.report)

    def _directions(self) -> _core.DirectionSampler:
        if self._sampler is None:
            with Call(*self._call) as options:
                self._sampler = self._table("total").sampler([], options)
        return self._sampler


def _wavelengths(nm: list[float]) -> str:
    if len(nm) <= 3:
        return ", ".join(f"{each:g}" for each in nm) + " nm"
    return f"{len(nm)} wavelengths from {min(nm):g} to {max(nm):g} nm"
