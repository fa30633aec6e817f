"""From a material's complex refractive index to its spectral BRDF.

`Scene` says what lies on what; `Scene.brdf` computes values, `Scene.solve` gives an object to be
asked at millions of directions. `materials` is the database of optical constants; `sphere`,
`ensemble` and `phase` are Mie theory alone; `colour` makes colours of spectra.

Examples
--------
>>> import miebrdf
>>> scene = miebrdf.Scene(base="TiO2", coats=[miebrdf.coat("Au", depth=0.5, radius_um=0.03)])
>>> scene.brdf([450, 550, 650], mu_in=0.5, mu_out=[0.3, 0.9])
>>> b = scene.solve([450, 550, 650])
>>> b(0.5, 0.9, azimuth_deg=180.0)
"""

from . import _install

_install.check()

from . import colour, errors  # noqa: E402
from ._brdf import Brdf  # noqa: E402
from ._core import Depth, Layer, Medium, Substrate, processor_path  # noqa: E402
from ._derivatives import Derivatives  # noqa: E402
from ._directions import Report  # noqa: E402
from ._files import BrdfFile, FileCheck, check, export, formats  # noqa: E402
from ._fit import Fit, Match, fit, match  # noqa: E402
from ._layers import (  # noqa: E402
    LayerAlbedos,
    layer_albedos,
    subsurface_albedo,
    subsurface_colour,
)
from ._materials import Material, Materials, materials  # noqa: E402
from ._measured import Measurements, read_measured  # noqa: E402
from ._media import coat, lambertian, media_forms, medium  # noqa: E402
from ._mie import Ensemble, Sphere, amplitudes, coefficients, ensemble, phase, sphere  # noqa: E402
from ._options import set_options  # noqa: E402
from ._scene import Scene  # noqa: E402
from ._studio import Studio, studio  # noqa: E402
from ._tables import LookedUp, lookup  # noqa: E402
from ._version import __version__  # noqa: E402
from .errors import (  # noqa: E402
    Cancelled,
    DatabaseError,
    Error,
    InputError,
    MaterialFileError,
    MissingPackage,
    NotConverged,
    TooCoarse,
    UnknownMaterial,
    UsageError,
)

__all__ = [
    "Brdf",
    "BrdfFile",
    "Cancelled",
    "DatabaseError",
    "Depth",
    "Derivatives",
    "Ensemble",
    "Error",
    "FileCheck",
    "Fit",
    "InputError",
    "Layer",
    "LayerAlbedos",
    "LookedUp",
    "Match",
    "Material",
    "MaterialFileError",
    "Materials",
    "Measurements",
    "Medium",
    "MissingPackage",
    "NotConverged",
    "Report",
    "Scene",
    "Sphere",
    "Studio",
    "Substrate",
    "TooCoarse",
    "UnknownMaterial",
    "UsageError",
    "__version__",
    "amplitudes",
    "check",
    "coat",
    "coefficients",
    "colour",
    "ensemble",
    "errors",
    "export",
    "fit",
    "formats",
    "lambertian",
    "layer_albedos",
    "lookup",
    "match",
    "materials",
    "media_forms",
    "medium",
    "phase",
    "processor_path",
    "read_measured",
    "set_options",
    "sphere",
    "studio",
    "subsurface_albedo",
    "subsurface_colour",
]
