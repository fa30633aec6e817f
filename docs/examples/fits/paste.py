"""From the fit of a drawdown (miebrdf fit drawdown.toml -o FIT.csv) to a paste that mixes: scattering per
film of its own kind, as a file for scattering:FILE. Usage: paste.py FIT.csv > PASTE.csv

Where the film hides its ground the fit knows the albedo alone. Scattering of a paste is smooth in
wavelength, so that it is taken from the neighbours there, and absorption follows from the albedo.
"""

import csv
import math
import sys

LEAST_KNOWN = 0.3  # of a depth: a standard error above this share of it says nothing

with open(sys.argv[1]) as lines:
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
albedo, depth = (
    {float(row["wavelength_nm"]): row for row in rows if row["unknown"] == name}
    for name in ("albedo", "depth")
)
scattering = {
    nm: float(albedo[nm]["value"]) * float(row["value"])
    for nm, row in depth.items()
    if row["standard_error"] and float(row["standard_error"]) < LEAST_KNOWN * float(row["value"])
}


def scattering_at(nm):
    """Linear in its logarithm between wavelengths where it is known, and the nearest beyond."""
    low = max((k for k in scattering if k <= nm), default=min(scattering))
    high = min((k for k in scattering if k >= nm), default=max(scattering))
    t = 0.0 if high == low else (nm - low) / (high - low)
    return math.exp((1 - t) * math.log(scattering[low]) + t * math.log(scattering[high]))


print("wavelength_nm,single_scattering_albedo,extinction_um2,angle_deg,p11")
for nm, row in sorted(albedo.items()):
    share = float(row["value"])
    for angle in (0, 90, 180):
        print(f"{nm:g},{share:.7f},{scattering_at(nm) / share:.6g},{angle},1")
