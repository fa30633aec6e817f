"""The studio of a scene of Python: the page has the scene, and the scene comes back changed."""

import json
import re
import urllib.request

import pytest

import miebrdf
from miebrdf import Scene, coat, medium

SCENE = Scene(
    medium("TiO2", radius_um=0.2),
    coats=[coat("Au", depth=0.5, radius_um=0.03)],
    roughness=0.3,
    surface_distribution="ggx",
    host=1.33,
)


@pytest.fixture
def knobs(monkeypatch):
    monkeypatch.setenv("BROWSER", "true")
    monkeypatch.setitem(__import__("sys").modules, "ipykernel", object())  # as in a notebook
    try:
        running = miebrdf.studio(SCENE, [450, 550, 650])
    except (miebrdf.MissingPackage, miebrdf.InputError) as missing:
        pytest.skip(f"the program with its studio is not built here: {missing}")
    with running:
        yield running


def _ask(knobs, path, asked):
    base, token = knobs.address.split("/?token=")
    sent = {"X-Studio-Token": token, "Content-Type": "application/json"}
    request = urllib.request.Request(base + path, json.dumps(asked).encode(), sent)
    with urllib.request.urlopen(request, timeout=60) as reply:
        return json.load(reply)


def test_the_page_has_the_scene_and_gives_it_back_changed(knobs):
    assert knobs.scene == SCENE
    state = _ask(knobs, "/api/state", {})
    words = state["words"]
    assert words["wavelengths"] == ["450.0,550.0,650.0"] and words["roughness"] == ["0.3,ggx"]
    words["coat"] = ["Au,radius=0.05@0.7"]
    _ask(knobs, "/api/save", {"words": words, "view": {}})
    assert knobs.scene == SCENE.replace(coats=["Au,radius=0.05@0.7"])
    assert knobs.words["wavelengths"] == "450.0,550.0,650.0"


def test_a_notebook_of_this_machine_may_show_it(knobs):
    shown = re.search(r'<iframe src="([^"]+)"', knobs._repr_html_())[1]
    with urllib.request.urlopen(shown, timeout=60) as page:
        policy = page.headers["Content-Security-Policy"]
        assert b"miebrdf" in page.read()
    assert re.search(r"frame-ancestors http://127\.0\.0\.1:\* http://localhost:\*$", policy)


def test_a_closed_studio_answers_nobody(knobs):
    address = knobs.address
    knobs.close()
    with pytest.raises(OSError):
        urllib.request.urlopen(address, timeout=5)
    assert "closed" in repr(knobs) and "iframe" not in knobs._repr_html_()


@pytest.mark.parametrize(
    "scene",
    [
        Scene("TiO2", size_distribution=([0.1, 0.2, 0.3], [0.0, 1.0, 0.0])),
        Scene("TiO2,radius=0.2", roughness=0.3, shadowing="v-cavity"),
    ],
)
def test_a_scene_that_words_cannot_say_is_refused(scene):
    with pytest.raises(miebrdf.UsageError, match="words cannot say it"):
        miebrdf.studio(scene)


def test_a_program_that_is_not_there_is_named():
    with pytest.raises(miebrdf.MissingPackage, match="no/such/miebrdf"):
        miebrdf.studio(SCENE, program="/no/such/miebrdf")
