"""Files of other programs: what formats there are, and the physics of a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _core
from .errors import UsageError


@dataclass(frozen=True)
class FileCheck:
    """Physics of a BRDF file, as the program that reads it will see it.

    Attributes
    ----------
    reciprocity_rms : float or None
        Of ``|f(i, o) - f(o, i)|`` over the mean of both; None where no pair is listed both ways.
    largest_albedo : float or None
        Over all channels and incidences.
    largest_albedo_error, largest_albedo_mu : float
    largest_albedo_channel : str
    least_value : float
        Of the BRDF, 1/sr.
    missing, directions : int
        Directions without a value, and those that were looked at.
    sampled_albedo_error : float or None
        Of albedos by the file's own importance sampling.
    """

    reciprocity_rms: float | None
    largest_albedo: float | None
    largest_albedo_error: float
    largest_albedo_mu: float
    largest_albedo_channel: str
    least_value: float
    missing: int
    directions: int
    sampled_albedo_error: float | None


def check(path: str | Path) -> FileCheck:
    """Reciprocity, albedo and least value of a BRDF file in any format that is known.

    Raises
    ------
    InputError
        For an unknown, damaged or truncated file.
    """
    return FileCheck(**_core.check(str(path)))


def formats() -> list[dict[str, Any]]:
    """Formats of `Brdf.export`: name, readers (programs), holds, endings, options."""
    return [
        {key: value for key, value in each.items() if key not in ("brdf", "whole_matrix")}
        for each in _core.formats()
        if each["brdf"]
    ]


def needs_whole_matrix(format: str) -> bool:
    """Whether a format of `Brdf.export` holds Mueller matrices."""
    return any(each["name"] == format and each["whole_matrix"] for each in _core.formats())


def format_of(path: Path) -> str:
    """The format of `Brdf.export` that the ending of a file says."""
    known = [each for each in _core.formats() if each["brdf"]]
    fitting = [each["name"] for each in known if path.suffix in each["endings"]]
    if path.suffix == ".bsdf":
        return "rgl"
    if len(fitting) != 1:
        names = ", ".join(fitting or [each["name"] for each in known])
        raise UsageError(f"format: '{path.name}' does not say which; allowed: {names}")
    return str(fitting[0])
