"""Derivatives by numbers that have names."""

import pickle

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene

BASE = "hg:{w=0.9},{g=0.6}"
COATS = ["isotropic:0.97@{tau=0.5}"]


def difference(change, name, value, ask):
    """Of values at both sides, solved far below what is compared."""
    h = 1e-3 * value
    plus, minus = (ask(change(name, value + side * h)) for side in (1, -1))
    return (plus - minus) / (2 * h)


def changed(name, value):
    numbers = {"w": 0.9, "g": 0.6, "tau": 0.5, name: value}
    return Scene(f"hg:{numbers['w']},{numbers['g']}", coats=[f"isotropic:0.97@{numbers['tau']}"])


FIXED = {"tolerance": 1e-8, "streams": 12}


def test_they_are_those_of_the_values():
    by = Scene(BASE, coats=COATS).derivatives(550, ["w", "g", "tau"], **FIXED)
    assert by.names == ("w", "g", "tau")
    albedo, spherical = by.albedo([0.3, 1.0]), by.spherical_albedo()
    brdf = by.brdf(0.5, [[0.3], [0.9]], [0.0, 120.0])
    for name, value in Scene(BASE, coats=COATS).numbers.items():
        # The third derivative is of the order of the value.
        tolerance = {"rtol": 1e-4, "atol": 1e-5}
        of_albedo = difference(
            changed, name, value, lambda s: np.asarray(s.solve(550, **FIXED).albedo([0.3, 1.0]))
        )
        np.testing.assert_allclose(albedo[name], of_albedo, **tolerance)
        of_sky = difference(
            changed, name, value, lambda s: np.asarray(s.solve(550, **FIXED).spherical_albedo())
        )
        np.testing.assert_allclose(spherical[name], of_sky, **tolerance)
        of_brdf = difference(
            changed,
            name,
            value,
            lambda s: np.asarray(s.brdf(550, 0.5, [[0.3], [0.9]], [0.0, 120.0], **FIXED)),
        )
        assert brdf[name].shape == (2, 2)
        np.testing.assert_allclose(brdf[name], of_brdf, **tolerance)


def test_what_passes_has_them_too():
    film = Scene(substrate="lambert:{ground=0.3}", coats=["hg:0.9,0.6@{tau=2}"])
    by = film.solve([450, 550], **FIXED).derivatives(["ground", "tau"])
    through = by.albedo(0.5, transmitted=True)
    assert through["tau"].shape == (2,)
    assert (np.asarray(through["tau"]) < 0).all()
    assert (np.asarray(by.spherical_albedo()["ground"]) > 0).all()
    with pytest.raises(miebrdf.UsageError, match="substrate"):
        Scene(BASE).derivatives(550, ["w"]).albedo(0.5, transmitted=True)


def test_named_scenes_are_scenes():
    scene = Scene(BASE, coats=COATS)
    assert scene.numbers == {"w": 0.9, "g": 0.6, "tau": 0.5}
    assert scene == pickle.loads(pickle.dumps(scene))
    assert scene != Scene("hg:0.9,0.6", coats=["isotropic:0.97@0.5"])
    assert scene.replace(coats=()).numbers == {"w": 0.9, "g": 0.6}
    assert "{tau=0.5}" in repr(scene)
    assert str(scene.base) == str(miebrdf.medium("hg:0.9,0.6"))
    same = Scene("hg:0.9,0.6", coats=["isotropic:0.97@0.5"])
    np.testing.assert_array_equal(scene.albedo(550, 0.5), same.albedo(550, 0.5))
    rough = Scene(BASE, roughness="{m=0.3}", surface_index="{n=1.5},0")
    assert rough.roughness == 0.3 and rough.surface_index == 1.5
    assert rough.numbers["m"] == 0.3


def test_what_is_not_there_is_refused():
    with pytest.raises(miebrdf.UsageError, match="x=0.13"):
        Scene("hg:{x},0.5")
    with pytest.raises(miebrdf.UsageError, match="it has w, g"):
        Scene(BASE).derivatives(550, ["q"]).albedo(0.5)
    with pytest.raises(miebrdf.UsageError, match="must be words"):
        Scene(BASE, coats=[miebrdf.coat("hg:0.9,0.5", depth=1.0), COATS[0]])
    with pytest.raises(miebrdf.UsageError, match="log1m"):
        Scene("hg:{w=1},0.6").derivatives(550, ["w"]).albedo(0.5)
