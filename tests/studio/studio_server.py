"""What `miebrdf studio` answers, and to whom.

    studio_server.py MIEBRDF [CHROMIUM]
"""

import base64
import csv
import json
import math
import os
import pathlib
import random
import socket
import struct
import subprocess
import sys
import threading
import time
import zlib

from studio_process import Studio, check, failures

PROGRAM = sys.argv[1]
FUZZED = 300
SCENE = {"base": ["TiO2,radius=0.2"], "coat": ["Au,radius=0.03@0.5"], "wavelengths": ["450:650:50"]}

studio = Studio(PROGRAM)

# Who is answered.
check(studio.ask("GET", f"/?token={studio.token}", token=False)[0] == 200, "the address opens the page")
for name, path, headers in [("no token", "/", {}), ("a wrong token", "/?token=" + 32 * "0", {}),
                            ("a part of the token", f"/?token={studio.token[:31]}", {})]:
    status, _, body = studio.ask("GET", path, headers=headers, token=False)
    check(status == 403 and studio.token.encode() not in body, f"{name}: 403, and no page")
check(studio.ask("POST", "/api/state", "{}", token=False)[0] == 403, "a request without the token: 403")
check(studio.ask("POST", f"/api/state?token={studio.token}", "{}", token=False)[0] == 403,
      "a token in the address is for the page alone: 403")
for host in ("evil.example", f"evil.example:{studio.port}", "127.0.0.1", f"127.0.0.1:{studio.port}.evil.example"):
    check(studio.ask("POST", "/api/state", "{}", {"Host": host})[0] == 403, f"host {host} (a name bound anew): 403")
for origin in ("http://evil.example", "null", f"https://127.0.0.1:{studio.port}"):
    check(studio.ask("POST", "/api/state", "{}", {"Origin": origin})[0] == 403, f"origin {origin}: 403")
check(studio.ask("POST", "/api/state", "{}", {"Origin": f"http://127.0.0.1:{studio.port}"})[0] == 200, "its own origin is answered")
_, headers, page = studio.ask("GET", f"/?token={studio.token}")
check("connect-src 'self'" in headers["Content-Security-Policy"] and "default-src 'none'" in headers["Content-Security-Policy"],
      "the page may speak to nobody else")
check(headers["Cache-Control"] == "no-store" and headers["Referrer-Policy"] == "no-referrer", "the token stays in no cache and no referrer")
try:
    outside = socket.gethostbyname(socket.gethostname())
except OSError:
    outside = "127.0.0.1"
if not outside.startswith("127."):
    with socket.socket() as other:
        other.settimeout(5)
        check(other.connect_ex((outside, studio.port)) != 0, f"nobody listens at {outside}")
again = subprocess.run([PROGRAM, "studio", "--no-open", "--port", str(studio.port)], capture_output=True, text=True, timeout=20)
check(again.returncode == 2 and str(studio.port) in again.stderr, "a port that is taken: exit code 2, and which")

# Requests that are wrong.
for path in ("/etc/passwd", "/../../etc/passwd", "/api", "/api/solve/", "/%2e%2e/%2e%2e/etc/passwd"):
    check(studio.ask("GET", path)[0] == 404 and studio.ask("POST", path, "{}")[0] in (400, 404), f"{path}: 404")
check(studio.ask("POST", "/api/solve", "{")[0] == 400, "broken JSON: 400")
check(studio.ask("POST", "/api/solve", "[]")[0] == 400, "no object: 400")
check(studio.ask("POST", "/api/solve", "{}")[0] == 400, "a request without words: 400")
try:
    large = studio.ask("POST", "/api/solve", "x" * (17 << 20))[0]
except OSError:
    large = 413  # the connection is closed while it is sent
