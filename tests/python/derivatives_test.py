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


NM = list(range(400, 701, 20))
COLOURED = {"tolerance": 1e-6, "streams": 16}


def test_reflectance_under_a_sky_has_them():
    by = Scene(BASE, coats=COATS).derivatives(550, ["w", "tau"], **FIXED)
    of_sun = by.hdrf(0.5, [0.3, 0.9], 40.0)
    mixed = by.hdrf(0.5, [0.3, 0.9], 40.0, diffuse_fraction=0.3)
    for name in by.names:
        brdf = np.asarray(by.brdf(0.5, [0.3, 0.9], 40.0)[name])
        sky = np.asarray(by.albedo([0.3, 0.9])[name])
        np.testing.assert_allclose(of_sun[name], np.pi * brdf, rtol=1e-12)
        np.testing.assert_allclose(mixed[name], 0.7 * np.pi * brdf + 0.3 * sky, rtol=1e-12)
    with pytest.raises(miebrdf.UsageError, match="diffuse_fraction"):
        by.hdrf(0.5, 0.5, diffuse_fraction=1.5)


def test_reflectance_under_a_sky():
    solved = Scene(BASE, coats=COATS).solve([550, 650], **FIXED)
    mixed = solved.hdrf(0.5, [0.3, 0.9], 40.0, diffuse_fraction=0.3)
    expected = 0.7 * np.pi * np.asarray(solved.exact(0.5, [0.3, 0.9], 40.0))
    expected += 0.3 * np.asarray(solved.albedo([0.3, 0.9]))
    np.testing.assert_allclose(mixed, expected, rtol=1e-12)
    ground = Scene(substrate="lambert:{a=0.4}")
    for sky in "uniform", "cie-clear", "cie-overcast":
        under = {"diffuse_fraction": 0.6, "sky": sky}
        values = ground.solve(550).hdrf([0.5, 1], 0.8, 30.0, **under)
        np.testing.assert_allclose(values, 0.4, rtol=1e-9)
        slope = ground.derivatives(550, ["a"]).hdrf([0.5, 1], 0.8, 30.0, **under)["a"]
        np.testing.assert_allclose(slope, 1.0, rtol=1e-9)
    with pytest.raises(miebrdf.UsageError, match="cie-overcast"):
        solved.hdrf(0.5, 0.5, diffuse_fraction=0.5, sky="blue")


def test_colours_have_them():
    words = "index:1.6,{k=0.01},radius={r=0.08},variance=0.1"

    def colours(k, r):
        scene = Scene(words.replace("{k=0.01}", repr(k)).replace("{r=0.08}", repr(r)))
        albedo = scene.albedo(NM, 0.5, **COLOURED)
        brdf = np.pi * np.asarray(scene.brdf(NM, 0.5, [0.3, 0.9], 30.0, **COLOURED))
        return [
            {"lab_l": lab[..., 0], "lab_b": lab[..., 2], "srgb_red": srgb[..., 0], "x": xyz[..., 0]}
            for lab, srgb, xyz in (
                (
                    miebrdf.colour.lab(values, NM),
                    miebrdf.colour.encode_srgb(miebrdf.colour.linear_srgb(values, NM)),
                    miebrdf.colour.xyz(values, NM),
                )
                for values in (np.asarray(albedo), brdf)
            )
        ]

    by = Scene(words).derivatives(NM, ["k", "r"], **COLOURED)
    found = [by.colour(0.5), by.colour(0.5, [0.3, 0.9], 30.0)]
    for name, value, sides in (
        ("k", 0.01, [colours(0.01 * (1 + s * 2e-3), 0.08) for s in (1, -1)]),
        ("r", 0.08, [colours(0.01, 0.08 * (1 + s * 2e-3)) for s in (1, -1)]),
    ):
        for kind in (0, 1):
            for column, plus in sides[0][kind].items():
                truth = (plus - sides[1][kind][column]) / (4e-3 * value)
                got = found[kind][name][column]
                assert got.shape == truth.shape == ((), (2,))[kind]
                # Averages choose their sizes within 1e-6, over steps of .4 %.
                np.testing.assert_allclose(got, truth, rtol=5e-3, err_msg=f"{name} {column}")
    with pytest.raises(miebrdf.UsageError, match="430"):
        Scene(BASE).derivatives([500, 600], ["w"]).colour(0.5)


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
