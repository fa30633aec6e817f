"""The same values as the program, to the last bit: its CSV has 17 digits where they are needed."""

import warnings

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene, coat, medium

MU_IN, MU_OUT, AZIMUTH = [0.2, 0.5, 1.0], [0.1, 0.6, 0.95], [0.0, 90.0, 180.0]
DIRECTIONS = ["--mu-in", "0.2,0.5,1", "--mu-out", "0.1,0.6,0.95", "--azimuth", "0,90,180"]
CRUDE = ["--tolerance", "1e-2"]

# (words of the program, scene, wavelengths, method): what is asked of both.
BRDFS = [
    ("--base hg:0.9,0.4", lambda: Scene("hg:0.9,0.4"), [550], {}),
    ("--base isotropic:1", lambda: Scene("isotropic:1"), [550], {}),
    ("--base rayleigh:0.7 --tolerance 1e-6", lambda: Scene("rayleigh:0.7"), [550], {"tolerance": 1e-6}),
    ("--base TiO2,radius=0.2", lambda: Scene(medium("TiO2", radius_um=0.2)), [450, 550], {}),
    ("--base TiO2 --effective-radius 0.2", lambda: Scene("TiO2", effective_radius_um=0.2), [450], {}),
    (
        "--base TiO2 --effective-radius 0.3 --size-distribution gamma --effective-variance 0.1",
        lambda: Scene("TiO2", effective_radius_um=0.3, size_distribution="gamma", effective_variance=0.1),
        [600],
        {},
    ),
    ("--base TiO2,radius=0.2 --host-index 1.5", lambda: Scene("TiO2,radius=0.2", host=1.5), [550], {}),
    ("--base TiO2,radius=0.2 --host-index SiO2", lambda: Scene("TiO2,radius=0.2", host="SiO2"), [550], {}),
    (
        "--base hg:0.9,0.5 --coat hg:0.5,0.1@0.3",
        lambda: Scene("hg:0.9,0.5", coats=[coat("hg:0.5,0.1", depth=0.3)]),
        [550],
        {},
    ),
    (
        "--base TiO2,radius=0.2 --coat Au,radius=0.03@0.5",
        lambda: Scene("TiO2,radius=0.2", coats=[coat("Au", depth=0.5, radius_um=0.03)]),
        [450, 550, 650],
        {},
    ),
    (
        "--base TiO2,radius=0.2 --coat Au,radius=0.03@0.5[grey] --coat hg:0.9,0@0.1",
        lambda: Scene(
            "TiO2,radius=0.2",
            coats=[coat("Au", depth=0.5, radius_um=0.03, grey=True), "hg:0.9,0@0.1"],
        ),
        [450, 650],
        {},
    ),
    ("--base hg:0.9,0.4 --roughness 0.3 --surface-index 1.5,0",
     lambda: Scene("hg:0.9,0.4", roughness=0.3, surface_index=1.5), [550], {}),
    ("--base hg:0.9,0.4 --roughness 0.2 --surface-index 1.5,0 --coupling reciprocal",
     lambda: Scene("hg:0.9,0.4", roughness=0.2, surface_index=1.5, coupling="reciprocal"), [550], {}),
    ("--base TiO2,radius=0.2 --roughness 0.3 --component subsurface",
     lambda: Scene("TiO2,radius=0.2", roughness=0.3), [550], {"part": "subsurface"}),
    ("--base TiO2,radius=0.2 --roughness 0.3 --component surface",
     lambda: Scene("TiO2,radius=0.2", roughness=0.3), [450, 550], {"part": "surface"}),
    ("--substrate black --coat hg:0.9,0.4@2",
     lambda: Scene(substrate="black", coats=["hg:0.9,0.4@2"]), [550], {}),
    ("--substrate lambert:0.5 --coat hg:0.9,0.4@2",
     lambda: Scene(substrate=0.5, coats=["hg:0.9,0.4@2"]), [550], {}),
    ("--substrate black --coat TiO2,radius=0.13,volume=5%@40um --host-index 1.5",
     lambda: Scene(substrate="black", host=1.5,
                   coats=[coat("TiO2", thickness_um=40, radius_um=0.13, volume=0.05)]), [550], {}),
    ("--base hg:0.9,0.4 --streams 12", lambda: Scene("hg:0.9,0.4"), [550], {"streams": 12}),
    ("--base hg:0.9,0.4 --grid paper --streams 16 --half-space-method fixed-point",
     lambda: Scene("hg:0.9,0.4"), [550],
     {"grid": "paper", "streams": 16, "half_space_method": "fixed-point"}),
    ("--base hg:0.9,0.4 --coat hg:0.9,0@0.1 --coat-method first-order --streams 16",
     lambda: Scene("hg:0.9,0.4", coats=["hg:0.9,0@0.1"]), [550],
     {"coat_method": "first-order", "streams": 16}),
    ("--base H2O_ice,radius=50 --tolerance 1e-2", lambda: Scene(medium("H2O_ice", radius_um=50)),
     [1300], {"tolerance": 1e-2}),
]  # fmt: skip


