"""Measurements as instruments write them."""

import numpy as np
import pytest

import miebrdf


def test_a_table_becomes_arrays(tmp_path):
    (tmp_path / "paint.csv").write_text("nm;SCI (%);sigma (%)\n500;40,5;0,5\n400;20;0,5\n")
    paint = miebrdf.read_measured(tmp_path / "paint.csv")
    assert len(paint) == 2 and "2 values" in repr(paint)
    assert paint.format == "csv" and paint.samples == ["SCI (%)"]
    np.testing.assert_array_equal(paint.wavelength_nm, [400, 500])
    np.testing.assert_allclose(paint.value, [0.2, 0.405], rtol=1e-15)
    np.testing.assert_allclose(paint.sigma, 0.005, rtol=1e-15)
    assert list(paint.geometry) == ["d8-sci", "d8-sci"] and set(paint.quantity) == {"reflectance"}
    assert np.isnan(paint.mu_out).all()
    assert any("percent" in text for text in paint.facts.values())


def test_options_and_refusals(tmp_path):
    (tmp_path / "a.csv").write_text("nm,a,b\n400,80,90\n")
    with pytest.raises(miebrdf.InputError, match="percent"):
        miebrdf.read_measured(tmp_path / "a.csv")
    b = miebrdf.read_measured(
        tmp_path / "a.csv", column="b", percent=True, quantity="plane_albedo", mu_in=0.5, sigma=0.01
    )
    assert list(b.value) == [0.9] and list(b.mu_in) == [0.5] and list(b.sigma) == [0.01]
    assert list(b.geometry) == ["directional"] and list(b.sample) == ["b"]
    with pytest.raises(miebrdf.UsageError, match="d8-sci"):
        miebrdf.read_measured(tmp_path / "a.csv", quantity="gloss")
