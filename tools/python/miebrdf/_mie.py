"""Single scattering by spheres."""

from __future__ import annotations

from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Axes, Floats, Values, broadcast, complexes, labelled, numbers, wavelength_list
from ._keywords import checked
from ._options import Call, Progress
from .errors import UsageError


class Sphere(NamedTuple):
    """Efficiencies (cross-sections over pi r^2) of single spheres, arrays of one shape.

    Examples
    --------
    >>> one = sphere(1.5 + 0.01j, [1.0, 10.0])
    >>> one.q_ext - one.q_sca - one.q_abs
    """

    q_ext: Floats  #: extinction, q_sca + q_abs
    q_sca: Floats  #: scattering
    q_abs: Floats  #: absorption, summed by itself; exactly 0 for k = 0
    q_back: Floats  #: radar backscattering, ``4 |S(180)|^2 / x^2``
    asymmetry: Floats  #: g, mean cosine of the scattering angle
    accuracy: Floats  #: estimated relative error from rounding
    reached: NDArray[np.bool_]  #: accuracy <= 1e-12


def sphere(m: ArrayLike, x: ArrayLike, *, threads: int | None = None) -> Sphere:
    """Lorenz-Mie theory of homogeneous spheres.

    Parameters
    ----------
    m : complex or array
        Index of the sphere over that of its host, n + ik; n in [0.01, 100], k in [0, 10000]. Some
        other programs (miepython) have n - ik.
    x : float or array
        Size parameter 2 pi r n_host / wavelength, in [1e-30, 1e7]. Broadcasts with `m`.
    threads : int, optional
        Not used by single spheres; accepted everywhere.

    Returns
    -------
    Sphere
        q_ext, q_sca, q_abs, q_back, asymmetry, accuracy, reached: numbers, or arrays of the
        broadcast shape.

    Raises
    ------
    UsageError
        For an index or size parameter out of range.

    Notes
    -----
    Efficiencies are right to 1e-12 from x = 1e-8 to 1e6 (docs/accuracy.md).

    Examples
    --------
    >>> sphere(1.5 + 0.1j, 10).q_ext
    """
    index, size = complexes("m", m), numbers("x", x)
    try:
        index, size = np.broadcast_arrays(index, size)
    except ValueError:
        raise UsageError(f"shapes do not broadcast: m {index.shape}, x {size.shape}") from None
    with Call(threads, False, False) as options:
        columns = _core.spheres(index.reshape(-1).tolist(), size.reshape(-1).tolist(), options)
    shaped = {name: column.reshape(size.shape)[()] for name, column in columns.items()}
    return Sphere(**shaped)


