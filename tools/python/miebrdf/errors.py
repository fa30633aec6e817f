"""What can go wrong. Every exception that this package raises on its own account is an `Error`.

The texts are those of the program and the C++ library. Where one value was at fault, ``field``,
``value`` and ``allowed`` name it and say what would have been right; otherwise they are empty.
"""

from __future__ import annotations

__all__ = [
    "Cancelled",
    "DatabaseError",
    "Error",
    "InputError",
    "MaterialFileError",
    "MissingPackage",
    "NotConverged",
    "TooCoarse",
    "UnknownMaterial",
    "UsageError",
]


class Error(Exception):
    """Base of all exceptions of this package.

    Attributes
    ----------
    field : str
        Name of what was wrong, e.g. ``"mu_in"``; may be empty.
    value : str
        The value that was given.
    allowed : str
        What would have been allowed.
    """

    field: str = ""
    value: str = ""
    allowed: str = ""


class UsageError(Error, ValueError):
    """The request itself is wrong: an unknown word, a number out of range, shapes that do not fit."""


class InputError(Error):
    """Data that the request points to is missing, damaged, or does not cover it."""


class UnknownMaterial(InputError, KeyError):
    """No material has the name, or several do.

    Attributes
    ----------
    name : str
        As it was asked for.
    candidates : list of str
        Names that would have been known, the nearest first.
    """

    name: str = ""
    candidates: list[str] = []

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""  # KeyError shows the repr


class DatabaseError(InputError):
    """The materials file is no database of ours, damaged, locked, or cannot be written."""


class MaterialFileError(InputError):
    """A file of optical constants that cannot be read or accepted.

    Attributes
    ----------
    line : int
        Counted from 1; 0 when the reason concerns the whole file.
    reason : str
    """

    line: int = 0
    reason: str = ""


class TooCoarse(Error):
    """An exported file would be further from the BRDF than accepted. Nothing was written."""


class Cancelled(Error):
    """A computation was stopped on request; nothing was half-written."""


class MissingPackage(Error, ImportError):
    """An optional package (matplotlib, xarray, ...) is needed for this and not installed."""


class NotConverged(UserWarning):
    """The estimated error of a result is above its tolerance; the text says where."""
