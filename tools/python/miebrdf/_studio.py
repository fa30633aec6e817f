"""The studio of the program (``miebrdf studio``) for a scene of Python."""

from __future__ import annotations

import html
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib
import weakref
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._scene import DEFAULTS, Scene
from ._scene_arguments import NAMED, NUMBERS
from .errors import InputError, MissingPackage, UsageError

#: Arguments of `Scene` whose words are not their names with hyphens.
_WORDS = {name: word for name, word in NAMED.items() if word != name.replace("_", "-")}
_ARGUMENTS = {word: name for name, word in _WORDS.items()}
#: Those of the surface are said behind the roughness, or not at all.
_OF_ROUGHNESS = ("surface_distribution", "shadowing", "fresnel")


class Studio:
    """A studio that runs: `studio` makes it. A notebook shows its page.

    Examples
    --------
    >>> knobs = miebrdf.studio(Scene("TiO2,radius=0.2"))  # doctest: +SKIP
    >>> isinstance(knobs, miebrdf.Studio)  # doctest: +SKIP
    >>> knobs.close()  # doctest: +SKIP
    """

    def __init__(self, words: dict[str, Any], database: str, program: str, height_px: int) -> None:
        #: Height of the page in a notebook.
        self.height_px = height_px
        folder = tempfile.TemporaryDirectory(prefix="miebrdf-studio-")
        self._state = Path(folder.name) / "miebrdf" / "studio.toml"
        self._state.parent.mkdir()
        self._state.write_text(_toml(words), encoding="utf-8")
        environment = {**os.environ, "XDG_STATE_HOME": folder.name}
        if database:
            environment["MIEBRDF_DATABASE"] = database
        in_notebook = "ipykernel" in sys.modules
        command = [program, "studio", "--quiet", *(["--no-open"] if in_notebook else [])]
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
        )
        self._end = weakref.finalize(self, _end, process, folder)
        assert process.stdout is not None and process.stderr is not None
        #: Where the page is, with the token that opens it.
        self.address = process.stdout.readline().strip()
        if not self.address.startswith("http://127.0.0.1:"):
            said = process.stderr.read().strip()
            self.close()
            raise InputError(f"{program} studio: {said or 'it gave no address'}")

    @property
    def words(self) -> dict[str, Any]:
        """The words of the scene as the page has it now, those of wavelengths and method too."""
        said = tomllib.loads(self._state.read_text(encoding="utf-8"))
        return {name: value for name, value in said.items() if name != "result"}

    @property
    def scene(self) -> Scene:
        """The scene as the page has it now."""
        return _scene_of(self.words)

    def close(self) -> None:
        """End the server. It ends with Python, too."""
        self._end()

    def __enter__(self) -> Studio:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<miebrdf.Studio {self.address if self._end.alive else 'closed'}>"

    def _repr_html_(self) -> str:
        if not self._end.alive:
            return html.escape(repr(self))
        return (
            f'<iframe src="{html.escape(self.address)}" title="miebrdf studio" '
            f'style="width: 100%; height: {self.height_px}px; border: 0"></iframe>'
        )


def studio(
    scene: Scene | None = None,
    wavelengths_nm: ArrayLike | None = None,
    *,
    height_px: int = 900,
    program: str | os.PathLike[str] | None = None,
) -> Studio:
    """Turn the knobs of a scene on a page, and have it back: ``s = studio(scene)``, ``s.scene``.

    A notebook shows the page in the cell, Python elsewhere opens a browser. It is the page of
    ``miebrdf studio``, a server on this machine's loopback alone: a notebook whose kernel runs on
    another machine cannot show it.

    Parameters
    ----------
    scene : Scene, optional
        What to begin with; default: the program's first scene.
    wavelengths_nm : array of one dimension, optional
        At most 128; default: 400 to 700 nm in steps of 20.
    height_px : int
        Height of the page in a notebook.
    program : path, optional
        The program ``miebrdf``; default: the one on PATH, or in the same build folder.

    Returns
    -------
    Studio
        `scene`, `words` (wavelengths and tolerance too), `address`, `close`.

    Raises
    ------
    MissingPackage
        Where the program is not found.
    UsageError
        For a scene that words cannot say: a table of sizes, particles of an index of one's own.
    InputError
        Where the program cannot begin, with what it says.

    Examples
    --------
    >>> scene = Scene("TiO2,radius=0.2", coats=["Au,radius=0.03@0.5"], roughness=0.3)
    >>> knobs = miebrdf.studio(scene)  # doctest: +SKIP
    >>> knobs.scene.albedo([450, 550], mu_in=0.5)  # doctest: +SKIP
    """
    words: dict[str, Any] = {}
    if scene is not None:
        words = _words_of(scene)
    elif wavelengths_nm is not None:
        raise UsageError("wavelengths_nm: give the scene of which they are, too")
    if wavelengths_nm is not None:
        words["wavelengths"] = ",".join(repr(float(nm)) for nm in np.ravel(wavelengths_nm))
    return Studio(words, scene.database if scene else "", _program(program), height_px)