check(large == 413, "17 MB: 413")
for word, value in [("base", "hg:/etc/passwd"), ("base", "scattering:/dev/zero"), ("base", "moments:x"), ("base", "matrix:x.csv"),
                    ("substrate", "lambert:ground.csv"), ("base", "TiO2,sizes=/etc/passwd"), ("base", "paste:/etc/passwd"),
                    ("base", "TiO2,radius=0.1 + hg:secret"), ("database", "/tmp/x.sqlite"), ("base", "x" * 3000), ("base", "TiO2\n"),
                    ("k-floor", "k.csv"), ("output", "x"), ("base", "NoSuchThing"), ("wavelengths", "400:700:0.1"),
                    ("tolerance", "1e-9"), ("streams", "256")]:
    words = {**SCENE, word: [value]}
    if word == "substrate":
        del words["base"]
    status, said = studio.post("/api/solve", {"words": words})
    check(status == 422 and said["error"], f"--{word} {value[:30]!r}: {said.get('error', '')[:100]}")
status, said = studio.post("/api/solve", {"words": {**SCENE, "base": ["TiO2,radius=-1"]}})
check(status == 422 and "-1" in said["error"] and "allowed" in said["error"], f"a wrong radius: {said['error'][:100]}")

# What is right.
status, said = studio.post("/api/solve", {"words": SCENE, "tab": "a"})
check(status == 200 and said["data"] and not said["shortfalls"], f"a scene is solved in {said.get('seconds', 0):.2f} s")


def shown(of, words, preview=False):
    """Lists of albedos and of light from an even sky (which is summed from the table of the BRDF) that the page gets."""
    status, reply = of.post("/api/solve", {"words": words, "preview": preview})
    if status != 200:
        raise SystemExit(reply)
    raw = zlib.decompress(base64.b64decode(reply["data"]))
    length = struct.unpack("<I", raw[:4])[0]
    variant = json.loads(raw[4:4 + length])["scenes"][0]["variants"][0]
    places = [variant["albedo"]["spherical"], variant["albedo"]["plane"], variant["sky"]]
    return [v for place in places for v in struct.unpack_from(f"<{place['f32'][1]}f", raw, 4 + length + place["f32"][0])], variant


# What is kept from one change to the next changes nothing beyond the tolerance (0.01, previews 0.03).
random.seed(7)
fresh = Studio(PROGRAM)
worst = {False: 0.0, True: 0.0}
apart = 0.0
for number in range(14):
    lower, upper, depth = random.uniform(0.05, 0.4), random.uniform(0.02, 0.2), random.uniform(0.1, 3)
    words = {"base": [f"TiO2,radius={lower:.3g}"], "coat": [f"Au,radius={upper:.3g}@{depth:.3g}"], "wavelengths": ["450:650:50"]}
    top = random.choice([{}, {"roughness": ["0.3"]}, {"boundary": ["smooth"]}, {"boundary": ["rough:0.2"]}])
    if "boundary" in top:
        words = {key: [f"{text} in index:1.5" if key == "base" else text.replace("@", " in index:1.5@") if key == "coat" else text for text in texts]
                 for key, texts in words.items()}
    words = {**words, **top}
    both = {}
    for preview in (True, False):
        both[preview], variant = shown(studio, words, preview)
        check(("media" in variant) != preview, f"a {'preview' if preview else 'solution'} of {words}") if number == 0 else None
        if number % 5 == 4:  # the same in a process that knows nothing
            fresh.end()
            fresh = Studio(PROGRAM)
            alone, _ = shown(fresh, words, preview)
            worst[preview] = max([worst[preview]] + [abs(a - b) for a, b in zip(both[preview], alone, strict=True)])
    apart = max([apart] + [abs(a - b) for a, b in zip(both[True], both[False], strict=True)])