@pytest.mark.parametrize("words, scene, wavelengths, method", BRDFS, ids=lambda x: str(x)[:60])
def test_brdf(program, words, scene, wavelengths, method):
    nm = ",".join(map(str, wavelengths))
    table = program("brdf", "--no-cache", *words.split(), "--wavelengths", nm, *DIRECTIONS)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", miebrdf.NotConverged)
        values = scene().brdf(
            wavelengths,
            np.array(MU_IN)[:, None, None],
            np.array(MU_OUT)[:, None],
            AZIMUTH,
            **method,
        )
    assert values.shape == (len(wavelengths), 3, 3, 3)
    np.testing.assert_array_equal(values.reshape(-1), table["brdf"])


@pytest.mark.parametrize(
    "words, scene",
    [
        ("--base hg:0.99,0.7", lambda: Scene("hg:0.99,0.7")),
        ("--base TiO2,radius=0.2 --roughness 0.3", lambda: Scene("TiO2,radius=0.2", roughness=0.3)),
        (
            "--substrate lambert:0.2 --coat hg:0.9,0.4@2",
            lambda: Scene(substrate=0.2, coats="hg:0.9,0.4@2"),
        ),
    ],
)
def test_albedo(program, words, scene):
    table = program(
        "albedo", "--no-cache", *words.split(), "--wavelengths", "450,650", "--mu-in", "0.2,1"
    )
    solved = scene().solve([450, 650])
    np.testing.assert_array_equal(solved.albedo([0.2, 1.0]).reshape(-1), table["plane_albedo"])
    np.testing.assert_array_equal(
        np.repeat(solved.spherical_albedo(), 2), table["spherical_albedo"]
    )
    if "plane_transmittance" in table:
        through = solved.albedo([0.2, 1.0], transmitted=True)
        np.testing.assert_array_equal(through.reshape(-1), table["plane_transmittance"])


@pytest.mark.parametrize("light", ["d65", "d50", "a,10", "e"])
def test_colours(program, light):
    table = program("albedo", "--no-cache", "--base", "hg:0.95,0.5", "--coat", "AlGaAs7@0.1",
                    "--effective-radius", "0.2", *CRUDE, "--wavelengths", "400:700:20",
                    "--colour", light, "--mu-in", "0.6")  # fmt: skip
    nm = np.arange(400, 701, 20)
    scene = Scene("hg:0.95,0.5", coats="AlGaAs7@0.1", effective_radius_um=0.2)
    albedo = scene.solve(nm, tolerance=1e-2).albedo(0.6)
    of_beam = 0  # the first row; the second is that of diffuse light
    for name, values in (
        ("x y z", miebrdf.colour.xyz(albedo, nm, illuminant=light)),
        ("lab_l lab_a lab_b", miebrdf.colour.lab(albedo, nm, illuminant=light)),
        ("srgb_red srgb_green srgb_blue", miebrdf.colour.srgb(albedo, nm, illuminant=light)),
    ):
        shown = [table[column][of_beam] for column in name.split()]
        np.testing.assert_allclose(values, shown, atol=6e-7, err_msg=name)  # six decimals
    error = miebrdf.colour.colour_error(albedo, nm, illuminant=light)
    np.testing.assert_allclose(error, table["colour_error"][of_beam], atol=6e-7)


def test_layers(program):
    words = ["--substrate", "black", "--host-index", "1.5",
             "--coat", "TiO2,radius=0.13,volume=5%@40um"]  # fmt: skip
    table = program("layers", *words, "--wavelengths", "500")
    scene = Scene(substrate="black", host=1.5,
                  coats=[coat("TiO2", thickness_um=40, radius_um=0.13, volume=0.05)])  # fmt: skip
    layer = scene.layers(500)[-1]
    for name in ("optical_depth", "single_scattering_albedo", "asymmetry", "k_km", "s_km"):
        assert layer[name] == table[name][-1], name


@pytest.mark.parametrize("m", [1.5 + 0j, 1.33 + 1e-5j, 2.7 + 0.5j])
def test_sphere(program, m):
    sizes = [0.001, 0.5, 10.0, 1000.0]
    table = program("sphere", "--index", f"{m.real!r},{m.imag!r}",
                    "--size-parameter", ",".join(map(str, sizes)))  # fmt: skip
    sphere = miebrdf.sphere(m, sizes)
    for name in ("q_ext", "q_sca", "q_abs", "q_back", "asymmetry"):
        np.testing.assert_array_equal(getattr(sphere, name), table[name])


def test_amplitudes(program):
    table = program("sphere", "--index", "1.5,0.1", "--size-parameter", "7", "--angles", "0:180:30")
    s1, s2 = miebrdf.amplitudes(1.5 + 0.1j, 7, np.arange(0, 181, 30))
    np.testing.assert_array_equal(s1, table["s1_re"] + 1j * table["s1_im"])
    np.testing.assert_array_equal(s2, table["s2_re"] + 1j * table["s2_im"])


@pytest.mark.parametrize("name", ["TiO2", "SiO2", "bruggeman(TiO2:30%,SiO2)"])
def test_index(program, name):
    nm = np.arange(400, 701, 25)
    table = program("materials", "nk", name, "--wavelengths", "400:700:25")
    nk = miebrdf.materials[name].nk(nm)
    np.testing.assert_array_equal(nk.real, table["n"])
    if not np.isnan(table["k"]).all():
        np.testing.assert_array_equal(nk.imag, table["k"])
