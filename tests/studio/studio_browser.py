"""The studio's page in headless Chromium, by its debugging pipe: mouse, keyboard, reload, restart.

    studio_browser.py MIEBRDF CHROMIUM [FOLDER for screenshots] [CHANGES to time]
"""

import json
import math
import pathlib
import signal
import statistics
import sys
import time

from chromium import Browser, solved, table
from studio_process import Studio, check, failures

PROGRAM, CHROMIUM = sys.argv[1:3]
PICTURES = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
CHANGES = int(sys.argv[4]) if len(sys.argv) > 4 else 0
ALLOWED = 1e-3  # of a value: the promise of the page's tables, of the largest at an incidence


def check_value(browser, scene, what):
    """The value that is read on the page against the program's own."""
    shown = float(browser.run("document.querySelector('[data-key=brdf]').dataset.value"))
    lab = browser.run("document.querySelector('#studio-colours [data-light=diffuse] [data-key=Lab]').textContent")
    view = browser.run("({...App.view})")
    mu_in, mu_out = (math.cos(math.radians(view[k])) for k in ("thetaIn", "thetaOut"))
    rows = table(PROGRAM, "brdf", *scene, "--wavelengths", str(view["wavelength"]), "--mu-in", repr(mu_in),
                 "--mu-out", ",".join([repr(mu_out), "0.1", "0.3", "0.5", "0.95"]), "--azimuth", f"{view['azimuth']},90,180")
    values = [float(r["brdf"]) for r in rows]
    # Solved twice, at other directions: each to its tolerance.
    worst = abs(shown - values[0]) / max(values)
    check(worst <= 2 * ALLOWED, f"{what}: BRDF as in `brdf` ({worst:.1e} of the largest)")
    colour = table(PROGRAM, "albedo", *scene, "--wavelengths", "400:700:20", "--colour", "d65", "--mu-in", "1")
    row = next(r for r in colour if r["quantity"] == "spherical_albedo")
    off = max(abs(float(a) - float(row[k])) for a, k in zip(lab.replace("−", "-").split(), ("lab_l", "lab_a", "lab_b")))
    check(off <= 0.15, f"{what}: Lab as in `albedo --colour` ({off:.2f})")


def words_of(browser):
    """The scene on the page as words of the command line."""
    return [text for name, values in browser.run("Studio.words").items() for value in values
            for text in ([f"--{name}"] if value is True else [f"--{name}", value]) if name not in ("wavelengths", "tolerance")]


studio = Studio(PROGRAM)
browser = Browser(CHROMIUM, "1280,900", PICTURES)
browser.size(1280, 900)
browser.open(studio.address)
solved(browser, "the tolerance by its field", lambda: browser.run("(() => { const e = [...document.querySelectorAll('#studio-method input')][1]; e.value = '0.001'; e.dispatchEvent(new Event('change')); })()"))
gold = ["--base", "TiO2,radius=0.2", "--coat", "Au,radius=0.03@0.5", "--roughness", "0.3"]
check_value(browser, gold, "the first scene")
browser.picture("first")

solved(browser, "a radius by its field", lambda: browser.type("[data-layer='0'] .control:nth-of-type(1) input.number", "0.05"))
check(browser.run("Studio.model.layers[0].words") == "Au,radius=0.05", "the radius stands in the words")
gold[3] = "Au,radius=0.05@0.5"
check_value(browser, gold, "another radius")


def turn():
    browser.run("document.querySelector(\"[data-layer='bottom'] input[type=range]\").focus()")
    for _ in range(5):
        browser.key("ArrowRight", 39)


solved(browser, "a slider by the keyboard", turn)
radius = browser.run("Studio.model.bottom").split("radius=")[1]
check(float(radius) > 0.2, f"the slider is turned by arrow keys (radius {radius})")
gold[1] = f"TiO2,radius={radius}"
check_value(browser, gold, "after the slider")

before = browser.run("document.querySelector('[data-key=brdf]').dataset.value")
browser.type("[data-layer='bottom'] input[type=text]", "TiO2,radius=-1")
browser.wait("!document.getElementById('studio-error').hidden", "a wrong value is refused")
said = browser.run("document.getElementById('studio-error').textContent")
check("-1" in said and "allowed" in said, f"and why is said: {said[:90]}")
check(browser.run("document.querySelector('[data-key=brdf]').dataset.value") == before, "the last good picture stays")
browser.picture("refused")
solved(browser, "undo", lambda: browser.click("#studio-undo"))
check(browser.run("Studio.model.bottom") == gold[1] and browser.run("document.getElementById('studio-error').hidden"), "undo takes it back")
solved(browser, "a layer is switched off", lambda: browser.click("[data-layer='0'] input[type=checkbox]"))
check_value(browser, [gold[0], gold[1], *gold[4:]], "without the layer")
solved(browser, "and on", lambda: browser.click("[data-layer='0'] input[type=checkbox]"))
solved(browser, "a layer is added", lambda: browser.click("#studio-add"))
check(browser.run("Studio.model.layers.length") == 2, "two layers")
solved(browser, "and moved down", lambda: browser.click("[data-layer='1'] [aria-label='layer 2 down']"))
check(browser.run("Studio.model.layers[1].words").startswith("Au"), "the gold lies on top now")
solved(browser, "and removed", lambda: browser.click("[data-layer='0'] [aria-label='remove layer 1']"))

