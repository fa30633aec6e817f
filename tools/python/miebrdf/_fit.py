"""From measurements to a scene: unknown numbers by least squares."""

from __future__ import annotations

import html
import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from ._options import Call, Progress
from .errors import Error, InputError, UsageError


class Fit:
    """What a fit found; `miebrdf.fit` makes one.

    Attributes
    ----------
    values : dict of str to list or array
        Columns with an entry for each fitted number: ``unknown``, ``wavelength_nm`` (NaN where
        wavelengths share it), ``value``, ``standard_error`` (NaN: at a bound, or not determined),
        ``interval_low`` and ``interval_high`` (95 %), ``start``, ``low``, ``high``, ``at_bound``,
        ``note``.
    residuals : dict of str to list or array
        Columns with an entry for each measured value, the model's beside it.
    chi_squared, degrees_of_freedom : float, int
        Without sigmas the sum of squared residuals.
    correlation : array
        Of all pairs of fitted numbers; NaN where one is at a bound.
    undetermined : list of str
        Directions that the data leave open, in words.
    notes : list of str
        What else should be known: a scene that misses the data, values out of reach.
    minima : list of dict
        Of several starts: ``chi_squared``, ``starts`` and ``values``, the best first.
    converged, reason : bool, str
        Whether a minimum was found, and why not.
    interrupted : bool
        Ctrl-C ended the search: the values are the best so far.
    interpolation_shift : float or None
        By so many of their standard errors averages over sizes of their own would move the numbers,
        at most; None: no sizes are interpolated.
    scene_file : str
        The fitted scene, for `miebrdf run`.

    Examples
    --------
    >>> found = miebrdf.fit("FIT.toml")  # doctest: +SKIP
    >>> found["w"], found.standard_error("w"), found.undetermined  # doctest: +SKIP
    """

    values: dict[str, Any]
    residuals: dict[str, Any]
    chi_squared: float
    degrees_of_freedom: int
    sigma_known: bool
    correlation: Any
    undetermined: list[str]
    notes: list[str]
    minima: list[dict[str, Any]]
    converged: bool
    interrupted: bool
    reason: str
    iterations: int
    solved_scenes: int
    interpolation_shift: float | None
    scene_file: str

    def __init__(self, facts: Mapping[str, Any]) -> None:
        self.__dict__.update(facts)

    def __getitem__(self, unknown: str) -> Any:
        """The value of an unknown; an array over wavelengths where it differs between them."""
        return self._column("value", unknown)

    def standard_error(self, unknown: str) -> Any:
        """The standard error of an unknown, shaped as its value.

        Parameters
        ----------
        unknown : str
            A name of the problem.

        Returns
        -------
        float or numpy.ndarray
            In the unit of the value; NaN: at a bound, or not determined.

        Raises
        ------
        UsageError
            For a name that the fit does not have.

        Examples
        --------
        >>> found = miebrdf.fit("FIT.toml")  # doctest: +SKIP
        >>> found.standard_error("w")  # doctest: +SKIP
        """
        return self._column("standard_error", unknown)

    def interval(self, unknown: str) -> tuple[Any, Any]:
        """The ends of its 95 % interval.

        Parameters
        ----------
        unknown : str
            A name of the problem.

        Returns
        -------
        (low, high)
            Of floats or arrays, in the unit of the value.

        Raises
        ------
        UsageError
            For a name that the fit does not have.

        Examples
        --------
        >>> found = miebrdf.fit("FIT.toml")  # doctest: +SKIP
        >>> low, high = found.interval("w")  # doctest: +SKIP
        """
        return self._column("interval_low", unknown), self._column("interval_high", unknown)

    def _column(self, name: str, unknown: str) -> Any:
        rows = [i for i, one in enumerate(self.values["unknown"]) if one == unknown]
        if not rows:
            known = ", ".join(dict.fromkeys(self.values["unknown"]))
            raise UsageError(f"there is no unknown '{unknown}'; the fit has: {known}")
        column = np.asarray(self.values[name])[rows]
        shared = math.isnan(self.values["wavelength_nm"][rows[0]])
        return float(column[0]) if shared else column

    def _rows(self) -> list[tuple[str, str, str, str]]:
        rows = []
        for i, name in enumerate(self.values["unknown"]):
            nm = self.values["wavelength_nm"][i]
            error = self.values["standard_error"][i]
            rows.append((
                name if math.isnan(nm) else f"{name}, {nm:g} nm",
                _rounded(self.values["value"][i], error),
                "" if math.isnan(error) else _rounded(error, error),
                self.values["note"][i],
            ))  # fmt: skip
        return rows

    def _summary(self) -> list[str]:
        what = "chi squared" if self.sigma_known else "sum of squares"
        lines = [f"{what} {self.chi_squared:.5g}, {self.degrees_of_freedom} degrees of freedom"]
        if not self.converged:
            lines.append(f"not converged: {self.reason}")
        return lines + self._tied() + self.undetermined + self.notes

    def _tied(self) -> list[str]:
        """Pairs of numbers shared by all wavelengths that hardly tell themselves apart."""
        names = self.values["unknown"]
        shared = [i for i, nm in enumerate(self.values["wavelength_nm"]) if math.isnan(nm)]
        return [
            f"{names[i]} and {names[j]} move together: correlation {self.correlation[i][j]:.3f}"
            for i in shared
            for j in shared
            if i < j and abs(self.correlation[i][j]) > 0.9
        ][:6]

    def __repr__(self) -> str:
        rows = [f"  {name} = {value} +- {error or '?'}  {note}"
                for name, value, error, note in self._rows()]  # fmt: skip
        return "\n".join(["<miebrdf.Fit>", *rows, *(f"  {line}" for line in self._summary())])

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}</th>" for name in ("unknown", "value", "standard error", ""))
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>"
            for row in self._rows()
        )
        lines = "".join(f"<p>{html.escape(line)}</p>" for line in self._summary())
        return f"<table><tr>{head}</tr>{body}</table>{lines}"