def amplitudes(
    m: complex, x: float, angles_deg: ArrayLike
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """S1 (field perpendicular to the scattering plane) and S2 (parallel) of one sphere.

    Parameters
    ----------
    m, x
        As for `sphere`.
    angles_deg : float or array
        Scattering angles, 0 (forward) to 180.

    Returns
    -------
    s1, s2 : numpy.ndarray
        Complex, of the shape of `angles_deg`; time factor exp(-i omega t).

    Raises
    ------
    UsageError
        For arguments out of range.

    Examples
    --------
    >>> s1, s2 = amplitudes(1.5, 10.0, [0, 90, 180])
    >>> abs(s1) ** 2, abs(s2) ** 2
    """
    angles = numbers("angles_deg", angles_deg)
    with Call() as options:
        s1, s2 = _core.amplitudes(complex(m), float(x), angles.reshape(-1).tolist(), options)
    return s1.reshape(angles.shape), s2.reshape(angles.shape)


def coefficients(m: complex, x: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Mie coefficients a_n (electric) and b_n (magnetic), n = 1, 2, ... of one sphere.

    Parameters
    ----------
    m, x
        As for `sphere`; one number each.

    Returns
    -------
    a, b : numpy.ndarray
        Complex; time factor exp(-i omega t).

    Raises
    ------
    UsageError
        For arguments out of range.

    Examples
    --------
    >>> a, b = coefficients(1.5, 10.0)
    >>> 2 / 10.0**2 * sum((2 * n + 1) * (a[n - 1] + b[n - 1]).real for n in range(1, len(a) + 1))  # q_ext
    """
    return _core.coefficients(complex(m), float(x))


class Ensemble(NamedTuple):
    """Averages over a size distribution by cross-section, one entry for each wavelength.

    Examples
    --------
    >>> optics = ensemble("TiO2", [450, 550], radius_um=0.2, highest_moment=8)
    >>> optics.single_scattering_albedo, optics.chi.shape
    """

    single_scattering_albedo: Floats  #: scattering / extinction
    one_minus_albedo: Floats  #: absorption / extinction, summed by itself
    q_ext: Floats  #: <C_ext> / <pi r^2>
    q_sca: Floats
    q_abs: Floats
    asymmetry: Floats  #: g
    error_estimate: Floats  #: relative, of albedo, q_ext and moments
    chi: Floats  #: Legendre moments chi_0 = 1 ... as the last axis
    phase: Floats  #: P at the angles as the last axis; mean over the sphere = 1
    phase_error: Floats  #: of each, absolute
    converged: NDArray[np.bool_]


def _indices(material: Any, wavelengths: list[float]) -> list[complex]:
    """n + ik at each wavelength, of a name, a Material, a number or an array."""
    if isinstance(material, str):
        from ._materials import materials

        material = materials[material]
    if hasattr(material, "nk"):
        return [complex(value) for value in np.asarray(material.nk(wavelengths))]
    values = complexes("material", material)
    if values.ndim == 0:
        return [complex(values)] * len(wavelengths)
    if values.shape != (len(wavelengths),):
        raise UsageError(
            f"material: shape {values.shape} does not fit {len(wavelengths)} wavelengths"
        )
    return [complex(value) for value in values]


@checked()
def ensemble(
    material: Any,
    wavelengths_nm: ArrayLike,
    *,
    radius_um: float = 50.0,
    variance: float = 0.2,
    distribution: str = "power-law",
    sizes: tuple[ArrayLike, ArrayLike] | None = None,
    host_index: float = 1.0,
    highest_moment: int = -1,
    angles_deg: ArrayLike = (),
    tolerance: float = 1e-4,
    phase_tolerance: float = 1e-2,
    progress: Progress = None,
) -> Ensemble:
    """Mie theory averaged over a size distribution.

    Parameters
    ----------
    material : str, Material, complex or array
        A name of the database, or n + ik of the particles: one, or one for each wavelength.
    wavelengths_nm : float or array of one dimension
        In vacuum.
    radius_um, variance : float
        Effective radius in um, > 0 (default: 50, as everywhere), and effective variance, > 0 and up
        to 10.
    distribution : str
        power-law, gamma, log-normal, rosin-rammler, mono.
    sizes : (radii_um, number_density), optional
        A table in place of a law.
    host_index : float
        Real index of the medium between the particles.
    highest_moment : int
        Legendre moments chi_0 ... chi_L are computed; -1: none.
    angles_deg : array
        Scattering angles for the phase function, 0 to 180.
    tolerance, phase_tolerance : float
        Relative, of the averages, and of P at each angle.
    progress
        As in `set_options`.

    Returns
    -------
    Ensemble

    Raises
    ------
    UsageError
        For an index, wavelength, angle or distribution out of range.

    Examples
    --------
    >>> ensemble("TiO2", [450, 550, 650], radius_um=0.2, host_index=1.5).asymmetry
    """
    wavelengths, single = wavelength_list(wavelengths_nm)
    if sizes is None:
        law = _core.SizeDistribution(distribution, float(radius_um), float(variance))
    else:
        law = _core.SizeDistribution(
            radii_um=numbers("radii_um", sizes[0]).tolist(),
            number_density=numbers("number_density", sizes[1]).tolist(),
        )
    if not isinstance(highest_moment, int) or not -1 <= highest_moment <= 10**6:
        raise UsageError(f"highest_moment: {highest_moment!r} is out of range; allowed: -1 to 1e6")
    angles = numbers("angles_deg", angles_deg).reshape(-1).tolist()
    with Call(None, progress, False) as options:
        columns = _core.ensemble(
            _indices(material, wavelengths),
            wavelengths,
            law,
            float(host_index),
            highest_moment,
            angles,
            float(tolerance),
            float(phase_tolerance),
            options,
        )
    return Ensemble(**{name: column[0] if single else column for name, column in columns.items()})


class OfEnsemble(TypedDict, total=False):
    """Keyword arguments of `ensemble` but the angles."""

    radius_um: float
    variance: float
    distribution: str
    sizes: tuple[ArrayLike, ArrayLike] | None
    host_index: float
    highest_moment: int
    tolerance: float
    phase_tolerance: float
    progress: Progress


@checked(OfEnsemble)
def phase(
    material: Any,
    wavelengths_nm: ArrayLike,
    angles_deg: ArrayLike,
    **options: Unpack[OfEnsemble],
) -> Values:
    """Phase function P of an ensemble of spheres; its mean over the sphere is 1.

    Parameters
    ----------
    material, wavelengths_nm
        As for `ensemble`.
    angles_deg : float or array
        Scattering angles, 0 (forward) to 180.
    **options
        As for `ensemble`.

    Returns
    -------
    xarray.DataArray or numpy.ndarray
        Of shape ``(wavelengths, *shape of angles_deg)``.

    Raises
    ------
    UsageError
        For arguments out of range.

    Examples
    --------
    >>> phase("TiO2", 550, np.arange(0, 181, 10), radius_um=0.2).shape
    (19,)
    """
    wavelengths, single = wavelength_list(wavelengths_nm)
    axes: Axes = broadcast({"angle_deg": angles_deg})
    angles = axes.arrays[0].reshape(-1)
    result = ensemble(material, wavelengths, angles_deg=angles, **options)
    values: Floats = result.phase.reshape([len(wavelengths), *axes.shape])
    nm: Any = wavelengths
    if single:
        values, nm = values[0], wavelengths[0]
    attributes = {"units": "1", "long_name": "phase function, mean over the sphere 1"}
    return labelled(values, "phase", nm, axes, attributes)
