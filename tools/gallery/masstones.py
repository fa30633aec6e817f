#!/usr/bin/env python3
"""Masstones and tints of every coloured material and paste of the program -> an SVG picture, and a table.

    masstones.py PICTURE.svg TABLE.csv [PROGRAM]

Masstone: spheres of 0.1 um, 15 % of a binder of index 1.5, below a smooth boundary, light at 8 degrees with the
mirror part, D65, 10 degrees. Tint: one part with nine parts of titanium white (TiO2_pigment, 0.125 um) by volume.
Pastes: alone, and one part with nine of the white of their set. Materials whose masstone is white or grey as
light as white (L* above 97, chroma below 3) are left out; k that is not known is 0.
"""
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile

PROGRAM = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else "miebrdf"
TITLE = "Masstones, each beside its tint of one part in ten"
HEAD = 'boundary = "smooth"\nhost-index = 1.5\nstokes = 1\nmissing-k-zero = true\nwavelengths = "400:700:10"\n'


def run(*words, folder=None):
    """Rows, facts and messages of one command."""
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=folder)
    lines = done.stdout.splitlines()
    return list(csv.DictReader(x for x in lines if x[:1] != "#")), [x for x in lines if x[:1] == "#"], done.stderr


def swatches(bases, picture=None):
    # The picture keeps the command that made it: no names of this machine in it.
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "masstones.toml"), "w") as file:
            file.write(HEAD)
            for name, base in bases.items():
                file.write(f"[scene.{json.dumps(name)}]\nbase = {json.dumps(base)}\n")
        words = ["swatches", "masstones.toml", "--colour", "d65,10", "--title", TITLE]
        if picture:
            run(*words, "-o", "masstones.svg", folder=folder)
            shutil.move(os.path.join(folder, "masstones.svg"), picture)
        return run(*words, folder=folder)


def lab(row):
    return [float(row[key]) for key in "Lab"]


masstones, tints = {}, {}
for row in run("materials", "list")[0]:
    if float(row["shortest_nm"]) <= 400 and float(row["longest_nm"]) >= 700:
        name = row["name"]
        masstones[name] = f"{name},radius=0.1,volume=15%"
        tints[name] = f"{name},radius=0.1,volume=1.5% + TiO2_pigment,radius=0.125,volume=13.5%"
for row in swatches(masstones)[0]:
    lightness, a, b = lab(row)
    if lightness > 97 and a * a + b * b < 9:
        del masstones[row["name"]]
known = run("albedo", "--base", "paste:?", "--wavelengths", "550")[2].replace(",", " ").replace(";", " ").split()
for name in sorted(word for word in known if word.startswith(("acrylic_", "oil_"))):
    white = "acrylic_white" if name.startswith("acrylic") else "oil_zinc_white"
    masstones[name] = f"paste:{name}"
    tints[name] = f"paste:{name},volume=10% + paste:{white},volume=90%"
pairs = {}
for name, base in masstones.items():
    pairs |= {name: base, name + " tint": tints[name]}
rows, facts, _ = swatches(pairs, picture=sys.argv[1])
with open(sys.argv[2], "w") as file:
    file.write("name,masstone_l,masstone_a,masstone_b,tint_l,tint_a,tint_b,not_for_colours\n")
    for masstone, tint in zip(rows[::2], rows[1::2]):
        numbers = ",".join(f"{x:.1f}" for x in lab(masstone) + lab(tint))
        flagged = any(fact.startswith(f"# note: {masstone['name']}: ") and "not for colours" in fact for fact in facts)
        base = masstones[masstone["name"]]
        name = base if base.startswith("paste:") else masstone["name"]
        file.write(f"{name},{numbers},{'yes' if flagged else 'no'}\n")
