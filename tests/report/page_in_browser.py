"""Opens pages of `miebrdf report` in headless Chromium, as a user does from a file, and compares
what they show with the program's own tables and pictures.

    page_in_browser.py MIEBRDF CHROMIUM HAS_RENDER(0|1)
"""

import csv
import html
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import zlib

PROGRAM, CHROMIUM, HAS_RENDER = sys.argv[1], sys.argv[2], sys.argv[3] == "1"
WAVELENGTHS = "400:700:10"
# Small particles, so that the scenes are solved in seconds.
# Finer than by default: the page and the tables below are solved at different directions, each to
# its tolerance.
TOLERANCE = "2e-4"
GOLD = ["--base", "TiO2,radius=0.13,variance=0.05", "--coat", "Au,radius=0.03,variance=0.05@0.5",
        "--roughness", "0.3", "--tolerance", TOLERANCE]
GLOSSY = ["--base", "TiO2,radius=0.13,variance=0.05 in index:1.5", "--boundary", "smooth",
          "--tolerance", TOLERANCE]
DROPLETS = ["--base", "index:1.33,0.01,radius=2,variance=0.1", "--tolerance", "1e-3"]
DIRECTIONS = [(0, 10, 0), (30, 45, 0), (30, 40, 60), (60, 50, 0), (75, 80, 20), (45, 45, 180)]
# The program's promise for the page, of the largest value at an incidence.
ALLOWED = 1e-3

failures = []


def check(holds, what):
    print(("ok      " if holds else "FAILED  ") + what)
    if not holds:
        failures.append(what)