browser.type("#studio-find", "haematite")
browser.wait("document.querySelector('#studio-found button')", "materials are found")
browser.run("document.querySelector(\"[data-layer='bottom'] input[type=text]\").focus()")
solved(browser, "and one is taken", lambda: browser.click("#studio-found button"))
check(browser.run("Studio.model.bottom").startswith("Fe2O3"), f"its name stands in the words ({browser.run('Studio.model.bottom')})")

browser.wait("document.querySelector('#studio-found .chip[data-of=pigment]')", "with chips of their colours")
chip = browser.run("getComputedStyle(document.querySelector('#studio-found [data-chip=Fe2O3]')).backgroundColor")
red, _, blue = (int(v) for v in chip[4:-1].split(","))
check(red > 2 * blue, f"haematite's is red ({chip})")
browser.picture("chips")

# Shells have sliders of their own.
shell = "[data-layer='bottom'] input[type=range][aria-label='Coating of SiO2, nm']"
solved(browser, "a coated sphere", lambda: browser.type("[data-layer='bottom'] input[type=text]", "TiO2,radius=0.12,coating=SiO2@5nm,coating=index:1.6,0.01@10%"))
check(browser.run("[...document.querySelectorAll(\"[data-layer='bottom'] input[type=range]\")].map((e) => e.ariaLabel)") ==
      ["Radius, µm", "Coating of SiO2, nm", "n", "k", "Coating of index:1.6,0.01, %"], "each shell has a slider")


def thicken():
    browser.run(f"document.querySelector({json.dumps(shell)}).focus()")
    for _ in range(10):
        browser.key("ArrowRight", 39)


solved(browser, "a thicker shell by the keyboard", thicken)
words = browser.run("Studio.model.bottom")
check(5 < float(words.split("SiO2@")[1].split("nm")[0]) < 6 and words.endswith("@10%"), f"its thickness stands in the words ({words})")
check_value(browser, words_of(browser), "a coated sphere")

# A scene from nothing, by the keyboard alone.
browser.open(studio.address)
browser.run("document.activeElement.blur()")


def preset():
    browser.tab_to("#studio-preset")
    for _ in range(2):
        browser.key("ArrowDown", 40)


solved(browser, "a preset by the keyboard", preset)
solved(browser, "a layer by the keyboard", lambda: browser.tab_to("#studio-add") and browser.key("Enter", 13))
browser.run("document.activeElement.blur()")
top = browser.run("Studio.model.layers.length") - 1
solved(browser, "its medium by the keyboard",
       lambda: browser.tab_to(f"[data-layer='{top}'] > input[type=text]") and browser.replace_text("Au,radius=0.02"))
check(browser.run(f"Studio.model.layers[{top}].words") == "Au,radius=0.02", "gold lies on the preset")
check_value(browser, words_of(browser), "a scene by the keyboard")

# Two scenes beside each other.
browser.click("#studio-keep")
browser.wait("document.querySelectorAll('#objects .card').length === 2", "the kept scene stands beside it")
solved(browser, "a change beside the kept scene", lambda: browser.type(f"[data-layer='{top}'] .control:nth-of-type(1) input.number", "0.05"))
check(browser.run("Number(document.getElementById('de2000').dataset.value)") > 0, "and their colour difference is there")
browser.picture("compared")
browser.click("#studio-keep")
browser.wait("document.querySelectorAll('#objects .card').length === 1", "one scene again")

# Measured points, and a fit of them.
TRUE_RADIUS = 0.16
made = table(PROGRAM, "albedo", "--base", f"Fe2O3,radius={TRUE_RADIUS} in index:1.5", "--wavelengths", "420:680:20", "--mu-in", "0.8660254")
points = "wavelength_nm,plane_albedo\n" + "".join(f"{r['wavelength_nm']},{r['plane_albedo']}\n" for r in made)
browser.run("""(() => { const dt = new DataTransfer(); dt.items.add(new File([%s], 'sample.csv'));
    document.dispatchEvent(new DragEvent('drop', { dataTransfer: dt, bubbles: true, cancelable: true })); })()""" % json.dumps(points))
browser.wait("document.getElementById('studio-measured').textContent.includes('sample.csv')", "a file is dropped in")
browser.run("Studio.begin({ base: ['Fe2O3,radius=0.2 in index:1.5'] })")
browser.wait("document.getElementById('studio-status').textContent.startsWith('solved')", "the scene of the fit")
browser.run("document.getElementById('albedo-charts').scrollIntoView()")
browser.wait(f"document.querySelectorAll('#albedo-charts .plot .mark').length === {len(made)}", "its points are drawn")
browser.picture("measured")
browser.click("[data-layer='bottom'] button.free")
solved(browser, "a fit", lambda: browser.click("[aria-label='fit the free numbers to the measured points']"))
fitted = float(browser.run("Studio.model.bottom").split("radius=")[1].split(" ")[0])
said = browser.run("document.getElementById('studio-fitted').textContent")
check(abs(fitted / TRUE_RADIUS - 1) <= 0.01 and "±" in said, f"it finds the radius: {said[:120]}")
browser.picture("fitted")

