# The compiled module; private. Units and ranges are those of the public C++ headers.
from collections.abc import Callable, Sequence
from enum import Enum
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

version: str
processor_path: str

_Floats: TypeAlias = NDArray[np.float64]
_Complexes: TypeAlias = NDArray[np.complex128]
_Path: TypeAlias = str | Path
_Facts: TypeAlias = list[dict[str, Any]]

def set_forked() -> None: ...

class CallOptions:
    def __init__(
        self,
        threads: int = 0,
        progress: Callable[[str, int, int], Any] | None = None,
        cache: bool = False,
    ) -> None: ...

# materials
class Interpolation(Enum):
    pchip = ...
    linear = ...
    linear_energy = ...

class IndexOptions:
    def __init__(
        self,
        interpolation: Interpolation = ...,
        clamp: bool = False,
        missing_k_is_zero: bool = False,
    ) -> None: ...

class RefractiveIndex:
    def at(self, wavelength_nm: Sequence[float]) -> _Complexes: ...
    def table(self) -> tuple[_Floats, _Floats, _Floats | None]: ...
    @property
    def shortest_nm(self) -> float: ...
    @property
    def longest_nm(self) -> float: ...
    @property
    def k_known(self) -> bool: ...

class Database:
    @staticmethod
    def embedded() -> Database: ...
    @staticmethod
    def layered(user_file: _Path) -> Database: ...
    def list(self) -> _Facts: ...
    def search(
        self, text: str, covers: tuple[float, float] | None, needs_k: bool
    ) -> _Facts: ...
    def info(self, name: str) -> dict[str, Any]: ...
    def datasets(self, name: str) -> _Facts: ...
    def dataset_info(self, name: str) -> dict[str, Any]: ...
    def refractive_index(self, name: str, options: IndexOptions = ...) -> RefractiveIndex: ...

def default_user_database() -> Path: ...
def add_material(
    database: _Path,
    name: str,
    label: str,
    wavelength_nm: Sequence[float],
    n: Sequence[float],
    k: Sequence[float] | None,
    facts: dict[str, Any],
    replace: bool,
) -> str: ...
def import_files(
    database: _Path,
    files: Sequence[_Path],
    format: str,
    material: str,
    label: str,
    replace: bool,
) -> list[dict[str, Any]]: ...
def remove_material(database: _Path, name: str) -> bool: ...

# mie
class SizeDistribution:
    def __init__(
        self,
        law: str = "power-law",
        radius_um: float = 50.0,
        variance: float = 0.2,
        radii_um: Sequence[float] = ...,
        number_density: Sequence[float] = ...,
    ) -> None: ...
    def radius_range(self) -> tuple[float, float]: ...

def size_distributions() -> dict[str, str]: ...
def spheres(
    index: Sequence[complex], size_parameter: Sequence[float], options: CallOptions
) -> dict[str, Any]: ...
def amplitudes(
    index: complex, size_parameter: float, angles_deg: Sequence[float], options: CallOptions
) -> tuple[_Complexes, _Complexes]: ...
def coefficients(index: complex, size_parameter: float) -> tuple[_Complexes, _Complexes]: ...
def ensemble(
    index: Sequence[complex],
    wavelength_nm: Sequence[float],
    sizes: SizeDistribution,
    host_index: float,
    highest_moment: int,
    angles_deg: Sequence[float],
    tolerance: float,
    phase_tolerance: float,
    options: CallOptions,
) -> dict[str, Any]: ...

# many layers
def layer_albedos(
    single_scattering_albedo: _Floats,
    asymmetry: _Floats,
    optical_depth: _Floats,
    host_index: _Floats,
    ground_albedo: _Floats,
    mu_in: _Floats,
    solver: SolverOptions,
    options: CallOptions,
) -> dict[str, Any]: ...

def subsurface_colour(
    single_scattering_albedo: _Floats,
    asymmetry: _Floats,
    host_index: _Floats,
    solver: SolverOptions,
    options: CallOptions,
) -> _Floats: ...
def subsurface_albedo(
    colour: _Floats,
    asymmetry: _Floats,
    host_index: _Floats,
    solver: SolverOptions,
    options: CallOptions,
) -> _Floats: ...

# scenes
class Medium:
    """What a layer is made of; `miebrdf.medium` makes one. ``a + b`` is a mixture.

    Examples
    --------
    >>> Medium("TiO2,volume=10%") + Medium("SiO2,volume=1%")
    """

    def __init__(self, words: str) -> None: ...
    @staticmethod
    def of_table(
        name: str, wavelength_nm: Sequence[float], index: Sequence[complex]
    ) -> Medium: ...
    def __len__(self) -> int: ...
    def __add__(self, other: Medium) -> Medium: ...
    @property
    def needs_mie(self) -> bool: ...
    @property
    def particles(self) -> list[tuple[str, float | None, float | None, str | None]]: ...
    def with_sizes(
        self,
        radius_um: float | None,
        variance: float | None,
        law: str | None,
        density_g_cm3: float | None,
        layer_density_kg_m3: float | None,
    ) -> Medium: ...
    def with_amount(self, kind: str, value: float) -> Medium: ...
    def in_host(self, words: str) -> Medium: ...

