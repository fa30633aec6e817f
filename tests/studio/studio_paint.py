"""A paint designed from nothing in the studio, as its user does it, to a file for Mitsuba.

    studio_paint.py MIEBRDF CHROMIUM [FOLDER for screenshots]

Every number that is read on the page is compared with the program's own CSV.
"""

import json
import math
import pathlib
import struct
import sys
import tempfile
import time

from chromium import Browser, solved, table
from studio_process import Studio, check, failures

PROGRAM, CHROMIUM = sys.argv[1:3]
PICTURES = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
ALLOWED = 1e-3  # of reflectances and ratios: the tolerance of both
COMMON = ["--boundary", "smooth", "--missing-k-zero", "--wavelengths", "400:700:20"]

studio = Studio(PROGRAM)
browser = Browser(CHROMIUM, "1280,900", PICTURES)
browser.size(1280, 900)
browser.open(studio.address)


def say(step):
    status = browser.run("document.getElementById('studio-status').textContent")
    lab = browser.run("document.querySelector('#studio-colours [data-light=diffuse] [data-key=Lab]')?.textContent")
    print(f"        {step}: Lab {lab}; {status}", flush=True)


def choose(selector, option):
    browser.run(f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.value = {json.dumps(option)}; "
                "e.dispatchEvent(new Event('change', { bubbles: true })); })()")


def press(selector, times):
    browser.run(f"document.querySelector({json.dumps(selector)}).focus()")
    for _ in range(times):
        browser.key("ArrowRight", 39)


def drawn_down():
    """Numbers of the drawdown as they stand on the page."""
    return {key: float(value) for key, value in browser.run(
        "Object.fromEntries([...document.querySelectorAll('.drawdown dd')].map((e) => [e.dataset.key, e.dataset.value]))").items() if value}


def down(what, does):
    before = browser.run("Number.parseInt(document.body.dataset.drawnDown || 0)")
    does()
    browser.wait(f"Number.parseInt(document.body.dataset.drawnDown || 0) > {before} && !document.body.dataset.drawnDown.endsWith('preview') "
                 "&& document.getElementById('studio-status').textContent.startsWith('solved')", what)
    return drawn_down()


solved(browser, "an empty scene", lambda: choose("#studio-preset", browser.run(
    "[...document.querySelector('#studio-preset').options].find((o) => o.text.startsWith('Nothing')).value")))
check(browser.run("Studio.words").keys() == {"substrate", "wavelengths"}, "there is a ground alone")
say("nothing")
solved(browser, "a tolerance of 0.001", lambda: browser.run(
    "(() => { const e = [...document.querySelectorAll('#studio-method input')][1]; e.value = '0.001'; e.dispatchEvent(new Event('change')); })()"))
solved(browser, "a layer", lambda: browser.click("#studio-add"))
solved(browser, "a binder with 15 % of something", lambda: browser.type("[data-layer='0'] > input[type=text]", "SiO2,radius=0.13,volume=15% in PMMA"))
solved(browser, "40 um of it", lambda: browser.type("[data-layer='0'] .field input", "40um"))
solved(browser, "a smooth boundary", lambda: choose("#studio-layers .layer select", "smooth"))
solved(browser, "unknown k as 0", lambda: browser.run(
    "(() => { const e = [...document.querySelectorAll('#studio-method input')][2]; e.value = 'missing-k-zero'; e.dispatchEvent(new Event('change')); })()"))
say("silica in a binder")
browser.type("#studio-find", "titanium dioxide")
browser.wait("document.querySelector('#studio-found [data-chip=TiO2]')", "the search finds TiO2")
browser.run("document.querySelector(\"[data-layer='0'] > input[type=text]\").focus()")
solved(browser, "a white pigment from the search", lambda: browser.run("document.querySelector('#studio-found [data-chip=TiO2]').closest('button').click()"))
check(browser.run("Studio.model.layers[0].words") == "TiO2,radius=0.13,volume=15% in PMMA", "its sizes and amounts stay")
say("white paint")
browser.picture("paint-white")
solved(browser, "a tint", lambda: browser.type("[data-layer='0'] > input[type=text]", "TiO2,radius=0.13,volume=15% + Fe2O3,radius=0.1,volume=0.2% in PMMA"))
say("tinted")
tint = "[data-layer='0'] .control:nth-of-type(4) input[type=range]"
solved(browser, "more of it by the slider", lambda: press(tint, 60))
words = browser.run("Studio.model.layers[0].words")
check(0.2 < float(words.split("volume=")[2].split("%")[0]) < 2, f"the slider tints: {words}")
say(f"tinted more, {words}")

numbers = down("the drawdown", lambda: choose("#c-object", "drawdown"))
print(f"        drawdown of 40 um: {numbers}")
numbers = down("a thinner film", lambda: browser.type("[data-layer='0'] .field input", "3um"))
print(f"        of 3 um: {numbers}")
browser.picture("paint-thin")
check(numbers["contrast"] < 98 and numbers["hiding"] > 3, "it does not hide")
numbers = down("the depth that hides", lambda: browser.click(".drawdown .take"))
depth = browser.run("Studio.model.layers[0].depth")
print(f"        of {depth}: {numbers}")
check(abs(numbers["contrast"] - 98) <= 0.1, f"the button takes the depth that hides: {depth}, {numbers['contrast']:.2f} %")
browser.picture("paint-hiding")

