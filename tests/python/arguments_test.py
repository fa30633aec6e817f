"""What may be given: shapes, kinds of numbers, nonsense. Right, or a clear error."""

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene

SCENE = Scene("hg:0.9,0.4")
MU = np.array([0.1, 0.4, 0.8, 1.0])
PHI = np.array([0.0, 60.0, 180.0])


@pytest.fixture(scope="module")
def table():
    return SCENE.solve([450, 650], progress=False)


@pytest.fixture(params=["exact", "table"])
def ask(request, table):
    """The two ways to values: f(wavelengths, ...) or the solved table."""
    if request.param == "table":
        return table
    return lambda *directions, **named: SCENE.brdf([450, 650], *directions, **named)


def test_results_broadcast_like_numpy_behind_the_wavelengths(ask):
    both = ask(0.5, MU[:, None], PHI[None, :])
    assert both.shape == (2, 4, 3)
    assert ask(0.5, 0.5, 0.0).shape == (2,)
    turned = ask(0.5, MU[None, :], PHI[:, None])
    np.testing.assert_array_equal(turned, both.transpose(0, 2, 1))
    assert ask(0.5, MU[:, None, None], PHI).shape == (2, 4, 1, 3)
    three = ask(MU[:, None, None], MU[:, None], PHI)
    assert three.shape == (2, 4, 4, 3)


def test_a_single_wavelength_has_no_axis():
    assert SCENE.brdf(550, 0.5, MU, 0.0).shape == (4,)
    assert SCENE.brdf([550], 0.5, MU, 0.0).shape == (1, 4)
    assert SCENE.solve(550)(0.5, MU).shape == (4,)
    assert SCENE.brdf(550, 0.5, 0.5).shape == ()


def test_scattered_directions_are_not_all_combinations(ask):
    mu_in, mu_out, phi = np.array([0.3, 0.5, 0.9]), np.array([0.2, 0.7, 0.4]), PHI
    values = ask(mu_in, mu_out, phi)
    one_by_one = [ask(*each) for each in zip(mu_in, mu_out, phi)]
    # The solver chooses its nodes for the directions it is asked: equal within the tolerance.
    np.testing.assert_allclose(values, np.transpose(one_by_one), rtol=1e-3)


def test_many_scattered_directions_are_solved_pair_by_pair():
    draw = np.random.default_rng(1)
    mu_in, mu_out = draw.uniform(0.1, 1, (2, 30))
    phi = draw.uniform(0, 180, 30)
    values = SCENE.brdf(550, mu_in, mu_out, phi)
    table = SCENE.solve(550)(mu_in, mu_out, phi)
    np.testing.assert_allclose(values, table, rtol=2e-3)


def test_angles_in_degrees_are_the_same(ask):
    by_angle = ask(
        theta_in_deg=60, theta_out_deg=np.rad2deg(np.arccos(MU)), azimuth_deg=PHI[:, None]
    )
    np.testing.assert_allclose(by_angle, ask(0.5, MU, PHI[:, None]), rtol=1e-13)


@pytest.mark.parametrize(
    "kind",
    [
        lambda a: a.tolist(),
        lambda a: tuple(a.tolist()),
        np.asfortranarray,
        lambda a: np.repeat(a, 2)[::2],
        lambda a: a[::-1][::-1],
        lambda a: a.astype(">f8"),
        lambda a: np.ndarray(a.shape, np.float64, bytearray(b"x" + a.tobytes()), offset=1),
    ],
    ids=["list", "tuple", "fortran", "strided", "reversed twice", "big-endian", "unaligned"],
)
def test_any_layout_gives_the_same_bits(ask, kind):
    np.testing.assert_array_equal(ask(0.5, kind(MU), 0.0), ask(0.5, MU, 0.0))


def test_float32_and_integers_are_taken_as_they_are(ask):
    single = MU.astype(np.float32)
    np.testing.assert_array_equal(ask(0.5, single), ask(0.5, single.astype(np.float64)))
    np.testing.assert_array_equal(ask(1, np.array([1, 1])), ask(1.0, [1.0, 1.0]))
    nm = np.array([450, 650], dtype=np.int16)
    np.testing.assert_array_equal(SCENE.brdf(nm, 0.5, MU), SCENE.brdf([450.0, 650.0], 0.5, MU))


def test_fortran_order_in_two_dimensions(table):
    mu = np.linspace(0.1, 1, 12).reshape(3, 4)
    np.testing.assert_array_equal(table(0.5, np.asfortranarray(mu)), table(0.5, mu))
    np.testing.assert_array_equal(table(0.5, mu.T), table(0.5, mu).transpose(0, 2, 1))


def test_nothing_asked_nothing_computed(ask):
    assert ask(0.5, np.array([]), 0.0).shape == (2, 0)
    assert ask([], 0.5).shape == (2, 0)
    assert ask(0.5, MU[:0, None], PHI).shape == (2, 0, 3)


@pytest.mark.parametrize("wrong", [np.nan, 0.0, -0.5, 1.5, np.inf])
def test_cosines_out_of_range_are_refused_with_their_value(ask, wrong):
    for directions in ((wrong, 0.5), (0.5, [0.5, wrong])):
        with pytest.raises(miebrdf.UsageError, match=r"mu_(in|out).*\(0, 1\]") as caught:
            ask(*directions)
        assert caught.value.allowed == "(0, 1]"
        assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_azimuths_that_are_no_numbers_are_refused(ask, wrong):
    with pytest.raises(miebrdf.UsageError, match="azimuth"):
        ask(0.5, 0.5, [0.0, wrong])


