"""The table and the errors of docs/subsurface.md: which single-scattering albedo has which colour, and
how far formulas in use are off. Usage: subsurface.py"""

import numpy as np

from miebrdf import layer_albedos, subsurface_albedo, subsurface_colour

COLOURS = np.linspace(0.005, 0.995, 199)


def kulla_conty(colour, g):
    s = 4.09712 + 4.20863 * colour - np.sqrt(9.59217 + 41.6808 * colour + 17.7126 * colour**2)
    return (1 - s * s) / (1 - g * s * s)


def hyperion(colour):
    return 1 - np.exp(-5.09406 * colour + 2.61188 * colour**2 - 4.31805 * colour**3)


def coefficients(g, n):
    """a and b of colour = (1 - s) (1 - a s) / (1 + b s), s^2 = (1 - w) / (1 - g w)."""
    if n == 1:
        return 0.0918 + 0.1899 * g - 0.1264 * g**2, 1.2255 - 0.2255 * g + 0.1418 * g**2
    k = n - 1
    return (
        0.4132 + 0.4238 * g - 0.1124 * g**2 + 0.1719 * k,
        0.9138 - 0.4758 * g + 5.2831 * k + 3.3795 * k**2,
    )


def formula(colour, g, n):
    """The albedo by solving the formula for s: a s^2 - (1 + a + b c) s + 1 - c = 0."""
    a, b = coefficients(g, n)
    half = 1 + a + b * colour
    s = 2 * (1 - colour) / (half + np.sqrt(half**2 - 4 * a * (1 - colour)))
    return (1 - s * s) / (1 - g * s * s)


def error(albedo, g, n=1.0):
    seen = subsurface_colour(np.clip(albedo, 0, 1), g, host_index=n, tolerance=1e-5)
    return np.max(np.abs(seen - COLOURS))


def error_at_normal(albedo, g):
    seen = layer_albedos(np.clip(albedo, 0, 1), g, mu_in=1.0, tolerance=1e-5).plane_albedo
    return np.max(np.abs(seen - COLOURS))


print("colour: albedo, of g and index 0, 1; 0.5, 1; 0.9, 1; 0, 1.5; 0.9, 1.5")
for c in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95):
    row = [
        subsurface_albedo(c, g, host_index=n, tolerance=1e-6)
        for g, n in ((0, 1), (0.5, 1), (0.9, 1), (0, 1.5), (0.9, 1.5))
    ]
    print(f"| {c} | " + " | ".join(f"{w:.5f}" for w in row) + " |")
print("largest error of the colour:")
for g in (-0.5, 0.0, 0.5, 0.9, 0.98):
    print(f"g {g}, no boundary: Kulla-Conty {error(kulla_conty(COLOURS, g), g):.4f}, formula "
          f"{error(formula(COLOURS, g, 1), g):.5f}; of light along the normal: "
          f"{error_at_normal(kulla_conty(COLOURS, g), g):.3f}")
for n in (1.2, 1.33, 1.5, 1.8, 2.0):
    for g in (0.0, 0.9):
        print(f"index {n}, g {g}: Kulla-Conty {error(kulla_conty(COLOURS, g), g, n):.3f}, formula "
              f"{error(formula(COLOURS, g, n), g, n):.4f}")
print(f"Hyperion, g 0, no boundary: {error(hyperion(COLOURS), 0.0):.3f}, of light along the normal "
      f"{error_at_normal(hyperion(COLOURS), 0.0):.3f}; index 1.5 {error(hyperion(COLOURS), 0.0, 1.5):.3f}")
