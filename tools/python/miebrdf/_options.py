"""Options of the package, and what long calls have in common: threads, progress, cache."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from typing import Any, TypedDict, Unpack

from . import _core
from ._keywords import unknown
from .errors import UsageError

ProgressCallback = Callable[[str, int, int], Any]
Progress = bool | ProgressCallback | None

_FIRST_SHOWN_S = 0.5


class Options(TypedDict, total=False):
    """Those of `set_options`."""

    xarray: bool | None
    progress: Progress
    threads: int
    cache: bool


_settings: Options = {"xarray": None, "progress": None, "threads": 0, "cache": False}


def set_options(**options: Unpack[Options]) -> Options:
    """Change defaults of the whole package.

    Parameters
    ----------
    xarray : bool or None
        Whether results are `xarray.DataArray`; None (default): where xarray is installed.
    progress : bool, callable or None
        How long calls show their progress; None (default): on a terminal or in a notebook, after
        half a second. A callable is called as ``progress(stage, done, total)``.
    threads : int
        Most threads of a call; 0 (default): one for each processor. Results do not depend on it.
    cache : bool
        Whether results of earlier runs, which the program shares, are used and stored
        (``$XDG_CACHE_HOME/miebrdf``). Default: False.

    Returns
    -------
    dict
        The options as they were, so that ``set_options(**before)`` restores them.

    Raises
    ------
    UsageError
        For an option that there is not.

    Examples
    --------
    >>> before = set_options(xarray=False, threads=1)
    >>> set_options(**before)
    """
    for name in options:
        if name not in _settings:
            raise UsageError(unknown("option", name, list(_settings)))
    before = _settings.copy()
    _settings.update(options)
    return before


def use_xarray() -> bool:
    """Whether results are DataArrays."""
    wanted = _settings["xarray"]
    if wanted is None:
        # Not imported for this: it takes a second.
        from importlib.util import find_spec

        return "xarray" in sys.modules or find_spec("xarray") is not None
    return bool(wanted)


def _is_watched() -> bool:
    """Whether somebody sees standard error: a terminal, or a notebook."""
    return sys.stderr is not None and (sys.stderr.isatty() or "ipykernel" in sys.modules)


class _Shown:
    """A bar of tqdm for each stage, or a plain line where tqdm is not installed."""

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._stage = ""
        self._bar: Any = None
        self._line_shown = False

    def __call__(self, stage: str, done: int, total: int) -> None:
        if time.monotonic() - self._begin < _FIRST_SHOWN_S:
            return
        if stage != self._stage:
            self.close()
            self._stage = stage
            try:
                from tqdm.auto import tqdm

                self._bar = tqdm(total=total, desc=stage, leave=False)
            except Exception:  # whatever is wrong with it, the work goes on
                self._bar = None
        if self._bar is not None:
            self._bar.update(done - self._bar.n)
        else:
            sys.stderr.write(f"\r{stage}: {done} of {total}\x1b[K")
            sys.stderr.flush()
            self._line_shown = True

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
        if self._line_shown:
            sys.stderr.write("\r\x1b[K")
            self._line_shown = False


class Call:
    """``with Call(threads, progress, cache) as options: _core.f(..., options)``."""

    def __init__(
        self, threads: int | None = None, progress: Progress = None, cache: bool | None = None
    ) -> None:
        if threads is None:
            threads = _settings["threads"]
        if isinstance(threads, bool) or not isinstance(threads, int) or not 0 <= threads <= 4096:
            raise UsageError(f"threads: {threads!r} is out of range; allowed: 0 to 4096")
        if progress is None:
            progress = _settings["progress"]
        if progress is None:
            progress = _is_watched()
        self._shown = _Shown() if progress is True else None
        shown: ProgressCallback | None = self._shown
        if callable(progress):
            shown = progress
        self._options = _core.CallOptions(
            threads, shown, bool(_settings["cache"] if cache is None else cache)
        )

    def __enter__(self) -> _core.CallOptions:
        return self._options

    def __exit__(self, *_: object) -> None:
        if self._shown is not None:
            self._shown.close()


# The pool of threads stays with the parent; a child computes in the thread that asks.
os.register_at_fork(after_in_child=_core.set_forked)