film = ["--coat", f"{words}@{depth}", *COMMON]
MU_OF_SPHERE = repr(math.cos(math.radians(8)))
rows = [r for r in table(PROGRAM, "albedo", *film, "--over", "black,white", "--colour", "d65", "--mu-in", MU_OF_SPHERE) if r["mu_in"]]
for key, value in (("contrast", 100 * float(rows[0]["contrast_ratio"])), ("y-black", float(rows[0]["y"])), ("y-white", float(rows[1]["y"])),
                   ("hiding", float(rows[0]["hiding_thickness_um"]))):
    off = abs(numbers[key] / value - 1)
    check(off <= ALLOWED, f"{key} {numbers[key]:.6g} as in `albedo --over` ({value:.6g}, {off:.1e})")
ground = browser.run("Studio.model.bottom")
scene = ["--substrate", ground, *film]
browser.run("document.getElementById('swatches').scrollIntoView()")
browser.wait("document.querySelector('[data-colour=\"0-diffuse\"]')", "the table of colours")
shown = browser.run("({ nm: App.view.wavelength, brdf: Number(document.querySelector('[data-key=brdf]').dataset.value), y: Number(document.querySelector('[data-colour=\"0-diffuse\"] td:nth-child(4)').dataset.value) })")
mu_in, mu_out = (math.cos(math.radians(browser.run(f"App.view.{k}"))) for k in ("thetaIn", "thetaOut"))
value = float(table(PROGRAM, "brdf", *scene[:-2], "--wavelengths", str(shown["nm"]), "--mu-in", repr(mu_in), "--mu-out", repr(mu_out), "--azimuth", "0")[0]["brdf"])
check(abs(shown["brdf"] / value - 1) <= 2 * ALLOWED, f"BRDF {shown['brdf']:.6g} as in `brdf` ({value:.6g}, {abs(shown['brdf'] / value - 1):.1e})")
colour = next(r for r in table(PROGRAM, "albedo", *scene, "--colour", "d65", "--mu-in", "1") if r["quantity"] == "spherical_albedo")
check(abs(shown["y"] / float(colour["y"]) - 1) <= ALLOWED, f"Y of diffuse light {shown['y']:.6g} as in `albedo --colour` ({float(colour['y']):.6g})")
say("the paint")

with tempfile.TemporaryDirectory() as folder:
    browser.send("Page.setDownloadBehavior", behavior="allow", downloadPath=folder)
    choose("#studio-kind", "rgl")
    browser.click("#studio-write")
    end, found = time.monotonic() + 240, []
    while not found and time.monotonic() < end:
        time.sleep(0.2)
        found = [f for f in pathlib.Path(folder).iterdir() if f.suffix == ".bsdf"]
    check(bool(found), f"a file for Mitsuba is downloaded: {[f.name for f in found]}")
    data = found[0].read_bytes() if found else b""
if data:
    # tensor_file of the `measured` material: half vectors, theta = x^2 90 degrees, phi = (2 y - 1) 180 degrees; BRDF times outgoing cosine.
    check(data[:12] == b"tensor_file\0", "it is a tensor_file")
    fields, at = {}, 18
    for _ in range(struct.unpack_from("<I", data, 14)[0]):
        length = struct.unpack_from("<H", data, at)[0]
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        rank, kind, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{rank}Q", data, at + 11)
        at += 11 + 8 * rank
        fields[name] = (kind, offset, shape)

    def floats(name):
        _, offset, shape = fields[name]
        return struct.unpack_from(f"<{math.prod(shape)}f", data, offset)

    theta, nm, (_, _, shape) = floats("theta_i"), floats("wavelengths"), fields["spectra"]
    spectra = floats("spectra")
    _, T, W, N, _ = shape
    t, w = min(range(T), key=lambda k: abs(theta[k] - 0.5)), min(range(W), key=lambda k: abs(nm[k] - 560))
    worst, count = 0.0, 0
    for row in range(0, N, 5):  # half vectors in the plane of incidence and off it
        for column in range(2, N // 2, 5):
            th, ph = (column / (N - 1)) ** 2 * math.pi / 2, (2 * row / (N - 1) - 1) * math.pi
            h = [math.sin(th) * math.cos(ph), math.sin(th) * math.sin(ph), math.cos(th)]
            i = [math.sin(theta[t]), 0.0, math.cos(theta[t])]
            dot = sum(a * b for a, b in zip(h, i))
            o = [2 * dot * a - b for a, b in zip(h, i)]
            if o[2] < 0.3 or dot < 0.1:
                continue
            azimuth = math.degrees(math.acos(max(-1.0, min(1.0, -o[0] / max(1e-9, math.hypot(o[0], o[1]))))))
            value = float(table(PROGRAM, "brdf", *scene[:-2], "--wavelengths", f"{nm[w]:.6g}", "--mu-in", repr(i[2]), "--mu-out", repr(o[2]),
                                "--azimuth", repr(azimuth), "--coupling", "reciprocal")[0]["brdf"])
            worst = max(worst, abs(spectra[((t * W + w) * N + row) * N + column] / (value * o[2]) - 1))
            count += 1
    # The file's nodes are lowered by a twelfth of the second differences around them (docs/formats/rgl.md).
    check(0 < count and worst <= 2e-3, f"its values at {count} half vectors, {nm[w]:.0f} nm, are those of `brdf` (largest difference {worst:.1e})")
check(not browser.problems, f"no script failed {browser.problems[:2]}")
browser.close()
studio.end()
sys.exit(1 if failures else 0)