def _rounded(value: float, error: float) -> str:
    """To the second digit of the error; six digits where there is none."""
    if not (error > 0.0 and value != 0.0):
        return f"{value:.6g}"
    decimals = max(1 - math.floor(math.log10(error)), -math.floor(math.log10(abs(value))))
    if abs(value) >= 1e-3:
        return f"{round(value, decimals):.{max(decimals, 0)}f}"
    digits = math.floor(math.log10(abs(value))) + decimals + 1
    return f"{value:#.{max(digits, 2)}g}"


def fit(
    problem: str | os.PathLike[str] | Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] = "",
    starts: int = 0,
    threads: int | None = None,
    progress: Progress = None,
) -> Fit:
    """Find unknown numbers of a scene from measured values.

    Parameters
    ----------
    problem : path or dict
        A fit file, or its content as a dict: ``scene``, ``unknowns``, ``measured`` (a list of
        dicts, with ``file`` or with ``values`` and ``wavelength_nm``), perhaps ``fit``. The words
        are those of fit files (docs/fitting.md); arrays of NumPy may stand for lists.
    folder : path, optional
        Where the files of a dict are; of a fit file it is its own folder.
    starts : int
        Search from this many starts within the bounds; 0: as the problem says, else 6
        where no unknown changes spheres, and 1 where one does.
    threads, progress
        As of every long call (`set_options`).

    Returns
    -------
    Fit
        After Ctrl-C too, with the best so far: read ``converged`` or ``interrupted``.

    Raises
    ------
    UsageError, InputError
        For a problem that cannot be solved as it stands, with what would help.

    Examples
    --------
    >>> found = miebrdf.fit({
    ...     "scene": {"base": "hg:{w},0.8"},
    ...     "unknowns": {"w": "0.9 in 0.1:0.9999 log1m"},
    ...     "measured": [{"values": [0.42, 0.45], "wavelength_nm": [500, 510],
    ...                   "quantity": "spherical_albedo", "sigma": 0.01}]})
    >>> found["w"], found.standard_error("w")
    """
    with _placed(problem, folder, "fit file") as (text, where, name), Call(
        threads, progress
    ) as options:
        return Fit(_core.fit(text, where, name, starts, options))


