"""Gathers the pages of the site and makes HTML of them. Called by tools/site.

    build.py BUILD-FOLDER [--html FOLDER]

BUILD-FOLDER/source holds what Sphinx reads: the pages as they lie in the repository, so that their
links stay true, notebooks as pages, a page for each public header, and the Python reference, for
which nothing has to be compiled: the types of the compiled module are read from _core.pyi. Warnings
and dead links are errors.
"""

from __future__ import annotations

import argparse
import base64
import html.parser
import json
import os
import re
import shutil
import subprocess
import sys
import urllib.parse
import xml.etree.ElementTree as ElementTree
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]

#: The chapters of the navigation: (title, pages).
CHAPTERS = [
    ("Tutorials", ["docs/tutorials/rendering", "docs/tutorials/snow", "docs/tutorials/paint", "docs/tutorials/fit-snow",
                   "docs/tutorials/fit-drawdown", "docs/tutorials/paste", "docs/tutorials/fit-brdf", "docs/tutorials/laboratory", "docs/tutorials/planetary", "docs/notebooks/README"]),
    ("Use", ["docs/command-line", "docs/python", "docs/scene-files", "docs/sweeps", "docs/measured", "docs/fitting", "docs/grounds", "docs/recipes", "docs/inference", "docs/derivatives",
             "docs/materials", "docs/particles", "docs/mixtures",
             "docs/boundaries", "docs/polarisation", "docs/colour", "docs/formats/README", "docs/plots", "docs/report", "docs/studio",
             "docs/rendering", "docs/subsurface", "docs/gallery"]),
    ("Reference", ["docs/conventions", "reference/python", "reference/cpp"]),
    ("Mathematics", ["docs/maths-mie", "docs/maths-spheroids", "docs/maths-rte", "docs/maths-boundary", "docs/maths-polarisation", "docs/maths-surface"]),
    ("Accuracy and speed", ["docs/accuracy", "docs/performance", "docs/numerics", "docs/stability", "docs/benchmarking"]),
    ("The project", ["CONTRIBUTING", "docs/folders", "docs/dependencies", "docs/versions", "tools/packaging/README", "SECURITY", "CHANGELOG", "docs/internals/README"]),
]  # fmt: skip

#: What the pages link to lies where it does in the repository.
SOURCES = [".github", "docs", "tools", "tests", "materials", "mie", "rte", "pipeline", "CONTRIBUTING.md", "SECURITY.md",
           "CHANGELOG.md", "README.md", "LICENSE", "CITATION.cff", "pyproject.toml"]  # fmt: skip