fresh.end()
check(worst[False] <= 0.01 and worst[True] <= 0.03, f"after any changes a scene is as in a new process ({worst[False]:.1e}, previews {worst[True]:.1e})")
check(apart <= 0.03, f"previews are within 0.03 ({apart:.1e})")
replies = []
slow = {**SCENE, "base": ["H2O,radius=50,variance=0.1"], "wavelengths": ["400:700:5"], "tolerance": ["2e-4"]}
first = threading.Thread(target=lambda: replies.append(studio.post("/api/solve", {"words": slow, "tab": "b"})[0]))
first.start()
time.sleep(0.3)
began = time.monotonic()
check(studio.post("/api/solve", {"words": SCENE, "tab": "b"})[0] == 200, "a later change of a tab is solved")
first.join()
check(replies == [409], f"and ends the one before ({time.monotonic() - began:.1f} s)")
status, said = studio.post("/api/texts", {"words": {**SCENE, "missing-k-zero": [True]}})
script = said["command"].replace("scene.html", os.path.join(studio.state, "page.html"))
check(subprocess.run(script.replace("miebrdf", PROGRAM, 1), shell=True, capture_output=True).returncode == 0, "the command line that it says runs")
scene = pathlib.Path(studio.state) / "scene.toml"
scene.write_text(said["toml"])
check(subprocess.run([PROGRAM, "run", "scene.toml"], cwd=studio.state, capture_output=True).returncode == 0, "the scene file that it says runs")
package = pathlib.Path(PROGRAM).parents[1] / "python" / "package"
python = {**os.environ, "PYTHONPATH": str(package)}
if subprocess.run([sys.executable, "-c", "import miebrdf"], env=python, capture_output=True).returncode == 0:
    for words in (SCENE, {**SCENE, "roughness": ["0.3,ggx"], "tolerance": ["0.01"], "stokes": ["1"], "missing-k-zero": [True],
                          "host-index": ["1.33"], "effective-radius": ["0.2"], "size-distribution": ["gamma"]}):
        _, said = studio.post("/api/texts", {"words": words})
        ran = subprocess.run([sys.executable, "-c", said["python"]], env=python, capture_output=True, text=True)
        check(ran.returncode == 0, f"the Python that it says runs {ran.stderr[-200:]}")
else:
    print("        (no Python package for this interpreter: its text is not run)")
for kind, start in [("albedo", b"# version"), ("report", b"<!DOCTYPE html>"), ("csv", b"#"), ("npz", b"PK")]:
    status, headers, body = studio.ask("POST", "/api/write", json.dumps({"words": SCENE, "kind": kind}))
    check(status == 200 and body.startswith(start) and "attachment" in headers["Content-Disposition"], f"download of {kind}: {len(body)} bytes")
check(studio.post("/api/write", {"words": SCENE, "kind": "../../x"})[0] == 422, "no kind of its own making is written")
status, said = studio.post("/api/materials", {"text": "gold"})
check(status == 200 and any(m["name"] == "Au" for m in said["materials"]), "gold is found")
chips = studio.post("/api/chips", {"names": ["Au", "Ag", "Fe2O3", "TiO2", "H2O", "NoSuchThing", "hg:/etc/passwd"]})[1]["chips"]
rgb = {name: [int(chip["hex"][k:k + 2], 16) for k in (1, 3, 5)] for name, chip in chips.items() if chip}
check(chips["Au"]["of"] == chips["Ag"]["of"] == "mirror" and rgb["Au"][0] > rgb["Au"][1] > rgb["Au"][2] and max(rgb["Ag"]) - min(rgb["Ag"]) <= 20,
      f"gold's chip is a yellow mirror, silver's a grey one {rgb}")
check(chips["Fe2O3"]["of"] == chips["TiO2"]["of"] == "pigment" and rgb["Fe2O3"][0] > 2 * rgb["Fe2O3"][2] and min(rgb["TiO2"]) > 220,
      "haematite's is a red pigment, rutile's a white one")
check(chips["NoSuchThing"] is None and chips["hg:/etc/passwd"] is None, "what is not in the database has none")
check(studio.post("/api/chips", {"names": [str(k) for k in range(41)]})[0] == 422, "41 chips at once are refused")

