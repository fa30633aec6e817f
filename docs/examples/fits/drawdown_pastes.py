"""Pastes from paints drawn down over black and white cards, alone and mixed by weight with a white and a
black: rows `name, pigments, weight_ratio, series, then a column for each wavelength` (tab-separated, #
comments; reflectances in percent with the mirror part; series b, w: the bare cards, ob, ow: the paint over
them). Usage: drawdown_pastes.py DRAWDOWNS.tsv > pastes.csv

Each paint is one fit to all of its films, as docs/tutorials/paste.md does it for one: isotropic scattering
in a film of the unit thickness (1 mm stands for one drawdown) below a smooth boundary of index 1.5. The
white is known of its own film, the black of its mixtures with the white.
"""

import csv
import pathlib
import sys
import tempfile

import miebrdf
import numpy as np

# Names in the data of paints whose colour is no fluorescence; the first two are what others are mixed with.
NAMES = {"ZincWhite": "zinc_white", "BoneBlack": "bone_black", "Cochineal": "cochineal", "Minium": "minium",
         "Vermillion": "vermilion", "ViridianGreen": "viridian", "EmeraldGreen": "emerald_green",
         "UltramarineBlue": "ultramarine", "CobaltBlue": "cobalt_blue", "BariumSulphate": "barium_sulphate"}
BARE = "hg:0,0 in index:1.5@0"

with open(sys.argv[1]) as lines:
    rows = list(csv.DictReader((x for x in lines if x[0] != "#"), delimiter="\t"))
nm = [float(key) for key in rows[0] if key.isdigit()]
spectra, films = {}, {}
for row in rows:
    spectra[row["name"], row["series"]] = [float(row[f"{w:g}"]) / 100 for w in nm]
    parts = dict(zip(row["pigments"].split("-"), map(float, row["weight_ratio"].split("-"))))
    films[row["name"]] = {paint: part / sum(parts.values()) for paint, part in parts.items() if part > 0}

folder = pathlib.Path(tempfile.mkdtemp())
known = {}
print("name,wavelength_nm,mu_s_reduced,mu_a")
for paint, name in NAMES.items():
    data, mixed_with = [], [other for other in list(NAMES)[:2] if other in known]
    for film, parts in films.items():
        if paint not in parts or any(other != paint and other not in mixed_with for other in parts):
            continue
        words = [f"paste:{known[other]},volume={part:.9g}" for other, part in parts.items() if other != paint]
        words.append("turbid:{mu_a},{mu_s_reduced},0" + (f",volume={parts[paint]:.9g}" if words else ""))
        for series, coat, card in (("b", BARE, "black"), ("w", BARE, "white"),
                                   ("ob", None, "black"), ("ow", None, "white")):
            scene = {"coat": coat or " + ".join(words) + " in index:1.5@1mm", "substrate": f"lambert:{{{card}}}"}
            data.append({"name": f"{film} {series}", "values": spectra[film, series], "wavelength_nm": nm,
                         "quantity": "d8-sci", "sigma": 0.002, "scene": scene})
    found = miebrdf.fit({"scene": {"boundary": "smooth"}, "measured": data, "fit": {"starts": 1},
                         "unknowns": {"mu_a": "per wavelength, 1 in 1e-3:1e4 log",
                                      "mu_s_reduced": "per wavelength, 5 in 1e-3:1e4 log",
                                      "black": "per wavelength, 0.02 in 0.0001:0.5 log",
                                      "white": "per wavelength, 0.9 in 0.3:0.9999 log1m"}})
    scattering, absorption = np.array(found["mu_s_reduced"]), np.array(found["mu_a"])
    # Films that all hide their ground tell a ratio alone: the scattering is the neighbour's there.
    error = np.array(found.standard_error("mu_a"))
    is_known = error < 0.3 * absorption
    is_known |= (absorption <= 1.001e-3) | (scattering <= 1.001e-3)
    for w in np.flatnonzero(~is_known):
        nearest = np.flatnonzero(is_known)[np.argmin(abs(np.flatnonzero(is_known) - w))]
        absorption[w] *= scattering[nearest] / scattering[w]
        scattering[w] = scattering[nearest]
    table = [f"{w:g},{s:.4g},{a:.4g}" for w, s, a in zip(nm, scattering, absorption)]
    known[paint] = folder / f"{name}.csv"
    known[paint].write_text("\n".join(["wavelength_nm,mu_s_reduced,mu_a", *table]) + "\n")
    print("\n".join(f"oil_{name},{line}" for line in table))
    misses = np.array(found.residuals["model"]) - np.array(found.residuals["value"])
    painted = np.array([label.split()[1].startswith("o") for label in found.residuals["data"]])
    print(f"{name}: misses {len(data) // 4} films by {np.sqrt(np.mean(misses[painted] ** 2)):.4f} (rms); "
          f"a ratio alone at {(~is_known).sum()} wavelengths", file=sys.stderr)