PLACE = re.compile(r'^<a id="([\w-]+)"></a>$', re.MULTILINE)
PLACES = {place for page in ROOT.glob("docs/**/*.md") for place in PLACE.findall(page.read_text(encoding="utf-8"))}
NAMESPACES = ("miebrdf", "miebrdf::rte", "miebrdf::mie", "miebrdf::materials")
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def version() -> str:
    found = re.search(r"project\(miebrdf VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        sys.exit(f"{ROOT}/CMakeLists.txt: no version found")
    return found.group(1)


#: Every file that was put, written or as it was: others are of an earlier run, and go.
gathered: set[Path] = set()


def put(file: Path, text: str) -> None:
    """Writes a file unless it says so already: Sphinx reads anew what is newer."""
    gathered.add(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    if not file.exists() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")


# ---------------------------------------------------------------- pages


def linked(page: Path, text: str) -> str:
    """A page's text with links that the site can follow: README is its home, notebooks are pages,
    folders are no pages."""

    def one(match: re.Match[str]) -> str:
        picture, words, target = match.groups()
        path, mark, anchor = target.partition("#")
        if picture or not path or re.match(r"[a-z]+:", path):
            return match.group(0)
        file = (page.parent / path).resolve()
        if file == ROOT / "README.md":
            path = os.path.relpath(ROOT / "index.md", page.parent)
        elif file.suffix == ".ipynb":
            path = path.removesuffix(".ipynb") + ".md"
        elif file.is_dir():
            return words
        if anchor in PLACES:
            return f"[{words}]({anchor})"
        return f"[{words}]({path}{mark}{anchor})"

    return PLACE.sub(r"(\1)=", LINK.sub(one, text))


def gather_pages(source: Path) -> None:
    for name in SOURCES:
        start = ROOT / name
        files = [start] if start.is_file() else sorted(start.rglob("*"))
        for file in files:
            to = source / file.relative_to(ROOT)
            if file.is_dir() or file.is_relative_to(HERE) or file.name == "README.md" and file.parent == ROOT:
                continue
            if file.suffix == ".md":
                put(to, linked(file, file.read_text(encoding="utf-8")))
                continue
            if file.suffix == ".ipynb":
                gather_notebook(file, to.with_suffix(".md"))
                continue
            gathered.add(to)
            if not to.exists() or to.stat().st_mtime < file.stat().st_mtime:
                to.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, to)
    home = linked(ROOT / "README.md", (ROOT / "README.md").read_text(encoding="utf-8"))
    known = {page for _, pages in CHAPTERS for page in pages}
    others = [f"docs/{page.stem}" for page in sorted(ROOT.glob("docs/*.md")) if f"docs/{page.stem}" not in known]
    for title, pages in CHAPTERS:
        if title == "Use":
            pages = pages + others  # a page that no chapter names is there all the same
        names = "\n".join(f"/{page}" for page in pages)
        home += f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n:maxdepth: 1\n\n{names}\n```\n"
    put(source / "index.md", home)
    for folder in ("docs/notebooks", "docs/formats", "docs/internals"):
        gather_toctree(source / folder)


def gather_toctree(folder: Path) -> None:
    """The README of a folder leads to its other pages."""
    others = sorted(page.stem for page in folder.glob("*.md") if page.name != "README.md")
    page = folder / "README.md"
    names = "\n".join(others)
    put(page, page.read_text(encoding="utf-8") + f"\n```{{toctree}}\n:hidden:\n\n{names}\n```\n")


def gather_notebook(file: Path, page: Path) -> None:
    """Its cells with what they print and draw."""
    parts: list[str] = []
    for number, cell in enumerate(json.loads(file.read_text(encoding="utf-8"))["cells"]):
        text = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(linked(file, text))
            continue
        parts.append(f"```python\n{text}\n```")
        for place, output in enumerate(cell["outputs"]):
            if output["output_type"] == "stream":
                parts.append("```{code-block} text\n:class: output\n\n" + "".join(output["text"]) + "\n```")
            elif "image/png" in output.get("data", {}):
                picture = page.with_name(f"{page.stem}_{number}_{place}.png")
                page.parent.mkdir(parents=True, exist_ok=True)
                gathered.add(picture)
                picture.write_bytes(base64.b64decode(output["data"]["image/png"]))
                parts.append(f"![What the cell draws]({picture.name})")
    put(page, "\n\n".join(parts) + "\n")


# ---------------------------------------------------------------- C++


def public_headers() -> list[Path]:
    return sorted(ROOT.glob("*/include/miebrdf/*.h")) + sorted(ROOT.glob("*/*/include/miebrdf/*.h"))


def gather_cpp(build: Path) -> None:
    """Doxygen reads the public headers; each gets a page, in the order of <miebrdf/miebrdf.h>."""
    headers = {header.name: header for header in public_headers()}
    folders = sorted({str(header.parent) for header in headers.values()})
    options = (HERE / "Doxyfile").read_text() + f"""
INPUT = {' '.join(f'"{folder}"' for folder in folders)}
OUTPUT_DIRECTORY = "{build / 'doxygen'}"
"""
    shutil.rmtree(build / "doxygen", ignore_errors=True)
    (build / "doxygen").mkdir(parents=True)
    done = subprocess.run(["doxygen", "-"], input=options, text=True, capture_output=True, check=False)
    wrong = [line for line in done.stderr.splitlines() if line.strip() and not speaks_for_itself(line)]
    if done.returncode or wrong:
        sys.exit("\n".join(wrong) + f"\ndoxygen: {len(wrong)} warnings, which are errors here")
    pages = []
    declared = declarations(build / "doxygen/xml")
    umbrella = headers["miebrdf.h"].read_text()
    named = re.findall(r"#include <miebrdf/(\w+\.h)>", umbrella)
    for name in dict.fromkeys([*named, *headers]):
        if name not in headers or name == "miebrdf.h":
            continue  # version.h is made by CMake
        pages.append(name.removesuffix(".h"))
        put(build / "source/reference/cpp" / f"{pages[-1]}.rst", header_page(headers[name], declared.get(name, [])))
    text = (HERE / "cpp.rst").read_text() + "\n.. toctree::\n   :maxdepth: 1\n\n"
    put(build / "source/reference/cpp.rst", text + "".join(f"   cpp/{page}\n" for page in pages))


def speaks_for_itself(warning: str) -> bool:
    """Whether what Doxygen misses need not be there: members of structs, whose names carry their unit,
    constructors and comparisons. Types and functions say what they are."""
    member = re.search(r"Member (\S+?)\(.* \(function\) of \w+ (\S+) is not documented", warning)
    if member:
        return member[1].startswith("operator") or member[1] == member[2].split("::")[-1]
    return "(variable)" in warning or "(enumeration)" in warning


def header_page(header: Path, declared: list[str]) -> str:
    """The comment at its head, everything that it declares, and what shows it."""
    comment = []
    for line in header.read_text(encoding="utf-8").splitlines():
        if not line.startswith("//"):
            break
        comment.append(line.removeprefix("//").removeprefix(" "))
    words, _, code = "\n".join(comment).partition("\n\n    ")
    title = f"<miebrdf/{header.name}>"
    text = f"{title}\n{'=' * len(title)}\n\n{words}\n\n"
    if code:
        example, _, more = code.partition("\n\n")
        text += ".. code-block:: cpp\n\n    " + example + f"\n\n{more}\n\n"
    last = ""
    for directive in declared:  # a heading each, which "On this page" lists; overloads share one
        name = re.sub(r"\(.*", "", directive.splitlines()[0].partition(":: ")[2]).rpartition("::")[2]
        text += (f"{name}\n{'-' * len(name)}\n\n" if name != last else "") + directive + "\n"
        last = name
    shown = HERE.parent / "examples/headers" / f"{header.stem}.cpp"
    if shown.exists():
        text += f"\n\nExample\n-------\n\n.. literalinclude:: /docs/examples/headers/{shown.name}\n   :language: cpp\n"
    return text


def declarations(xml: Path) -> dict[str, list[str]]:
    """A directive of Breathe's for everything that namespaces hold, by the name of its header, in
    its order there."""
    found: dict[str, list[tuple[int, str]]] = {}

    def add(element: ElementTree.Element, kind: str, name: str, members: bool) -> None:
        place = element.find("location")
        assert place is not None
        options = "   :members:\n   :protected-members:\n   :undoc-members:\n" if members else ""
        directive = f".. doxygen{kind}:: {name}\n{options}"
        found.setdefault(Path(place.attrib["file"]).name, []).append((int(place.attrib["line"]), directive))

    for file in sorted(xml.glob("*.xml")):
        tree = ElementTree.parse(file)
        for member in tree.iter("memberdef"):
            initializer = member.find("initializer")
            # Sphinx knows no designated initialisers.
            if initializer is not None and "{." in "".join(initializer.itertext()).replace(" ", ""):
                member.remove(initializer)
        for names in tree.iter("parameternamelist"):  # of "@throws A, B" Breathe would drop B
            first, *others = names.findall("parametername")
            for other in others:
                first.text = f"{first.text}, {(other.text or '').rstrip(';')}"
                names.remove(other)
        tree.write(file, encoding="utf-8", xml_declaration=True)
        for compound in tree.iter("compounddef"):
            name, kind = compound.findtext("compoundname", ""), compound.attrib["kind"]
            if kind in ("class", "struct") and compound.find("location") is not None:
                if name.rpartition("::")[0] in NAMESPACES:  # others are shown within their class
                    add(compound, kind, name, True)
            elif kind == "namespace":
                for member in compound.iter("memberdef"):
                    full = f"{name}::{member.findtext('name')}"
                    if member.attrib["kind"] == "function":
                        types = ["".join(each.itertext()) for each in member.findall("param/type")]
                        full += f"({', '.join(types)})"
                    add(member, member.attrib["kind"], full, False)
    return {header: [directive for _, directive in sorted(each)] for header, each in found.items()}


# ---------------------------------------------------------------- Python


def gather_python(build: Path) -> None:
    """The package as it is, its compiled module read from the types that are written for it."""
    package = build / "python/miebrdf"
    for file in sorted((ROOT / "tools/python/miebrdf").glob("*.py")):
        put(package / file.name, file.read_text(encoding="utf-8"))
    types = (ROOT / "tools/python/miebrdf/_core.pyi").read_text(encoding="utf-8")
    put(package / "_core.py", "from __future__ import annotations\n" + types.replace(
        "version: str\nprocessor_path: str\n", f'version = "{version()}"\nprocessor_path = "x86-64"\n'))
    put(package / "_version.py", f'__version__ = "{version()}"\n')
    put(package / "_install.py", "def check() -> None: ...\n")
    pages = (HERE / "python.rst").read_text()
    names = re.findall(r'^    "(\w+)",$', (package / "__init__.py").read_text(), re.MULTILINE)
    named_elsewhere = (package / "errors.py").read_text()  # all of which the page has
    names = [name for name in names if f'    "{name}",' not in named_elsewhere]
    others = [name for name in names if not re.search(rf"\b{name}\b", pages) and not name.startswith("_")]
    if others:  # a name that no section has is there all the same
        pages += "\nMore\n----\n\n.. currentmodule:: miebrdf\n\n"
        for name in others:
            pages += f".. autoclass:: {name}\n   :members:\n" if name[0].isupper() else f".. autofunction:: {name}\n"
    put(build / "source/reference/python.rst", pages)


# ---------------------------------------------------------------- checks


class Page(html.parser.HTMLParser):
    """The links of a page and what can be linked to in it."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if value and (name == "id" or (tag == "a" and name == "name")):
                self.anchors.add(value)
            elif value and name in ("href", "src"):
                self.links.append(value)


def dead_links(site: Path) -> list[str]:
    """Links inside of the site that lead nowhere, and links to other servers that pages load from."""
    pages = {file: Page(file) for file in sorted(site.rglob("*.html"))}
    wrong = []
    for file, page in pages.items():
        for link in page.links:
            if re.match(r"[a-z]+:", link) or link.startswith("//"):
                continue
            path, _, anchor = link.partition("#")
            path = path.partition("?")[0]  # styles and scripts have the version of their content
            target = (file.parent / urllib.parse.unquote(path)).resolve() if path else file
            name = f"{file.relative_to(site)}: {link}"
            if not target.exists():
                wrong.append(f"{name}: there is no such file")
            elif anchor and target in pages and urllib.parse.unquote(anchor) not in pages[target].anchors:
                wrong.append(f"{name}: there is no such place")
    if len(pages) < 60:
        wrong.append(f"{len(pages)} pages are far too few")
    return wrong


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--html", type=Path, help="where the site goes; default: BUILD-FOLDER/html")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    site = (arguments.html or build / "html").resolve()
    gather_pages(build / "source")
    gather_cpp(build)
    gather_python(build)
    for file in (build / "source").rglob("*"):
        if file.is_file() and file not in gathered:
            file.unlink()
    environment = {**os.environ, "MIEBRDF_SITE": str(build), "MIEBRDF_VERSION": version()}
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-c", HERE, "-d", build / "doctrees",
         build / "source", site], env=environment, check=False)  # fmt: skip
    if done.returncode:
        sys.exit("the site was not made without warnings")
    for page in (site / "reference/cpp").glob("*.html"):  # Breathe's dash before a reason that is not there
        put(page, page.read_text(encoding="utf-8").replace(" \u2013 </p>", "</p>"))
    wrong = dead_links(site)
    print("\n".join(wrong))
    print(f"{site}/index.html: {len(list(site.rglob('*.html')))} pages, {len(wrong)} dead links")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