def _program(given: str | os.PathLike[str] | None) -> str:
    built = Path(__file__).resolve().parents[3] / "miebrdf" / "miebrdf"
    found = shutil.which(given if given is not None else "miebrdf")
    if found is None and given is None and built.is_file():
        found = str(built)
    if found is None:
        raise MissingPackage(
            f"the studio is a part of the program miebrdf, and {given or 'that'} is not found; "
            "`cmake --install` puts it on PATH, or say program='.../miebrdf'"
        )
    return str(found)


def _end(process: subprocess.Popen[str], folder: tempfile.TemporaryDirectory[str]) -> None:
    process.send_signal(signal.SIGINT)
    try:
        process.wait(timeout=5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    for pipe in (process.stdout, process.stderr):
        if pipe is not None:
            pipe.close()
    folder.cleanup()


def _words_of(scene: Scene) -> dict[str, Any]:
    """What a scene file says of a scene."""
    words: dict[str, Any] = {}
    for name, default in DEFAULTS.items():
        value = getattr(scene, name)
        if value == default or name in (*_OF_ROUGHNESS, "database"):
            continue
        if name == "coats":
            value = [str(each) for each in value]
        elif isinstance(value, complex):
            value = f"{value.real!r},{value.imag!r}"
        elif name == "roughness" and scene.surface_distribution != "beckmann":
            value = f"{value!r},{scene.surface_distribution}"
        elif not isinstance(value, bool):
            value = str(value)
        words[_WORDS.get(name, name.replace("_", "-"))] = value
    try:
        is_same = _scene_of(words) == scene.replace(database="")
    except UsageError:
        is_same = False
    if not is_same:
        raise UsageError(
            "scene: words cannot say it (sizes as a table, an index of one's own, shadowing or "
            f"fresnel of a surface); they would be {words}"
        )
    return words


def _scene_of(words: dict[str, Any]) -> Scene:
    arguments: dict[str, Any] = {}
    for word, value in words.items():
        name = _ARGUMENTS.get(word, word.replace("-", "_"))
        if name not in DEFAULTS:
            continue  # wavelengths, tolerance, ...
        if name == "roughness" and "," in str(value):
            value, arguments["surface_distribution"] = str(value).split(",")
        if name in NUMBERS or name == "mie_tolerance":
            value = float(value)
        elif name in ("surface_index", "host"):
            value = _index_of(str(value))
        arguments[name] = value
    return Scene(**arguments)


def _index_of(text: str) -> complex | str:
    """n + ik of "N,K" or "N"; other texts are names."""
    try:
        return complex(*(float(part) for part in text.split(",")))
    except (TypeError, ValueError):
        return text


def _toml(words: dict[str, Any]) -> str:
    def text(value: Any) -> str:
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, list):
            return "[" + ", ".join(text(each) for each in value) + "]"
        # TOML's basic strings: of the scene's words these two alone need an escape.
        return '"' + str(value).replace("\\", "\\\\").replace('"', '\\"') + '"'

    lines = [f"{name} = {text(value)}" for name, value in words.items()]
    return "\n".join([*lines, "", "[[result]]", 'command = "report"', 'output = "studio.html"', ""])
