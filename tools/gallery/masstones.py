#!/usr/bin/env python3
"""Masstones and tints of every coloured material and paste of the program -> an SVG picture, and a table.

    masstones.py PICTURE.svg TABLE.csv [PROGRAM]

Masstone: spheres of 0.1 um, 15 % of a binder of index 1.5, below a smooth boundary, light at 8 degrees with the
mirror part, D65, 10 degrees. Tint: one part with nine parts of titanium white (TiO2_pigment, 0.125 um) by volume.
Pastes: alone, and one part with nine of the white of their set. Materials whose masstone is white or grey as
light as white (L* above 97, chroma below 3) are left out; k that is not known is 0.
"""
import csv
import subprocess
import sys

PROGRAM = sys.argv[3] if len(sys.argv) > 3 else "miebrdf"
COLUMNS, WIDTH, HEIGHT, HEAD = 6, 188, 52, 40


def rows_of(*words):
    run = subprocess.run([PROGRAM, *words, "--quiet"], capture_output=True, text=True)
    return list(csv.DictReader(line for line in run.stdout.splitlines() if not line.startswith("#")))


def colour(*medium):
    """Lab and sRGB of light at 8 degrees, or nothing where the table does not cover 400 to 700 nm."""
    rows = rows_of("albedo", "--boundary", "smooth", *medium, "--theta-in", "8", "--wavelengths", "400:700:10",
                   "--colour", "d65,10", "--missing-k-zero", "--stokes", "1")
    if not rows:
        return None
    values = [float(rows[0][key]) for key in ("lab_l", "lab_a", "lab_b", "srgb_red", "srgb_green", "srgb_blue")]
    return values[:3], "#" + "".join(f"{round(255 * min(max(x, 0), 1)):02x}" for x in values[3:])


def materials():
    for row in rows_of("materials", "list"):
        name = row["name"]
        masstone = colour("--base", f"{name},radius=0.1,volume=15% in index:1.5")
        if masstone is None:
            continue
        lightness, a, b = masstone[0]
        if lightness > 97 and a * a + b * b < 9:
            continue
        note = {r["property"]: r["value"] for r in reversed(rows_of("materials", "show", name))}.get("note", "")
        tint = colour("--base", f"{name},radius=0.1,volume=1.5% + TiO2_pigment,radius=0.125,volume=13.5% in index:1.5")
        yield name, masstone, tint, "not for colours" in note


def pastes(names):
    for name in names:
        # Films of the oil paints' own thickness are not opaque; bases are.
        white = "acrylic_white" if name.startswith("acrylic") else "oil_zinc_white"
        masstone = colour("--base", f"paste:{name} in index:1.5")
        tint = colour("--base", f"paste:{name},volume=10% + paste:{white},volume=90% in index:1.5")
        yield "paste:" + name, masstone, tint, False


def paste_names():
    run = subprocess.run([PROGRAM, "albedo", "--base", "paste:?", "--wavelengths", "550"], capture_output=True, text=True)
    words = run.stderr.replace(",", " ").replace(";", " ").split()
    return sorted(word for word in words if word.startswith(("acrylic_", "oil_")))


found = [*materials(), *pastes(paste_names())]
with open(sys.argv[2], "w") as file:
    file.write("name,masstone_l,masstone_a,masstone_b,tint_l,tint_a,tint_b,not_for_colours\n")
    for name, (masstone, _), (tint, _), flagged in found:
        numbers = ",".join(f"{x:.1f}" for x in masstone + tint)
        file.write(f"{name},{numbers},{'yes' if flagged else 'no'}\n")
height = HEAD + HEIGHT * -(-len(found) // COLUMNS) + 8
parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{COLUMNS * WIDTH + 12}" height="{height}" '
         'font-family="sans-serif" font-size="11">', '<rect width="100%" height="100%" fill="#fff"/>',
         '<text x="8" y="24" font-size="15">Masstone (left) and tint of one part in ten (right); crossed: not for colours</text>']
for i, (name, (_, masstone), (_, tint), flagged) in enumerate(found):
    x, y = 8 + WIDTH * (i % COLUMNS), HEAD + HEIGHT * (i // COLUMNS)
    for j, fill in enumerate((masstone, tint)):
        parts.append(f'<rect x="{x + 88 * j}" y="{y}" width="88" height="32" fill="{fill}"/>')
    parts.append(f'<rect x="{x}" y="{y}" width="176" height="32" fill="none" stroke="#999" stroke-width=".5"/>')
    if flagged:
        parts.append(f'<path d="M{x} {y}l176 32m0 -32l-176 32" stroke="#f33" stroke-width="1.5"/>')
    parts.append(f'<text x="{x}" y="{y + 45}" fill="{"#b00" if flagged else "#222"}">{name}</text>')
with open(sys.argv[1], "w") as file:
    file.write("\n".join([*parts, "</svg>"]) + "\n")