# Drawdowns.
MU_OF_SPHERE = math.cos(math.radians(8))
FILM = "TiO2,radius=0.13,volume=5% in PMMA@30um"
film = {"coat": [FILM], "boundary": ["smooth"], "missing-k-zero": [True], "wavelengths": ["400:700:20"]}
alone = ["--coat", FILM, "--boundary", "smooth", "--missing-k-zero", "--wavelengths", "400:700:20"]
for light in ("d65", "a"):
    made = subprocess.run([PROGRAM, "albedo", *alone, "--over", "black,white", "--colour", light, "--mu-in", repr(MU_OF_SPHERE)],
                          capture_output=True, text=True, check=True).stdout
    row = next(csv.DictReader(line for line in made.splitlines() if not line.startswith("#")))
    status, said = studio.post("/api/drawdown", {"words": {**film, "substrate": ["lambert:0.05"], "tolerance": ["0.001"]}, "light": light})
    off = max(abs(said[a] / float(row[b]) - 1) for a, b in (("contrast_ratio", "contrast_ratio"), ("thickness_um", "hiding_thickness_um"), ("relative_depth", "hiding_relative_depth")))
    check(status == 200 and said["converged"] and off <= 1e-3, f"a drawdown in light {light} is that of `albedo --over` ({off:.1e}; contrast {said.get('contrast_ratio')})")
status, quick = studio.post("/api/drawdown", {"words": {**film, "substrate": ["lambert:0.05"]}, "preview": True})
check(status == 200 and quick["thickness_um"] is None and abs(quick["contrast_ratio"] - float(said["contrast_ratio"])) <= 0.03, "a preview has its contrast alone")
for words, what in ((SCENE | {"coat": []}, "a base alone"), ({"base": ["TiO2,radius=0.2"], "coat": ["Au,radius=0.03@inf"]}, "a layer without end")):
    status, said = studio.post("/api/drawdown", {"words": {**words, "wavelengths": ["400:700:20"]}})
    check(status == 422 and "no film" in said["error"], f"{what} says why it has none: {said.get('error', '')[:90]}")
status, said = studio.post("/api/drawdown", {"words": {**film, "substrate": ["black"], "wavelengths": ["550"]}})
check(status == 422 and "eight wavelengths" in said["error"], "so does one wavelength")
check(studio.post("/api/save", {"words": SCENE, "view": {"a": 1}})[0] == 200, "the scene is saved")

# Measured files and fits.
made = subprocess.run([PROGRAM, "albedo", "--base", "Fe2O3,radius=0.15 in index:1.5", "--wavelengths", "450:650:25", "--mu-in", "0.9"],
                      capture_output=True, text=True, check=True).stdout
rows = [line.split(",")[:3] for line in made.splitlines() if line[0].isdigit()]
dropped = {"name": "../../etc/sample.csv", "content": base64.b64encode(("wavelength_nm,plane_albedo\n" + "".join(f"{w},{a}\n" for w, _, a in rows)).encode()).decode(),
           "quantity": "plane_albedo", "theta_in_deg": math.degrees(math.acos(0.9))}
status, said = studio.post("/api/measured", dropped)
check(status == 200 and len(said["values"]) == len(rows) and said["values"][0]["value"] == float(rows[0][2]), "a measured file is read")
status, said = studio.post("/api/measured", {"name": "x.csv", "content": base64.b64encode(b"wavelength_nm,plane_albedo\n500,oops\n").decode()})
check(status == 422 and "x.csv" in said["error"] and "/a/b/c" not in said["error"], f"a damaged one is refused: {said.get('error', '')[:100]}")
fit = {"words": {"base": ["Fe2O3,radius={u1} in index:1.5"]}, "unknowns": {"u1": "0.2 in 0.05:0.5 log"}, "file": dropped}
status, said = studio.post("/api/fit", fit)
if "libceres-dev" in said.get("error", ""):
    print("        (no fit in this build)")
