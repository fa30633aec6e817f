"""Charts: with matplotlib where they are asked for, and a small SVG for notebooks without it."""

from __future__ import annotations

import html as markup
from typing import TYPE_CHECKING, Any

import numpy as np

from ._options import set_options
from .errors import MissingPackage

if TYPE_CHECKING:
    from ._brdf import Brdf
    from ._materials import Material
    from ._scene import Scene

_MOST_CURVES = 9


def _pyplot() -> Any:
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise MissingPackage(
            f"charts need matplotlib ({error}); `apt install python3-matplotlib` or "
            "`pip install matplotlib`"
        ) from None
    return pyplot


def _lobe(brdf: Brdf, mu_in: float) -> tuple[Any, Any]:
    """Angles of reflection in degrees, mirror side positive, and values by wavelength."""
    theta = np.concatenate([-np.linspace(89.5, 0.5, 90), np.linspace(0.0, 89.5, 91)])
    azimuth = np.where(theta < 0, 180.0, 0.0)
    before = set_options(xarray=False)
    try:
        values = brdf(mu_in, np.cos(np.deg2rad(theta)), azimuth)
    finally:
        set_options(**before)
    return theta, np.atleast_2d(values)


def _chosen(brdf: Brdf, wavelength_nm: float | None) -> list[int]:
    nm = np.asarray(brdf.wavelengths_nm)
    if wavelength_nm is not None:
        return [int(np.argmin(np.abs(nm - wavelength_nm)))]
    return sorted({int(i) for i in np.linspace(0, nm.size - 1, min(nm.size, _MOST_CURVES))})


def wavelength_colour(wavelength_nm: float) -> tuple[float, float, float]:
    """About the hue of light of a wavelength, dark enough for lines on white."""
    nm = np.array([380.0, 440.0, 490.0, 520.0, 580.0, 645.0, 780.0])
    red = np.interp(wavelength_nm, nm, [0.35, 0.15, 0.0, 0.0, 0.75, 0.85, 0.4])
    green = np.interp(wavelength_nm, nm, [0.0, 0.1, 0.6, 0.6, 0.6, 0.1, 0.0])
    blue = np.interp(wavelength_nm, nm, [0.5, 0.9, 0.6, 0.1, 0.0, 0.0, 0.0])
    return float(red), float(green), float(blue)


def plot_lobe(
    brdf: Brdf, mu_in: float, wavelength_nm: float | None, ax: Any, line: dict[str, Any]
) -> Any:
    """`Brdf.plot_lobe`."""
    pyplot = _pyplot()
    if ax is None:
        _, ax = pyplot.subplots(subplot_kw={"projection": "polar"})
    theta, values = _lobe(brdf, mu_in)
    for i in _chosen(brdf, wavelength_nm):
        nm = brdf.wavelengths_nm[i]
        style = {"color": wavelength_colour(nm), "label": f"{nm:g} nm", **line}
        ax.plot(np.deg2rad(theta), values[i], **style)
    if getattr(ax, "name", "") == "polar":
        ax.set_theta_zero_location("N")
        ax.set_theta_direction(-1)
        ax.set_thetamin(-90)
        ax.set_thetamax(90)
        ax.set_rgrids(np.linspace(0, ax.get_rmax(), 4)[1:], fmt="%.2g", fontsize=7)
        incidence = np.degrees(np.arccos(mu_in))
        ax.set_title(f"BRDF in 1/sr, incidence {incidence:.3g}° from the left", fontsize=10)
    ax.legend(fontsize=8, loc="lower center", ncol=3, bbox_to_anchor=(0.5, -0.05))
    return ax


def plot_nk(material: Material, ax: Any) -> Any:
    """`Material.plot`."""
    pyplot = _pyplot()
    if ax is None:
        _, ax = pyplot.subplots()
    nm, n, k = material.table()
    ax.plot(nm, n, label="n")
    if k is not None:
        ax.plot(nm, k, label="k")
    ax.set_xlabel("wavelength in vacuum (nm)")
    ax.set_title(f"{material.name}: {material.source}", fontsize=10)
    ax.legend()
    return ax


_SIZE = 220
_MARGIN = 12


def _svg(brdf: Brdf) -> str:
    """Polar lobes at 45 degrees of incidence."""
    theta, values = _lobe(brdf, float(np.cos(np.pi / 4)))
    chosen = _chosen(brdf, None)
    largest = float(np.nanmax(values[chosen])) or 1.0
    radius = (_SIZE - 2 * _MARGIN) / 2
    x0, y0 = _SIZE / 2, radius + _MARGIN
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_SIZE}" height="{radius + 2 * _MARGIN}">',
        f'<path d="M{x0 - radius},{y0} A{radius},{radius} 0 0 1 {x0 + radius},{y0} Z" '
        'fill="none" stroke="#ccc"/>',
        f'<line x1="{x0}" y1="{y0}" x2="{x0 - radius * 0.7071:.1f}" '
        f'y2="{y0 - radius * 0.7071:.1f}" stroke="#999" stroke-dasharray="3 3"/>',
    ]
    for i in chosen:
        share = radius * values[i] / largest
        x = x0 + share * np.sin(np.deg2rad(theta))
        y = y0 - share * np.cos(np.deg2rad(theta))
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
        red, green, blue = (round(255 * c) for c in wavelength_colour(brdf.wavelengths_nm[i]))
        parts.append(
            f'<polyline points="{points}" fill="none" stroke="rgb({red},{green},{blue})"/>'
        )
    return "".join([*parts, "</svg>"])


def _rows(facts: dict[str, str]) -> str:
    return "".join(
        f"<tr><th style='text-align:left;vertical-align:top'>{key}</th>"
        f"<td style='text-align:left'>{'<br>'.join(markup.escape(value).splitlines())}</td></tr>"
        for key, value in facts.items()
    )


def scene_html(scene: Scene) -> str:
    """What lies on what, from the top down, and the sizes, for notebooks."""
    layers = [str(layer) for layer in reversed(scene.coats)]
    below = scene.base if scene.base is not None else f"substrate {scene.substrate}"
    facts = {
        "from the top": "\n".join([*layers, str(below)]),
        "particles": scene.attributes()["particles"],
        "all": repr(scene),
    }
    if scene.roughness or scene.boundary:
        surface = scene.boundary or f"surface of roughness {scene.roughness:g}"
        facts["from the top"] = f"{surface}\n{facts['from the top']}"
    return f"<table>{_rows({key: value for key, value in facts.items() if value})}</table>"


def html(brdf: Brdf) -> str:
    """A picture and the facts, for notebooks; without the table, which nobody has asked for, the
    facts alone."""
    nm = brdf.wavelengths_nm
    facts = {"scene": str(brdf.scene), **brdf.scene.attributes()}
    facts["wavelengths"] = f"{len(nm)}: {min(nm):g} to {max(nm):g} nm"
    if not brdf.is_tabulated:
        facts["state"] = "nothing computed for directions yet: ask b(mu_in, mu_out, azimuth_deg)"
        return f"<table>{_rows({key: value for key, value in facts.items() if value})}</table>"
    report = brdf.report
    facts["error estimate"] = (
        f"{report.error_estimate:.2g} (tolerance {report.tolerance:g}"
        f"{')' if report.converged else ', not converged)'}"
    )
    facts["sources"] = "\n".join(report.sources)
    facts["picture"] = "BRDF in the plane of incidence, light from the left at 45°"
    rows = _rows({key: value for key, value in facts.items() if value})
    return (
        "<div style='display:flex;gap:1em;align-items:center'>"
        f"{_svg(brdf)}<table>{rows}</table></div>"
    )
