"""What the reference is made of: every public name says what it takes, gives and refuses, and shows it."""

import doctest
import inspect

import numpy as np
import pytest

import miebrdf
from miebrdf import colour

# Words that NumPy's style of docstrings has for sections.
SECTIONS = ("Parameters", "Returns", "Raises", "Attributes", "Examples")


def _functions():
    """(name, function) of every public function, method and class."""
    for name in miebrdf.__all__:
        value = getattr(miebrdf, name)
        if inspect.isfunction(value) or inspect.isclass(value):
            yield name, value
        if inspect.isclass(value) and value.__module__.startswith("miebrdf.") and "_core" not in value.__module__:
            for member, function in inspect.getmembers(value, inspect.isfunction):
                if not member.startswith("_") and function.__module__.startswith("miebrdf"):
                    yield f"{name}.{member}", function
    for name, function in inspect.getmembers(colour, inspect.isfunction):
        if not name.startswith("_") and function.__module__ == "miebrdf.colour":
            yield f"colour.{name}", function


ALL = dict(_functions())
ERRORS = {name for name in miebrdf.__all__ if inspect.isclass(getattr(miebrdf, name))
          and issubclass(getattr(miebrdf, name), BaseException)}  # fmt: skip


def _has(function, section):
    lines = inspect.getdoc(function).splitlines()
    return any(line == section and set(rule) == {"-"} for line, rule in zip(lines, lines[1:]))


@pytest.mark.parametrize("name", ALL)
def test_every_public_name_is_described(name):
    text = inspect.getdoc(ALL[name])
    assert text and text.splitlines()[0].rstrip().endswith((".", ":"))
    if inspect.isclass(ALL[name]):
        return
    signature = inspect.signature(ALL[name])
    named = [each for each in signature.parameters.values() if each.name not in ("self", "part")]
    if len(named) > 1 and "As of" not in text and "Arguments as for" not in text and "as for `" not in text:
        assert _has(ALL[name], "Parameters"), "what it takes is missing"
        for each in named:
            assert each.name in text, f"{each.name} is not described"


@pytest.mark.parametrize("name", sorted(set(ALL) - ERRORS))
def test_every_public_name_has_an_example(name):
    # The class of a method may have it.
    owner = ALL.get(name.split(".")[0])
    word = name.split(".")[-1]
    examples = [ALL[name], owner, miebrdf, *(ALL[each] for each in ("Scene", "medium", "coat", "lambertian"))]
    examples = [each for each in examples if inspect.getdoc(each)]
    shown = "".join(line for each in examples for line in inspect.getdoc(each).splitlines(keepends=True)
                    if line.strip().startswith((">>>", "...")))  # fmt: skip
    assert word in shown or (_has(ALL[name], "Examples")), f"nothing shows {name}"


@pytest.mark.parametrize("module", ["_scene", "_media", "_mie", "_materials", "_files", "_layers", "_brdf", "_albedos",
                                    "_directions", "_options", "colour"])  # fmt: skip
def test_the_examples_run(module, tmp_path, monkeypatch):
    # What they print depends on the machine's NumPy: that they run is what is tested.
    monkeypatch.chdir(tmp_path)
    names = {"np": np, "miebrdf": miebrdf, **{name: getattr(miebrdf, name) for name in miebrdf.__all__}}
    names.update({name: getattr(colour, name) for name in dir(colour) if not name.startswith("_")})
    target = __import__(f"miebrdf.{module}", fromlist=["_"])
    for test in doctest.DocTestFinder().find(target, globs=names):
        for example in test.examples:
            if example.options.get(doctest.SKIP):
                continue
            exec(compile(example.source, f"{test.name}, line {example.lineno}", "single"), test.globs)