else:
    value = said["values"][0]
    check(status == 200 and abs(value["value"] - 0.15) <= 1.5e-3 and value["standard_error"] > 0, f"and fitted: {value}")
    check(studio.post("/api/fit", {**fit, "unknowns": {"u1": "0.2 in 1:2"}})[0] == 422, "a start outside its bounds is refused")
    check(studio.post("/api/fit", {**fit, "words": {"base": ["hg:/etc/passwd"]}})[0] == 422, "so is a file in its words")

# Anything at all: an answer, and a server that lives.
random.seed(57)
texts = ["", "TiO2", "TiO2,radius=1e400", "@", "@@", "{", "{a=1}", "hg:", "hg:1,1", "index:", "index:nan,nan", "\u0000", "\ud800", "÷", "%s%n", "../", "a" * 1999,
         "TiO2,radius={r=0.1}", "bruggeman(", "formula(n=1e999)", "rough:", "0:1e9:1e-9", "550", "-1", "inf"]
names = ["base", "coat", "substrate", "boundary", "roughness", "wavelengths", "tolerance", "stokes", "host-index", "grid", "nonsense"]


def anything(depth=0):
    kind = random.randrange(7 if depth < 3 else 4)
    return [random.choice(texts), random.choice([0, -1, 1e308, 2**53]), None, random.random() < 0.5,
            [anything(depth + 1) for _ in range(2)] if depth < 3 else [], {random.choice(names): anything(depth + 1)} if depth < 3 else {}, random.choice(texts)][kind]


bad = []
for number in range(FUZZED):
    words = {random.choice(names): [random.choice(texts)] if random.random() < 0.7 else anything() for _ in range(random.randrange(4))}
    asked = {"words": words, "preview": True, "kind": anything(), "text": anything(), "view": anything(), "tab": anything(), "light": anything(), "names": anything()}
    if random.random() < 0.3:
        asked = anything()
    body = json.dumps(asked)
    if random.random() < 0.2:
        at = random.randrange(len(body))
        body = body[:at] + random.choice(["\x00", "{", "\"", "\\", "9" * 50]) + body[at + 1:]
    path = random.choice(["/api/solve", "/api/save", "/api/texts", "/api/materials", "/api/write", "/api/state", "/api/measured", "/api/fit",
                          "/api/drawdown", "/api/chips"])
    if path == "/api/measured" and random.random() < 0.8:
        content = random.randbytes(random.randrange(200)) if random.random() < 0.5 else random.choice(["wavelength_nm,value\n", "<CxF>", "{", "PK\x03\x04"]).encode() + random.randbytes(60)
        body = json.dumps({"name": random.choice([*texts, "a.csv", "a.cxf", "a.mat", "a.asd"]), "content": base64.b64encode(content).decode()})
    try:
        status = studio.ask("POST", path, body.encode("utf-8", "surrogatepass"), timeout=60)[0]
    except OSError as error:
        status = str(error)
    if status not in (200, 400, 409, 422):
        bad.append((status, path, body[:200]))
check(not bad, f"{FUZZED} requests of anything are answered {bad[:3]}")
check(studio.post("/api/solve", {"words": SCENE})[0] == 200, "and a scene is still solved")

studio.post("/api/save", {"words": SCENE, "view": {"a": 1}})
check(studio.end() == 0, "Ctrl-C ends the studio, exit code 0")
left = Studio(PROGRAM, studio.state)
_, said = left.post("/api/state", {})
check(said["words"] == SCENE and said["view"] == {"a": 1}, "the scene that was left is there again")
left.end()
broken = pathlib.Path(studio.state) / "miebrdf" / "studio.toml"
broken.write_text("base = [[[")
third = Studio(PROGRAM, studio.state)
check(third.post("/api/state", {})[1]["words"]["base"] == ["TiO2,radius=0.2"], "a state that is damaged is left aside")
third.end()
sys.exit(1 if failures else 0)