class Match:
    """The recipes for a colour; `miebrdf.match` makes one.

    Attributes
    ----------
    recipes : list of dict
        The best first, then those that do without one component (``left_out``). Each has ``parts``
        (dicts of ``name``, ``value``, ``grams`` in the batch, or to add, ``weight_share`` and
        ``volume_share`` in [0, 1], ``delta_e_per_tenth_gram``, ``cost``, ``at_bound``), ``colours``
        (dicts of ``target``, ``light``, ``lab``, ``wanted``, ``delta_e_2000``), ``delta_e_2000``
        (largest under the first light), ``delta_e_second`` (largest under any other, or None),
        ``contrast_ratio``, ``cost`` and ``file``, a match file that begins with this recipe.
    reached : bool
        Whether the best recipe has a CIEDE2000 of 1 or less.
    notes : list of str
        What limits it; out of reach the nearest colour, and a pigment that is missing.
    solved_scenes : int
        How many.

    Examples
    --------
    >>> found = miebrdf.match("MATCH.toml")  # doctest: +SKIP
    >>> found.recipes[0]["parts"][0]["grams"], found.reached  # doctest: +SKIP
    """

    recipes: list[dict[str, Any]]
    reached: bool
    notes: list[str]
    solved_scenes: int

    def __init__(self, facts: Mapping[str, Any]) -> None:
        self.__dict__.update(facts)

    def __repr__(self) -> str:
        best = self.recipes[0]
        parts = [
            f"  {part['name']}: "
            + (f"{part['value']:.4g}" if part["grams"] is None else f"{part['grams']:.2f} g")
            for part in best["parts"]
        ]
        last = f"  dE2000 {best['delta_e_2000']:.2f}"
        return "\n".join(["<miebrdf.Match>", *parts, last, *(f"  {note}" for note in self.notes)])


def match(
    problem: str | os.PathLike[str] | Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] = "",
    measured: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    threads: int | None = None,
    progress: Progress = None,
) -> Match:
    """Find the amounts of pigments that give a wanted colour.

    Parameters
    ----------
    problem : path or dict
        A match file, or its content as a dict: ``scene``, ``unknowns``, ``target`` (a list of
        dicts), perhaps ``batch``, ``cost``, ``limits`` (docs/recipes.md).
    folder : path, optional
        Where the files of a dict are; of a match file it is its own folder.
    measured : path or list of paths, optional
        A correction: what was measured of the batch that the starts of the unknowns have made.
    threads, progress
        As of every long call (`set_options`).

    Returns
    -------
    Match
        Also for a colour that is out of reach: read ``reached`` and ``notes``.

    Raises
    ------
    UsageError, InputError
        For a problem that cannot be solved as it stands, with what would help.

    Examples
    --------
    >>> found = miebrdf.match({
    ...     "scene": {"base": "paste:oil_cobalt_blue,mass={blue} + paste:oil_zinc_white",
    ...               "host-index": "1.5", "boundary": "smooth", "stokes": 1},
    ...     "unknowns": {"blue": "0.05 in 0:0.5"},
    ...     "target": [{"lab": [72, -7, -28], "light": "d65,10"}]})
    >>> found.recipes[0]["delta_e_2000"], found.reached
    """
    files = [measured] if isinstance(measured, str | os.PathLike) else list(measured)
    with _placed(problem, folder, "match file") as (text, where, name), Call(
        threads, progress
    ) as options:
        return Match(_core.match(text, where, name, [os.fspath(f) for f in files], options))


@contextmanager
def _placed(
    problem: str | os.PathLike[str] | Mapping[str, Any], folder: str | os.PathLike[str], kind: str
) -> Iterator[tuple[str, str, str]]:
    """Text, folder and name of a problem; mistakes in a dict have no lines."""
    if isinstance(problem, Mapping):
        text, name, where = _toml(problem), "problem", os.fspath(folder)
    else:
        path = Path(problem)
        try:
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise InputError(f"{kind} '{path}' cannot be read: {error.strerror}") from None
        name, where = str(path), str(path.parent)
    try:
        yield text, where, name
    except Error as error:
        if isinstance(problem, Mapping):
            place = rf"{kind} 'problem', line \d+, column \d+: "
            said = re.sub(place, "", str(error)).replace(f"{kind} 'problem'", "problem")
            error.args = (said,)
        raise


def _toml(problem: Mapping[str, Any]) -> str:
    """The problem as the text of a fit file."""
    lines = []
    for key, value in problem.items():
        if key in ("measured", "target"):
            continue
        if isinstance(value, Mapping):
            lines += [f"[{key}]", *(f"{_key(k)} = {_value(v)}" for k, v in value.items())]
        else:
            lines.insert(0, f"{_key(key)} = {_value(value)}")
    for key in ("measured", "target"):
        for data in problem.get(key, []):
            lines += [f"[[{key}]]", *(f"{_key(k)} = {_value(v)}" for k, v in data.items())]
    return "\n".join(lines)


def _key(key: str) -> str:
    return json.dumps(str(key))


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, str | bool):
        return json.dumps(value)
    if isinstance(value, os.PathLike):
        return json.dumps(os.fspath(value))
    if np.ndim(value) > 0 or isinstance(value, list | tuple):
        return "[" + ", ".join(_value(one) for one in value) + "]"
    number = float(value)
    if math.isnan(number) or math.isinf(number):
        return str(number)  # as TOML writes them
    return repr(number)