def run(*words):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def table(*words):
    lines = [line for line in run(*words).splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def open_page(path, directions, more="", size="1280,900"):
    """The page's report of itself, and what the browser's console said."""
    asked = ";".join(",".join(str(v) for v in d) for d in directions)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        done = subprocess.run(
            ["timeout", "200", CHROMIUM, "--headless", "--no-sandbox", "--disable-quic",
             "--no-first-run", "--disable-background-networking", "--disable-component-update",
             "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             f"--user-data-dir={profile}", f"--window-size={size}", "--virtual-time-budget=60000",
             "--enable-logging=stderr", "--dump-dom",
             f"file://{path}?selftest={asked}{more}"],
            capture_output=True, text=True, check=False)
    found = re.search(r'<pre id="selftest"[^>]*>(.*?)</pre>', done.stdout, re.S)
    if not found or not found.group(1):
        sys.exit(f"{path}: no report of the page\n{done.stderr[-2000:]}")
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    return json.loads(html.unescape(found.group(1))), console


def check_values(name, scene, shown, number):
    """BRDF spectra of a page against `miebrdf brdf`."""
    worst, same = 0.0, True
    for value in shown["values"]:
        mu_in = math.cos(math.radians(value["thetaIn"]))
        mu_out = math.cos(math.radians(value["thetaOut"]))
        cosines = [repr(mu_out)] + [str(m) for m in (0.06, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95)
                                    if abs(m - mu_out) > 1e-9]
        azimuths = [str(value["azimuth"])] + [str(a) for a in (0, 45, 90, 135, 180)
                                              if a != value["azimuth"]]
        rows = table("brdf", *scene, "--wavelengths", WAVELENGTHS, "--mu-in", repr(mu_in),
                     "--mu-out", ",".join(cosines), "--azimuth", ",".join(azimuths))
        per_wavelength = len(cosines) * len(azimuths)
        for w, here in enumerate(value["spectra"][number]):
            block = [float(r["brdf"]) for r in rows[w * per_wavelength:(w + 1) * per_wavelength]]
            worst = max(worst, abs(here - block[0]) / max(block))
        at = round((shown["wavelength_nm"] - 400) / 10)
        shown_here = value["spectra"][number][at]
        same = same and value["shown"][number][0] == shown_here
        same = same and abs(value["single"][number] - shown_here) <= 1e-9 * shown_here
    check(same, f"{name}: values and cuts show the spectrum at {shown['wavelength_nm']} nm")
    check(worst <= ALLOWED, f"{name}: BRDF as in `brdf` (worst {worst:.1e} of the largest)")


def check_albedo(name, scene, shown, number):
    page = shown["albedo"][number]
    mu = repr(math.cos(math.radians(page["incidence_deg"])))
    rows = table("albedo", *scene, "--wavelengths", WAVELENGTHS, "--mu-in", mu)
    for key in ("plane", "spherical"):
        worst = max(abs(v - float(r[f"{key}_albedo"])) for v, r in zip(page[key], rows))
        check(worst <= ALLOWED, f"{name}: {key} albedo as in `albedo` ({worst:.1e})")
    colour = table("albedo", *scene, "--wavelengths", WAVELENGTHS, "--mu-in", mu, "--colour", "d65")
    wanted = [float(colour[0][k]) for k in ("lab_l", "lab_a", "lab_b")]
    here = next(c["values"] for c in shown["colours"] if c["of"] == f"{number}-lamp")[3:]
    worst = max(abs(a - b) for a, b in zip(wanted, here))
    check(worst <= 0.05, f"{name}: Lab of the albedo as in `albedo --colour d65` ({worst:.1e})")


def read_png(path):
    """Rows of RGBA of an 8-bit PNG that is not interlaced."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", chunk[:10])
            assert (depth, colour) == (8, 6), "wanted: 8-bit RGBA"
        packed += chunk if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride, above, rows = zlib.decompress(packed), 4 * width, bytes(4 * width), []
    for y in range(height):
        kind = raw[y * (stride + 1)]
        line = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = (line[i - 4] if i >= 4 else 0), above[i], (above[i - 4] if i >= 4 else 0)
            p = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, p)[kind]) & 255
        rows.append(bytes(line))
        above = rows[-1]
    return rows


def linear(byte):
    v = byte / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def mean_of_png(path):
    total, count = [0.0, 0.0, 0.0], 0
    for row in read_png(path):
        for x in range(0, len(row), 4):
            if row[x + 3] == 255:
                count += 1
                for c in range(3):
                    total[c] += linear(row[x + c])
    return [v / count for v in total]


def lab(rgb):
    to_xyz = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
    white = (0.9505, 1.0, 1.089)
    f = []
    for row, w in zip(to_xyz, white):
        t = sum(a * b for a, b in zip(row, rgb)) / w
        f.append(t ** (1 / 3) if t > 216 / 24389 else (24389 / 27 * t + 16) / 116)
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


def check_picture(name, scene, picture, folder):
    png = os.path.join(folder, "picture.png")
    # The lamp of the page's self-test; the same exposure, so that both clip at the same value.
    run("render", *scene, "--wavelengths", WAVELENGTHS, "--light", "directional:30,-35",
        "--field-of-view", "0", "--size", "160,160", "--samples", "16", "--bounces", "1",
        "--exposure", "-1", "--background", "transparent", "--quiet", "-o", png)
    a, b = lab(mean_of_png(png)), lab(picture["rgb"])
    # At such distances CIE 1976's is the larger of the two measures.
    distance = math.dist(a, b)
    check(distance <= 2, f"{name}: mean colour of the sphere as in `render` (dE {distance:.2f})")


def check_pair(folder):
    scenes = [("gold", GOLD), ("glossy", GLOSSY)]
    files = []
    for name, words in scenes:
        files.append(os.path.join(folder, f"{name}.toml"))
        with open(files[-1], "w", encoding="utf-8") as file:
            for key, value in zip(words[:-2:2], words[1::2]):
                text = f'["{value}"]' if key == "--coat" else f'"{value}"'
                file.write(f"{key[2:]} = {text}\n")
            file.write(f"tolerance = {TOLERANCE}\n")
            file.write('[[result]]\ncommand = "albedo"\n')
    page = os.path.join(folder, "pair.html")
    run("report", *files, "--wavelengths", WAVELENGTHS, "--quiet", "-o", page)
    size = os.path.getsize(page)
    check(size <= 2e6, f"a pair at 31 wavelengths is {size / 1e6:.2f} MB")
    with open(page, encoding="utf-8") as file:
        text = file.read()
    check(not re.search(r'(src|href)\s*=\s*"(https?:)?//', text), "nothing is loaded from elsewhere")

    shown, console = open_page(page, DIRECTIONS)
    check(shown["errors"] == [] and console == [], f"no errors in the console {console}")
    for number, (name, scene) in enumerate(scenes):
        check_values(name, scene, shown, number)
        check_albedo(name, scene, shown, number)
        check(shown["interpolation"][number] <= ALLOWED,
              f"{name}: colours of the picture ({shown['interpolation'][number]:.1e})")
        if HAS_RENDER:
            check_picture(name, scene, shown["pictures"][number], folder)
    picked = shown["picked"]
    check(picked["thetaOut"] <= 1 and abs(picked["thetaIn"] - 44.8) <= 1,
          f"a click in the middle reads the normal: {picked}")
    check(shown["three"] == all(shown["is3d"]), "with three.js the pictures are drawn by WebGL")

    flat, console = open_page(page, DIRECTIONS[:2], more="&flat", size="500,900")
    check(flat["errors"] == [] and console == [], "no errors without WebGL")
    check(not any(flat["is3d"]), "without WebGL the processor draws")
    check(flat["values"][0]["shown"] == shown["values"][0]["shown"], "the same values without WebGL")
    check(flat["overflow_px"] <= 0, "nothing is wider than a narrow window")
    for a, b in zip(flat["pictures"], shown["pictures"]):
        distance = math.dist(lab(a["rgb"]), lab(b["rgb"]))
        check(distance <= 1, f"the same picture without WebGL (dE {distance:.2f})")


def check_family(folder):
    page = os.path.join(folder, "family.html")
    run("report", *DROPLETS, "--coat", "hg:0.9,0.5@1[grey]", "--vary", "depth=0:1:3",
        "--wavelengths", WAVELENGTHS, "--quiet", "-o", page)
    shown, console = open_page(page, DIRECTIONS)
    check(shown["errors"] == [] and console == [] and shown["members"] == [3], "a family of three")
    check_values("family, first", DROPLETS, shown, 0)
    picked, last = shown["picked"], shown["last_member"]
    check(last["label"] == "optical depth 1", f"the last member is {last['label']}")
    rows = table("brdf", *DROPLETS, "--coat", "hg:0.9,0.5@1[grey]", "--wavelengths", "550",
                 "--mu-in", repr(math.cos(math.radians(picked["thetaIn"]))),
                 "--mu-out", "1,0.1,0.5", "--azimuth", "0,90,180")
    values = [float(row["brdf"]) for row in rows]
    error = abs(last["picked"][0][0] - values[0]) / max(values)
    check(error <= ALLOWED, f"the slider shows the last member ({error:.1e} of the largest)")


with tempfile.TemporaryDirectory() as scratch:
    check_pair(scratch)
    check_family(scratch)
sys.exit(f"{len(failures)} failed" if failures else 0)
