"""The pages of the documentation: their lines, with code told apart from text."""

import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]


def pages():
    """All Markdown files that belong to the project, in order."""
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "--cached", "--others",
                             "--exclude-standard", "*.md"], capture_output=True, text=True)
    if listed.returncode == 0 and listed.stdout:
        found = [ROOT / line for line in listed.stdout.splitlines()]
    else:  # a source archive
        found = [p for p in ROOT.rglob("*.md")
                 if not any(part.startswith((".", "build")) for part in p.relative_to(ROOT).parts)]
    return sorted(p for p in found if p.is_file())


def lines_of(page):
    """(number, line, fence) of a page; fence is the language of the code block around the line,
    "" for a block without one, None outside of blocks. Fences themselves are left out."""
    fence = None
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            fence = stripped[3:].strip() if fence is None else None
            continue
        yield number, line, fence
