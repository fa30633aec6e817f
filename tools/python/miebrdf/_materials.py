"""The materials database."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Values, labelled, numbers, wavelength_list
from ._keywords import checked
from .errors import UsageError


class OfTable(TypedDict, total=False):
    """What `Materials.add` is told of a table beside its figures."""

    title: str
    formula: str
    source: str
    reference: str
    note: str
    density_g_cm3: float


class Material:
    """n + ik of one material, with its source.

    Made by ``miebrdf.materials["TiO2"]``. Between the rows of its table n and k are interpolated
    monotonically in photon energy; dispersion formulas are evaluated exactly.

    Attributes
    ----------
    name, title, formula, source, reference, note : str
    shortest_nm, longest_nm : float
        Where n + ik is known.
    k_known : bool
        False: k was not measured, and counts as 0.
    density_g_cm3 : float or None

    Examples
    --------
    >>> gold = miebrdf.materials["Au"]
    >>> gold.title, gold.shortest_nm, gold.nk(550)
    """

    name: str
    title: str
    formula: str
    source: str
    reference: str
    note: str
    k_known: bool
    density_g_cm3: float | None

    def __init__(self, name: str, facts: dict[str, Any], index: _core.RefractiveIndex) -> None:
        self._asked = name
        self._index = index
        self.facts = facts
        for key in ("title", "formula", "source", "reference", "note", "density_g_cm3"):
            setattr(self, key, facts.get(key, ""))
        self.name = facts.get("name") or name
        self.shortest_nm = index.shortest_nm
        self.longest_nm = index.longest_nm
        self.k_known = index.k_known

    def nk(self, wavelengths_nm: ArrayLike) -> Values:
        """n + ik.

        Parameters
        ----------
        wavelengths_nm : float or array of one dimension
            In vacuum, within shortest_nm ... longest_nm.

        Returns
        -------
        xarray.DataArray or numpy.ndarray
            Complex, of the shape of `wavelengths_nm`.

        Raises
        ------
        InputError
            Outside the data, with the valid range.

        Examples
        --------
        >>> miebrdf.materials["TiO2"].nk([450, 550])
        """
        wavelengths, single = wavelength_list(wavelengths_nm)
        values: Any = self._index.at(wavelengths)
        nm: Any = wavelengths
        if single:
            values, nm = values[0], wavelengths[0]
        attributes = {"units": "1", "material": self.name, "source": self.source}
        return labelled(values, "refractive_index", nm, None, attributes)

    def table(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64] | None]:
        """Native wavelengths in nm, n and k (None where it is unknown); never resampled.

        Returns
        -------
        wavelengths_nm, n, k : numpy.ndarray

        Examples
        --------
        >>> nm, n, k = miebrdf.materials["TiO2"].table()
        """
        return self._index.table()

    def plot(self, ax: Any = None) -> Any:
        """Draw n and k over the wavelength (needs matplotlib).

        Parameters
        ----------
        ax : matplotlib axes, optional

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        MissingPackage
            Without matplotlib.

        Examples
        --------
        >>> miebrdf.materials["TiO2"].plot()  # doctest: +SKIP
        """
        from ._plots import plot_nk

        return plot_nk(self, ax)

    def __repr__(self) -> str:
        return (
            f"<miebrdf.Material {self.name}: {self.title}, {self.shortest_nm:g} to "
            f"{self.longest_nm:g} nm, {self.source}>"
        )

    def __reduce__(self) -> Any:
        return materials.__getitem__, (self._asked,)


class Materials:
    """The database of optical constants: the built-in tables, and the user's file over them.

    ``materials["TiO2"]`` is a `Material`; names, aliases, ``"material/label"``, ``"source:key"``
    and mixtures (``"bruggeman(TiO2:30%,SiO2)"``) are known. Iterating gives all names.

    Parameters
    ----------
    database : str or Path, optional
        The user's file; default: ``$MIEBRDF_DATABASE``, else
        ``~/.local/share/miebrdf/materials.sqlite``. It need not exist.

    Examples
    --------
    >>> materials = Materials("mine.sqlite")
    >>> len(materials), "TiO2" in materials
    >>> materials["bruggeman(TiO2:30%,SiO2)"].nk(550)
    """

    def __init__(self, database: str | Path | None = None) -> None:
        self._file = None if database is None else Path(database)

    @property
    def database(self) -> Path:
        """The user's file."""
        return _core.default_user_database() if self._file is None else self._file

    def _open(self) -> _core.Database:
        # Anew each time: another process, or the program, may have added something.
        return _core.Database.layered(self.database)

    def __getitem__(self, name: str) -> Material:
        return self.get(name)

    def get(
        self,
        name: str,
        *,
        interpolation: str = "pchip",
        extrapolate: bool = False,
        missing_k_zero: bool = False,
    ) -> Material:
        """A material by name.

        Parameters
        ----------
        name : str
        interpolation : str
            pchip, linear, linear-energy.
        extrapolate : bool
            The value at the nearer end beyond the data, instead of an error.
        missing_k_zero : bool
            k = 0 where n is known and k is not, instead of an error.

        Raises
        ------
        UnknownMaterial
            A KeyError too; with the nearest names.

        Returns
        -------
        Material

        Examples
        --------
        >>> miebrdf.materials.get("TiO2", interpolation="linear").nk(551)
        """
        from ._media import choice

        if not isinstance(name, str):
            raise UsageError(f"materials: a name is needed, not {type(name).__name__}")
        options = _core.IndexOptions(
            choice(_core.Interpolation, "interpolation", interpolation), extrapolate, missing_k_zero
        )
        database = self._open()
        index = database.refractive_index(name, options)
        try:
            facts = {**database.info(name), **_known(database.dataset_info(name))}
        except Exception as error:
            if type(error).__name__ not in ("UnknownMaterial", "InputError"):
                raise
            facts = {"title": name}  # a mixture
        return Material(name, facts, index)

    def __contains__(self, name: object) -> bool:
        try:
            self.get(str(name))
        except Exception as error:
            if type(error).__name__ == "UnknownMaterial":
                return False
            raise
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(str(facts["name"]) for facts in self._open().list())

    def __len__(self) -> int:
        return len(self._open().list())

    def meaning(self, word: str) -> dict[str, Any] | None:
        """What stands for a word that names no material, such as snow or milk, and why.

        Parameters
        ----------
        word : str

        Returns
        -------
        dict or None
            word, materials (names in this database), meaning; None for other words.

        Examples
        --------
        >>> miebrdf.materials.meaning("snow")["materials"]
        ['H2O_ice']
        """
        return _core.common_word(word)

    def search(
        self,
        text: str = "",
        *,
        covers_nm: tuple[float, float] | None = None,
        needs_k: bool = False,
    ) -> list[dict[str, Any]]:
        """Find materials, the best match first.

        Parameters
        ----------
        text : str
            Words that must all occur in name, alias, title, formula or provenance; empty: all.
        covers_nm : (float, float), optional
            Some dataset covers all of it.
        needs_k : bool
            ... with known k.

        Returns
        -------
        list of dict
            name, title, formula, source, reference, aliases, shortest_nm, longest_nm, k_known, ...

        Examples
        --------
        >>> [found["name"] for found in miebrdf.materials.search("oxide", covers_nm=(400, 700))]
        """
        return self._open().search(text, covers_nm, needs_k)

    def datasets(self, name: str) -> list[dict[str, Any]]:
        """All datasets of a material, the default first.

        Parameters
        ----------
        name : str

        Returns
        -------
        list of dict
            label, source, key, reference, shortest_nm, longest_nm, ...

        Raises
        ------
        UnknownMaterial
            With the nearest names.

        Examples
        --------
        >>> [each["label"] for each in miebrdf.materials.datasets("TiO2")]
        """
        return self._open().datasets(name)

    @checked(OfTable)
    def add(
        self,
        name: str,
        wavelengths_nm: ArrayLike,
        n: ArrayLike,
        k: ArrayLike | None = None,
        *,
        label: str = "own",
        replace: bool = False,
        **facts: Unpack[OfTable],
    ) -> str:
        """Add a table of your own to the user's file, in one transaction.

        Parameters
        ----------
        name : str
        wavelengths_nm : array
            In vacuum, nm, ascending.
        n, k : array
            Of the same length; n > 0, k >= 0. `n` may be complex and hold both. Without k it is
            unknown, which is not the same as 0.
        label : str
            Of this dataset of the material.
        replace : bool
            Another table of this label gives way, instead of being an error.
        **facts
            title, formula, source, reference, note : str; density_g_cm3 : float.

        Returns
        -------
        str
            added, unchanged or replaced.

        Raises
        ------
        InputError
            For figures that are not physical.
        MaterialFileError
            When the label is taken by other figures and `replace` is not set.

        Examples
        --------
        >>> mine = Materials("mine.sqlite")
        >>> mine.add("ink", [400, 700], [1.6, 1.5], [0.01, 0.02], reference="measured", replace=True)
        >>> mine["ink"].nk(550)
        """
        values = np.asarray(n)
        if values.dtype.kind == "c":
            if k is not None:
                raise UsageError("k: n is complex and holds it already")
            n, k = values.real, values.imag
        lists = [numbers("wavelengths_nm", wavelengths_nm), numbers("n", n)]
        if k is not None:
            lists.append(numbers("k", k))
        for array, what in zip(lists, ("wavelengths_nm", "n", "k")):
            if array.ndim != 1 or array.shape != lists[0].shape:
                raise UsageError(f"{what}: shape {array.shape}; lists of one length are needed")
        columns = [array.tolist() for array in lists] + [None]
        return _core.add_material(
            self.database, name, label, columns[0], columns[1], columns[2], dict(facts), replace
        )

    def import_files(
        self,
        files: str | Path | Sequence[str | Path],
        *,
        format: str = "",
        name: str = "",
        label: str = "",
        replace: bool = False,
    ) -> list[dict[str, Any]]:
        """Add files or folders in any format of the program (``miebrdf materials import``).

        Returns
        -------
        list of dict
            file, dataset, accepted, reason, corrections.

        Parameters
        ----------
        files : str, Path or list of them
            A file that is named must be right; of folders what is wrong is left out and said.
        format : str
            Empty: by content.
        name, label : str
            Of the material and its dataset; empty: from the file.
        replace : bool
            Another table of this label gives way.

        Raises
        ------
        MaterialFileError
            With file, line and reason.

        Examples
        --------
        >>> mine = Materials("mine.sqlite")
        >>> mine.import_files("ink.csv")  # doctest: +SKIP
        """
        if isinstance(files, (str, Path)):
            files = [files]
        return _core.import_files(
            self.database, [Path(each) for each in files], format, name, label, replace
        )

    def remove(self, name: str) -> bool:
        """Remove a material from the user's file; False when it is not there.

        Parameters
        ----------
        name : str

        Examples
        --------
        >>> mine = Materials("mine.sqlite")
        >>> mine.remove("ink")
        """
        return _core.remove_material(self.database, name)

    def __repr__(self) -> str:
        return f"<miebrdf.materials: {len(self)} materials, yours in {self.database}>"


def _known(facts: dict[str, Any]) -> dict[str, Any]:
    """Without what the dataset does not say: the material may."""
    return {key: value for key, value in facts.items() if value not in ("", None)}


materials = Materials()
