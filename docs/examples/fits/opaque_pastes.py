"""Pastes from opaque patches of paint alone (masstone) and mixed with white by weight (tint):
reflectances in percent as rows `name, series, paint_to_white, then a column for each wavelength`
(tab-separated, # comments), the white first. Usage:
    opaque_pastes.py PATCHES.tsv [PROGRAM] > pastes.csv

A patch that hides its ground tells the ratio of absorption to reduced scattering alone, so that the
scattering of the white is the unit (1 per mm), at every wavelength. A tint of weights p : w has
    (p a_p + w a_w) / (p s_p + w s_w) = r,
which with the masstone's a_p = r_p s_p gives s_p = w (r s_w - a_w) / (p (r_p - r)).
Reflectances are hemispherical at 8 degrees without the mirror part, of isotropic scattering below a
smooth boundary of index 1.5.
"""

import csv
import math
import subprocess
import sys

program = sys.argv[2] if len(sys.argv) > 2 else "miebrdf"


def reflectance(albedo):
    words = [program, "albedo", "--boundary", "smooth", "--base", f"hg:{albedo!r},0 in index:1.5"]
    words += ["--theta-in", "8", "--wavelengths", "550", "--tolerance", "1e-4", "--quiet"]
    lines = subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines()
    row = next(csv.DictReader(line for line in lines if not line.startswith("#")))
    return float(row["plane_albedo"]) - float(row["mirror_reflectance"])


# log(absorption / scattering) against reflectance, brightest last.
LOGS = [8 - 0.25 * i for i in range(81)]
KNOWN = [(reflectance(1 / (1 + math.exp(x))), x) for x in LOGS]


def ratio(seen):
    """Absorption over reduced scattering; the darkest patches have that of the end of the table."""
    if seen <= KNOWN[0][0]:
        return math.exp(KNOWN[0][1])
    for (low, x), (high, y) in zip(KNOWN, KNOWN[1:]):
        if seen <= high:
            t = (math.log(seen) - math.log(low)) / (math.log(high) - math.log(low))
            return math.exp(x + t * (y - x))
    return math.exp(KNOWN[-1][1])


with open(sys.argv[1]) as lines:
    rows = list(csv.DictReader((x for x in lines if x[0] != "#"), delimiter="\t"))
wavelengths = [key for key in rows[0] if key.isdigit()]
ratios = {(row["name"], row["series"]): [ratio(float(row[nm]) / 100) for nm in wavelengths] for row in rows}
weights = {row["name"]: row["paint_to_white"].split(":") for row in rows if row["series"] == "tint"}
white = rows[0]["name"]
print("name,wavelength_nm,mu_s_reduced,mu_a")
for name in [white, *weights]:
    for i, nm in enumerate(wavelengths):
        a_white = ratios[white, "masstone"][i]
        scattering, absorption = 1.0, a_white
        if name != white:
            p, w = map(float, weights[name])
            alone, tint = ratios[name, "masstone"][i], ratios[name, "tint"][i]
            # Where paint and tint are as bright as the white its scattering does not show: the unit.
            if alone > tint > a_white:
                scattering = w * (tint - a_white) / (p * (alone - tint))
            absorption = alone
        key = "acrylic_" + name.replace(" ", "_")
        print(f"{key},{nm},{scattering:.4g},{absorption * scattering:.4g}")