class Depth:
    """How deep a layer is: words as in `miebrdf.coat`, or an optical depth >= 0.

    Examples
    --------
    >>> Depth("40um"), Depth(0.1), Depth.grey(0.1)
    """

    def __init__(self, words: str | float) -> None: ...
    @staticmethod
    def grey(optical_depth: float) -> Depth: ...
    @staticmethod
    def thickness_um(value: float) -> Depth: ...

class Layer:
    """A medium of some depth; `miebrdf.coat` makes one.

    Examples
    --------
    >>> Layer("hg:0.9,0.4@0.1[grey]").medium
    """

    def __init__(self, medium: str | Medium, depth: Depth = ...) -> None: ...
    @property
    def medium(self) -> Medium: ...
    @property
    def depth(self) -> Depth: ...

class Substrate:
    """What lies below the layers where there is no base.

    Words as in `miebrdf.Scene`, or `miebrdf.lambertian`.

    Examples
    --------
    >>> Substrate("lambert:0.05"), Substrate("mirror:Au")
    """

    def __init__(
        self, albedo: str | Sequence[float], wavelength_nm: Sequence[float] = ...
    ) -> None: ...

class MicrofacetDistribution(Enum):
    beckmann = ...
    ggx = ...

class Shadowing(Enum):
    smith_correlated = ...
    smith_separable = ...
    v_cavity = ...

class Fresnel(Enum):
    exact = ...
    schlick = ...

class Coupling(Enum):
    paper = ...
    reciprocal = ...

class Packing(Enum):
    independent = ...
    percus_yevick = ...
    effective_host = ...
    percus_yevick_effective_host = ...

class SurfaceOptions:
    def __init__(
        self,
        alpha: float,
        distribution: MicrofacetDistribution,
        shadowing: Shadowing,
        fresnel: Fresnel,
    ) -> None: ...

class Scene:
    coupling: Coupling | None
    surface_index: complex | None
    database: str
    index: IndexOptions
    def __init__(
        self,
        base: Medium | None,
        substrate: Substrate | None,
        layers: Sequence[Layer],
        surface: SurfaceOptions | None,
    ) -> None: ...
    @property
    def numbers(self) -> dict[str, float]: ...
    def say(self, word: str, values: Sequence[str]) -> None: ...
    def set_boundary(self, words: str) -> None: ...
    def set_particles(
        self,
        sizes: SizeDistribution,
        host: str,
        k_floor: float,
        tolerance: float,
        layer_density_kg_m3: float | None,
        packing: Packing,
    ) -> None: ...
    def validate(self) -> None: ...

def media() -> list[tuple[str, str, str]]: ...

# solved scenes
class Grid(Enum):
    auto = ...
    gauss = ...
    mapped_gauss = ...
    paper = ...

class HalfSpaceMethod(Enum):
    auto = ...
    fixed_point = ...
    doubling = ...

class CoatMethod(Enum):
    auto = ...
    first_order = ...
    first_order_patched = ...
    exponential = ...

class SolverOptions:
    tolerance: float
    grid: Grid
    streams: int
    stokes: int
    half_space_method: HalfSpaceMethod
    coat_method: CoatMethod
    coat_substeps: int
    delta_m: bool
    single_scattering_correction: bool

