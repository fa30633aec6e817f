#!/usr/bin/env python3
"""n and k of white pigments: n of the crystal, k of paints -> pigments/.

    white_pigments.py [PROGRAM]

n is (2 o + e) / 3 of both rays by dispersion formulas (TiO2: Devore 1951, measured from 436 nm; ZnO: Bond
1965, from 450 nm), continued to where the files begin. k is the one with which spheres in a binder of index
1.5 have the ratio of absorption to reduced scattering of a white paint: that of the pastes acrylic_white and
oil_zinc_white (pipeline/scene/pastes.csv), and below 430 nm, where rutile begins to absorb, that of titanium
white in the Artist Paint Spectral Database (R. S. Berns, Rochester Institute of Technology; as K and S in
Unicolour 4bf3d8cf, MIT licence). Whatever else absorbs in these paints, binder and impurities, is part of k.
"""
import csv
import pathlib
import subprocess
import sys

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "miebrdf"
DATA = pathlib.Path(__file__).resolve().parent
# Titanium white: Kubelka and Munk's K / S, which is 8/3 of absorption over reduced scattering.
EDGE = {380: 0.530000769, 390: 0.227441171, 400: 0.0498131121, 410: 0.00576033030, 420: 0.000366131570}


def titanium_dioxide(nm):
    x = (nm / 1000) ** 2
    return (2 * (5.913 + 0.2441 / (x - 0.0803)) ** 0.5 + (7.197 + 0.3322 / (x - 0.0843)) ** 0.5) / 3


def zinc_oxide(nm):
    x = (nm / 1000) ** 2
    ordinary = 2.81418 + 0.87968 * x / (x - 0.3042**2) - 0.00711 * x
    extraordinary = 2.80333 + 0.94470 * x / (x - 0.3004**2) - 0.00714 * x
    return (2 * ordinary**0.5 + extraordinary**0.5) / 3


def ratio_of(n, k, nm, radius):
    """Absorption over reduced scattering of spheres in a binder of 1.5."""
    words = [PROGRAM, "layers", "--substrate", "black", "--wavelengths", str(nm), "--quiet", "--coat",
             f"index:{n!r},{k!r},radius={radius},volume=10% in index:1.5@1um", "--mie-tolerance", "1e-4"]
    lines = subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines()
    row = next(csv.DictReader(line for line in lines if not line.startswith("#")))
    return float(row["absorption_per_um"]) / float(row["reduced_scattering_per_um"])


def absorption_index(n, nm, radius, wanted):
    k = 1e-5
    for _ in range(8):  # nearly proportional
        k *= wanted / ratio_of(n, k, nm, radius)
    return k


def paste(name):
    with open(DATA.parents[1] / "pipeline" / "scene" / "pastes.csv") as lines:
        rows = [row for row in csv.DictReader(x for x in lines if x[0] != "#") if row["name"] == name]
    return {int(row["wavelength_nm"]): float(row["mu_a"]) / float(row["mu_s_reduced"]) for row in rows}


def write(file, index, longest, radius, ratios):
    lines = ["wavelength_nm,n", *(f"{nm},{index(nm):.4f}" for nm in range(min(ratios), longest + 1, 10))]
    lines += ["wavelength_nm,k"]
    lines += [f"{nm},{absorption_index(index(nm), nm, radius, ratio):.3g}" for nm, ratio in sorted(ratios.items())]
    (DATA / "pigments" / file).write_text("\n".join(lines) + "\n")


titanium = {nm: ratio for nm, ratio in paste("acrylic_white").items() if nm >= 430}
titanium.update({nm: 3 / 8 * ks for nm, ks in EDGE.items()})
write("titanium_white.csv", titanium_dioxide, 1530, 0.125, titanium)
write("zinc_white.csv", zinc_oxide, 4000, 0.15, paste("oil_zinc_white"))