# Two tabs, and no WebGL.
other = Browser(CHROMIUM, "1280,900", PICTURES)
other.size(1280, 900)
other.open(studio.address + "&flat")
check(other.run("document.getElementById('object-hint').textContent").endswith("processor.)"), "the page works without WebGL")
solved(other, "a change in another tab", lambda: other.type("[data-layer='bottom'] .control input.number", "0.3"))
solved(browser, "and in this one", lambda: browser.type("[data-layer='bottom'] .control input.number", "0.25"))
check(not other.problems, f"no script failed in the other tab {other.problems[:2]}")
other.close()
solved(browser, "the first scene again", lambda: browser.run("Studio.begin({ base: ['TiO2,radius=0.2'], coat: ['Au,radius=0.03@0.5'] })"))

yaw = browser.run("(() => { App.view.lampYaw = 20; return App.view.lampYaw; })()")
solved(browser, "a change after the lamp is moved", lambda: browser.type("[data-layer='0'] .control:nth-of-type(1) input.number", "0.04"))
check(browser.run("App.view.lampYaw") == yaw, "camera and lamp stay")
model = browser.run("Studio.model")
time.sleep(0.3)
browser.open(studio.address)
check(browser.run("Studio.model") == model, "a page that is loaded anew has the scene")
check(browser.run("App.view.lampYaw") == yaw, "and the lamp")
studio.end(signal.SIGKILL)
studio = Studio(PROGRAM, studio.state)
browser.open(studio.address)
check(browser.run("Studio.model") == model, "so has a studio that was killed and started again")

for width, height, scheme in [(1280, 900, "light"), (1280, 900, "dark"), (390, 844, "light")]:
    browser.size(width, height, scheme)
    browser.open(studio.address)
    over = browser.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    check(over <= 0, f"{width} px, {scheme}: nothing stands over the edge ({over} px)")
    browser.picture(f"{width}-{scheme}")
browser.tab_to("#c-object")
for _ in range(3):
    browser.key("ArrowDown", 40)
browser.wait("document.querySelector('.drawdown .chart-halves:not([hidden])')", "its film is drawn down, by the keyboard")
solved(browser, "without its layer", lambda: browser.click("[data-layer='0'] input[type=checkbox]"))
browser.wait("document.querySelector('.drawdown p').textContent.includes('no film')", "a base alone says why it has no drawdown")
solved(browser, "and with it", lambda: browser.click("[data-layer='0'] input[type=checkbox]"))
browser.wait("document.querySelector('.drawdown .chart-halves:not([hidden])')", "the drawdown again")
over = browser.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
check(over <= 0, f"390 px, drawdown: nothing stands over the edge ({over} px)")
browser.run("document.getElementById('objects').scrollIntoView()")
browser.picture("390-drawdown")
browser.size(1280, 900, "dark")
browser.run("document.documentElement.dataset.theme = 'dark'")
browser.picture("1280-drawdown-dark")
nodes = browser.send("Accessibility.getFullAXTree")["nodes"]
unnamed = [n["role"]["value"] for n in nodes if not n.get("ignored") and n.get("role", {}).get("value") in ("button", "slider", "textbox", "combobox", "checkbox", "searchbox")
           and not n.get("name", {}).get("value")]
check(not unnamed, f"in the accessibility tree everything has a name {unnamed[:5]}")
names = browser.run("[...document.querySelectorAll('#studio input, #studio select, #studio button')].filter((e) => !(e.ariaLabel || e.textContent.trim() || e.labels?.length)).length")
check(names == 0, f"everything that can be used has a name ({names} without)")
check(not browser.problems, f"no script failed {browser.problems[:2]}")

if CHANGES:
    browser.size(1280, 900)
    for what, layer, values in [("thickness", "[data-layer='0'] .field input", None), ("radius", "[data-layer='bottom'] .control input.number", (0.05, 0.5))]:
        times = []
        for k in range(CHANGES):
            text = f"{0.3 + 0.005 * k:.4g}" if values is None else f"{values[0] + (values[1] - values[0]) * k / CHANGES:.4g}"
            number = browser.run("Number(document.body.dataset.solved)")
            browser.run(f"(() => {{ const e = document.querySelector({json.dumps(layer)}); e.value = '{text}'; e.dispatchEvent(new Event('change')); }})()")
            browser.wait(f"Number(document.body.dataset.solved) > {number}", "solved")
            times.append(browser.run("Studio.latency[Studio.latency.length - 1][1]"))
        times.sort()
        print(f"{what}: median {statistics.median(times):.0f} ms, 95 % {times[int(0.95 * len(times))]:.0f} ms of {CHANGES}")
browser.close()
studio.end()
sys.exit(1 if failures else 0)