class SolvedScene:
    def __init__(
        self, scene: Scene, wavelength_nm: Sequence[float], solver: SolverOptions
    ) -> None: ...
    def evaluate(
        self,
        mu_in: Sequence[float],
        mu_out: Sequence[float],
        azimuth_deg: Sequence[float],
        part: str,
        options: CallOptions,
    ) -> tuple[_Floats, dict[str, Any]]: ...
    def mueller(
        self,
        mu_in: Sequence[float],
        mu_out: Sequence[float],
        azimuth_deg: Sequence[float],
        options: CallOptions,
    ) -> tuple[_Floats, dict[str, Any]]: ...
    def albedo(
        self, mu_in: Sequence[float], options: CallOptions
    ) -> tuple[dict[str, Any], dict[str, Any]]: ...
    def gloss(self, viewed: str, options: CallOptions) -> tuple[_Floats, dict[str, Any]]: ...
    def evaluate_derivatives(
        self,
        parameters: Sequence[str],
        mu_in: Sequence[float],
        mu_out: Sequence[float],
        azimuth_deg: Sequence[float],
        part: str,
        options: CallOptions,
    ) -> tuple[_Floats, dict[str, Any]]: ...
    def hdrf(
        self,
        parameters: Sequence[str],
        mu_in: Sequence[float],
        mu_out: Sequence[float],
        azimuth_deg: Sequence[float],
        diffuse_fraction: float,
        sky: str,
        options: CallOptions,
    ) -> tuple[_Floats, dict[str, Any]]: ...
    def albedo_derivatives(
        self, parameters: Sequence[str], mu_in: Sequence[float], options: CallOptions
    ) -> tuple[list[dict[str, Any]], dict[str, Any]]: ...
    def layers(self, options: CallOptions) -> list[Any]: ...
    def table(
        self, part: str, options: CallOptions, whole_matrix: bool = False, command: str = ""
    ) -> SolvedTable: ...
    def plan(
        self,
        mu_in: Sequence[float],
        mu_out: Sequence[float],
        azimuth_deg: Sequence[float],
    ) -> tuple[list[tuple[str, str, int, float]], list[tuple[str, str, float]]]: ...

class SolvedTable:
    def evaluate(
        self,
        mu_in: _Floats,
        mu_out: _Floats,
        azimuth_deg: _Floats,
        out: _Floats,
        options: CallOptions,
    ) -> None: ...
    def sampler(self, weights: Sequence[float], options: CallOptions) -> DirectionSampler: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def version(self) -> str: ...

class DirectionSampler:
    def sample(
        self, mu_in: _Floats, u1: _Floats, u2: _Floats
    ) -> tuple[_Floats, _Floats, _Floats]: ...
    def density(self, mu_in: _Floats, mu_out: _Floats, azimuth_deg: _Floats) -> _Floats: ...

# files and colours
class Directions:
    def __init__(
        self,
        mu_in: Sequence[float] = ...,
        mu_out: Sequence[float] = ...,
        azimuth_deg: Sequence[float] = ...,
    ) -> None: ...

def formats() -> list[dict[str, Any]]: ...
def export_table(
    table: SolvedTable,
    path: _Path,
    format: str,
    resolution: int,
    directions: Directions,
    rgb: str,
    largest_error: float,
    accept_error: bool,
    extra: dict[str, int],
    options: CallOptions,
) -> list[Any]: ...
def export_function(
    function: Callable[[_Floats, _Floats, _Floats], _Floats],
    wavelength_nm: Sequence[float],
    title: str,
    command: str,
    path: _Path,
    format: str,
    resolution: int,
    directions: Directions,
    rgb: str,
    largest_error: float,
    accept_error: bool,
    extra: dict[str, int],
    options: CallOptions,
) -> list[Any]: ...

class BrdfFile:
    def __init__(self, path: str) -> None: ...
    @property
    def format(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def channels(self) -> list[str]: ...
    @property
    def wavelengths_nm(self) -> list[float]: ...
    def evaluate(self, mu_in: _Floats, mu_out: _Floats, azimuth_deg: _Floats) -> _Floats: ...

def check(path: str) -> dict[str, Any]: ...
def sphere_reading(
    sphere: dict[str, float],
    other: dict[str, float],
    transmitted: bool,
    light: Sequence[Sequence[float]],
) -> list[float]: ...
def common_word(text: str) -> dict[str, Any] | None: ...
def read_measured(
    path: str,
    format: str,
    column: str,
    quantity: str,
    percent: bool | None,
    numbers: dict[str, float],
    azimuth_zero: str,
    wavelengths: str,
) -> dict[str, Any]: ...

def colours(wavelength_nm: Sequence[float], reflectance: _Floats, viewed: str) -> _Floats: ...
def colour_derivatives(
    wavelength_nm: Sequence[float], reflectance: _Floats, slope: _Floats, viewed: str
) -> _Floats: ...
def delta_e_76(
    l1: _Floats, a1: _Floats, b1: _Floats, l2: _Floats, a2: _Floats, b2: _Floats
) -> _Floats: ...
def delta_e_2000(
    l1: _Floats, a1: _Floats, b1: _Floats, l2: _Floats, a2: _Floats, b2: _Floats
) -> _Floats: ...
def covers_the_visible(wavelength_nm: Sequence[float]) -> bool: ...

# tables of sweeps
def has_netcdf() -> bool: ...
def look_up_table(
    file: str, variables: Sequence[str], asked: dict[str, str], interpolation: str
) -> list[dict[str, Any]]: ...

# fits
def has_fit() -> bool: ...
def fit(
    text: str, folder: str, name: str, starts: int, options: CallOptions
) -> dict[str, Any]: ...
def match(
    text: str, folder: str, name: str, measured: Sequence[str], options: CallOptions
) -> dict[str, Any]: ...