@pytest.mark.parametrize("wrong", [90.0, -1.0, np.nan])
def test_angles_beyond_the_horizon_are_refused(ask, wrong):
    with pytest.raises(miebrdf.UsageError, match=r"theta_out_deg.*\[0, 90\)"):
        ask(0.5, theta_out_deg=wrong)


@pytest.mark.parametrize("wrong", ["0.5", 0.5 + 1j, [[0.5], [0.5, 0.6]], True, object()])
def test_what_is_no_number_is_refused(ask, wrong):
    with pytest.raises(miebrdf.UsageError, match="mu_out"):
        ask(0.5, wrong)


def test_shapes_that_do_not_fit_are_named(ask):
    with pytest.raises(miebrdf.UsageError, match=r"mu_out \(4,\), azimuth_deg \(3,\)"):
        ask(0.5, MU, PHI)
    with pytest.raises(miebrdf.UsageError, match=r"a number or a list"):
        SCENE.brdf(np.array([[450.0], [550.0]]), 0.5, 0.5)
    with pytest.raises(miebrdf.UsageError, match="either mu_in or theta_in_deg"):
        ask(mu_out=0.5)
    with pytest.raises(miebrdf.UsageError, match="either mu_in or theta_in_deg"):
        ask(0.5, 0.5, theta_in_deg=60)


@pytest.mark.parametrize("wrong", [0, -550, np.nan, np.inf])
def test_wavelengths_out_of_range_are_refused(wrong):
    with pytest.raises(miebrdf.UsageError, match="wavelength"):
        SCENE.brdf(wrong, 0.5, 0.5)


def test_no_wavelengths():
    assert SCENE.brdf([], 0.5, MU).shape == (0, 4)
    with pytest.raises(miebrdf.UsageError, match="wavelength"):
        SCENE.solve([])


def test_words_are_refused_with_what_is_allowed():
    for arguments, text in [
        ({"base": "hg:2,0"}, r"2"),
        ({"base": "TiO2", "coats": ["TiO2"]}, "depth"),
        ({"base": "TiO2", "packing": "loose"}, "independent, percus-yevick"),
        ({"base": "TiO2", "effective_radius_um": -1.0}, "effective_radius_um.*-1"),
        ({"base": "TiO2", "roughness": 9.0}, "9"),
        ({}, "either base or substrate"),
        ({"base": "TiO2", "radius_um": 1.0}, r"Scene: unknown argument 'radius_um' .*effective_radius"),
    ]:
        with pytest.raises(miebrdf.UsageError, match=text):
            Scene(**arguments)
    with pytest.raises(miebrdf.UsageError, match=r"allowed: .*coat_method.*tolerance"):
        SCENE.solve(550, precision=1e-3)
    with pytest.raises(miebrdf.UsageError, match="unknown 'best'; allowed: auto, gauss"):
        SCENE.solve(550, grid="best")
    with pytest.raises(miebrdf.UsageError, match="total, subsurface"):
        SCENE.brdf(550, 0.5, 0.5, part="all")


def test_unknown_materials_are_key_errors_with_the_nearest_names():
    with pytest.raises(KeyError, match="TiO2") as caught:
        miebrdf.materials["TiO22"]
    assert isinstance(caught.value, miebrdf.InputError)
    assert "TiO2" in caught.value.candidates
    with pytest.raises(miebrdf.UnknownMaterial):
        Scene("Unobtainium").brdf(550, 0.5, 0.5)


def test_wavelengths_that_a_material_does_not_cover_are_input_errors():
    with pytest.raises(miebrdf.InputError, match="180") as caught:
        miebrdf.materials["TiO2"].nk([550, 50])
    assert caught.value.field == "wavelengths_nm"


def test_spheres_broadcast_and_refuse():
    m, x = np.array([1.5, 1.5 + 0.1j])[:, None], np.array([0.1, 1.0, 10.0])
    sphere = miebrdf.sphere(m, x)
    assert sphere.q_ext.shape == (2, 3)
    assert sphere.q_ext[1, 2] == miebrdf.sphere(1.5 + 0.1j, 10.0).q_ext
    assert miebrdf.sphere(1.5, np.array([])).q_ext.shape == (0,)
    with pytest.raises(miebrdf.UsageError):
        miebrdf.sphere(1.5 - 0.1j, 1.0)  # the other sign convention
    with pytest.raises(miebrdf.UsageError):
        miebrdf.sphere(1.5, np.nan)
    with pytest.raises(miebrdf.UsageError, match="broadcast"):
        miebrdf.sphere(np.ones(2), np.ones(3))


@pytest.mark.parametrize(
    "words", ["hg:{}", "moments:{}", "matrix:{}", "scattering:{}", "paste:{}", "TiO2,sizes={}"]
)
def test_a_missing_file_is_an_input_error_in_every_call(words, tmp_path):
    missing = str(tmp_path / "nosuch.csv")
    for call in (
        lambda: miebrdf.Scene(words.format(missing)),
        lambda: miebrdf.Scene(substrate=f"lambert:{missing}", coats="hg:0.9,0.5@1"),
        lambda: miebrdf.fit(missing),
        lambda: miebrdf.check(missing),
        lambda: miebrdf.read_measured(missing),
    ):
        with pytest.raises(miebrdf.InputError, match="nosuch"):
            call()


def test_messages_speak_of_arguments():
    with pytest.raises(miebrdf.UsageError, match="^roughness: 9 ") as caught:
        miebrdf.Scene("hg:0.9,0.5", roughness=9)
    assert caught.value.field == "roughness"
    with pytest.raises(miebrdf.UsageError, match="^wavelengths_nm: .*one or more, in nm"):
        miebrdf.Scene("hg:0.9,0.5").solve([])
