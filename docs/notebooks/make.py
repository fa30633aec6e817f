"""The notebooks are made of the scripts beside them.

``make.py [NAME ...]`` runs the cells of each script and writes NAME.ipynb with what they print and
draw; ``make.py --check [NAME ...]`` runs them too, and fails where a notebook has other cells than
its script. Cells begin with ``# %%``, those of text with ``# %% [markdown]``. Needs miebrdf and
matplotlib, nothing of Jupyter.
"""

from __future__ import annotations

import base64
import contextlib
import io
import json
import sys
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

FOLDER = Path(__file__).parent


def cells_of(script: str) -> list[tuple[bool, str]]:
    """(is text, source) of each cell."""
    cells = []
    for block in ("\n" + script).split("\n# %%")[1:]:
        head, _, body = block.partition("\n")
        is_text = "[markdown]" in head
        if is_text:
            body = "\n".join(line.removeprefix("#").removeprefix(" ") for line in body.split("\n"))
        cells.append((is_text, body.strip("\n")))
    return cells


def run(source: str, where: str, names: dict[str, Any]) -> list[dict[str, Any]]:
    """Runs a cell. Returns its outputs as a notebook stores them."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(source, where, "exec"), names)
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        outputs.append(
            {
                "output_type": "stream",
                "name": "stdout",
                "text": printed.getvalue().splitlines(keepends=True),
            }
        )
    for number in plt.get_fignums():
        picture = io.BytesIO()
        plt.figure(number).savefig(picture, format="png", dpi=80, bbox_inches="tight")
        image = base64.b64encode(picture.getvalue()).decode()
        outputs.append(
            {"output_type": "display_data", "metadata": {}, "data": {"image/png": image}}
        )
    plt.close("all")
    return outputs


def notebook_of(script: Path) -> dict[str, Any]:
    names: dict[str, Any] = {"__name__": "__main__"}
    cells: list[dict[str, Any]] = []
    for number, (is_text, source) in enumerate(cells_of(script.read_text())):
        cell: dict[str, Any] = {
            "cell_type": "markdown" if is_text else "code",
            "id": f"cell-{number}",
            "metadata": {},
            "source": source.splitlines(keepends=True),
        }
        if not is_text:
            cell["outputs"] = run(source, f"{script.name}, cell {number}", names)
            cell["execution_count"] = None
        cells.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {
        "cells": cells,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def differs(made: dict[str, Any], stored: dict[str, Any]) -> bool:
    """Whether the cells do; what they print and draw may depend on the machine."""

    def sources(notebook: dict[str, Any]) -> list[tuple[str, str]]:
        return [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]]

    return sources(made) != sources(stored)


def main(arguments: list[str]) -> int:
    check = "--check" in arguments
    wanted = [Path(name).stem for name in arguments if name != "--check"]
    wrong = 0
    for script in sorted(FOLDER.glob("[0-9]*.py")):
        if wanted and script.stem not in wanted:
            continue
        made, file = notebook_of(script), script.with_suffix(".ipynb")
        if not check:
            file.write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n")
            print(f"written: {file.name}")
        elif not file.exists() or differs(made, json.loads(file.read_text())):
            print(f"{file.name} is not what {script.name} says: run {__file__}")
            wrong += 1
        else:
            print(f"{script.name}: runs, and {file.name} has its cells")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
