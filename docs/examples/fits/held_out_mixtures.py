"""Mixtures of paints predicted from the rest of their family, by exact transfer and by Kubelka and Munk's theory
with Saunderson's correction: the same data, the same unknowns, the same search, another film.
Usage: held_out_mixtures.py DRAWDOWNS.tsv [PROGRAM]     (needs numpy, scipy and the Python package)

DRAWDOWNS.tsv as of drawdown_pastes.py. A paint has a scattering and an absorption coefficient at each
wavelength; those of a mixture are sums by weight; all films are equally thick. Those of the white and the black
come from their own films. Each mixture of a coloured paint with one of them is left out in turn: the
coefficients of the paint come from its other films, residuals counting as 0.002 + 2 %. Printed are CIEDE2000
(D65, 10 degrees) of the film predicted over black and over white.
"""

import csv
import subprocess
import sys
import tempfile

import numpy as np
from miebrdf import colour
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import least_squares

PROGRAM = sys.argv[2] if len(sys.argv) > 2 else "miebrdf"
PAINTS = ["ZincWhite", "BoneBlack", "Cochineal", "Minium", "Vermillion", "ViridianGreen", "EmeraldGreen",
          "UltramarineBlue", "CobaltBlue"]
FIRST, INSIDE = 0.0400, 0.5964  # of light at 8 degrees from air, of diffuse light from inside (Fresnel, 1.5)


def kubelka_munk(absorption, scattering, ground):
    a = 1 + absorption / scattering
    b = np.sqrt(a * a - 1)
    coth = 1 / np.tanh(np.clip(b * scattering, 1e-9, 300))
    film = (1 - ground * (a - b * coth)) / (a - ground + b * coth)
    return 0.04 + 0.96 * 0.4 * film / (1 - 0.6 * film)


class Exact:
    """Isotropic scattering below a smooth boundary of index 1.5, from a table over the reduced scattering and
    the ratio of absorption to it. Over a ground of albedo g a film has R0 + T g / (1 - g B)."""

    def __init__(self):
        ratio, depth, grounds = np.linspace(-9, 9.5, 75), np.linspace(np.log(0.01), np.log(2000), 41), (0, 0.5, 0.95)
        table = tempfile.NamedTemporaryFile("w", suffix=".csv", delete=False)
        rows = "\n".join(f"{400 + i},1,{np.exp(x):.12g}" for i, x in enumerate(ratio))
        table.write(f"wavelength_nm,mu_s_reduced,mu_a\n{rows}\n")
        table.close()
        seen = np.array([[self.reflectances(table.name, np.exp(x), g, 399 + len(ratio)) for x in depth] for g in grounds])
        low, high = ((seen[i] - seen[0]) / grounds[i] for i in (1, 2))
        back = np.where(low > 1e-7, (high - low) / np.maximum(high * grounds[2] - low * grounds[1], 1e-12), 0.9)
        through = np.maximum(low * (1 - grounds[1] * np.clip(back, 0, 0.9999)), 1e-12)
        self.black = RectBivariateSpline(depth, ratio, np.log(seen[0] - 0.0399))
        self.through = RectBivariateSpline(depth, ratio, np.log(through), kx=1, ky=1)
        self.back = RectBivariateSpline(depth, ratio, np.clip(back, 0, 0.9999), kx=1, ky=1)
        self.ends = [(depth[0], depth[-1]), (ratio[0], ratio[-1])]

    @staticmethod
    def reflectances(paste, depth, ground, last):
        words = [PROGRAM, "albedo", "--boundary", "smooth", "--coat", f"paste:{paste} in index:1.5@{depth:.9g}mm",
                 "--substrate", f"lambert:{ground}", "--theta-in", "8", "--wavelengths", f"400:{last}:1",
                 "--tolerance", "1e-4", "--stokes", "1", "--quiet"]
        lines = subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines()
        return [float(r["plane_albedo"]) for r in csv.DictReader(x for x in lines if x[0] != "#") if r["plane_albedo"]]

    def __call__(self, absorption, scattering, ground):
        at = [np.clip(x, *ends) for x, ends in zip((np.log(scattering), np.log(absorption / scattering)), self.ends)]
        return 0.0399 + np.exp(self.black.ev(*at)) + np.exp(self.through.ev(*at)) * ground / (1 - ground * self.back.ev(*at))


with open(sys.argv[1]) as lines:
    rows = list(csv.DictReader((x for x in lines if x[0] != "#"), delimiter="\t"))
nm = [float(key) for key in rows[0] if key.isdigit()]
spectra = {(r["name"], r["series"]): np.array([float(r[f"{w:g}"]) / 100 for w in nm]) for r in rows}
shares = {}
for r in rows:
    parts = dict(zip(r["pigments"].split("-"), map(float, r["weight_ratio"].split("-"))))
    if set(parts) <= set(PAINTS):
        shares[r["name"]] = np.array([parts.get(p, 0.0) for p in PAINTS]) / sum(parts.values())
films = list(shares)
# The bare card's own surface is taken away: the paint is in optical contact with it.
cards = {key: np.clip((x - FIRST) / (1 - FIRST), 1e-4, 1) for key, x in spectra.items() if key[1] in "bw"}
cards = {key: x / (1 - INSIDE + INSIDE * x) for key, x in cards.items()}


def coefficients(film, trained, known, paints):
    """Adds (2, wavelengths), logarithms of absorption and scattering, of these paints to the known ones. A weak
    pull to 1 and 5 keeps those finite that the films do not determine."""
    weights = np.array([shares[n] for n in trained])
    found = np.array(known)
    rest = np.log(np.repeat([1.0, 5.0], len(paints)))
    for w in range(len(nm)):
        ground = np.array([[cards[n, s][w] for n in trained] for s in "bw"])
        seen = np.array([[spectra[n, "o" + s][w] for n in trained] for s in "bw"])

        def misses(x):
            logs = known[:, :, w].copy()
            logs[:, paints] = x.reshape(2, -1)
            a, s = (weights @ np.exp(y) for y in logs)
            return np.concatenate([((film(a, s, ground) - seen) / (0.002 + 0.02 * seen)).ravel(), 0.01 * (x - rest)])

        found[:, paints, w] = least_squares(misses, rest).x.reshape(2, -1)
    return found


print("method,mixture,over,de2000")
for name, film in (("exact", Exact()), ("Kubelka-Munk", kubelka_munk)):
    white_and_black = [n for n in films if shares[n][:2].sum() == 1]
    known = coefficients(film, white_and_black, np.zeros((2, len(PAINTS), len(nm))), [0, 1])
    differences = []
    for held in (n for n in films if n not in white_and_black and n[-1] != "A"):
        paint = int(np.flatnonzero(shares[held][2:])[0]) + 2
        family = [n for n in films if shares[n][paint] > 0 and n != held]
        a, s = (shares[held] @ np.exp(y) for y in coefficients(film, family, known, [paint]))
        for over in "bw":
            labs = [colour.lab(x, nm, illuminant="d65,10") for x in (film(a, s, cards[held, over]), spectra[held, "o" + over])]
            differences.append(float(colour.delta_e_2000(*labs)))
            print(f"{name},{held},{'black' if over == 'b' else 'white'},{differences[-1]:.2f}", flush=True)
    print(f"# {name}: median {np.median(differences):.2f}, 90 % {np.percentile(differences, 90):.1f}, "
          f"worst {max(differences):.1f}", flush=True)
