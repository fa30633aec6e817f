"""How long `miebrdf studio` takes for a change, previews and solutions, over HTTP without a browser.

    studio_times.py MIEBRDF [CHANGES, 50] [CASES, e.g. white]

One line for each kind of change: median and 95th percentile of the time until the answer is there,
and of the processor time of the server (all threads). 16 wavelengths, no tolerance given.
"""

import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request

PROGRAM = sys.argv[1]
CHANGES = int(sys.argv[2]) if len(sys.argv) > 2 else 50
ONLY = sys.argv[3] if len(sys.argv) > 3 else ""


def gold(depth, radius):
    return {"base": ["TiO2,radius=0.2"], "coat": [f"Au,radius={radius:.5g}@{depth:.5g}"], "roughness": ["0.3"]}


def white(thickness, radius):
    return {"substrate": ["lambert:0.05"], "coat": [f"TiO2,radius={radius:.5g},volume=15% in PMMA@{thickness:.5g}um"],
            "boundary": ["smooth"], "missing-k-zero": [True]}


def three_coats(thickness):
    return {"substrate": ["lambert:0.05"], "boundary": ["smooth"], "missing-k-zero": [True],
            "coat": ["TiO2,radius=0.13,volume=15% in PMMA@20um", "Fe2O3,radius=0.1,volume=1% in PMMA@5um",
                     f"TiO2,radius=0.1,volume=2% in PMMA@{thickness:.5g}um"]}


CASES = {
    "gold on rutile, thickness": lambda x: gold(0.5 + 0.7 * x, 0.03),
    "gold on rutile, radius": lambda x: gold(0.5, 0.03 + 0.05 * x),
    "white paint, thickness": lambda x: white(40 + 50 * x, 0.13),
    "white paint, radius": lambda x: white(40, 0.13 + 0.1 * x),
    "three coats, the topmost": lambda x: three_coats(10 + 10 * x),
    "snow of 50 um, radius": lambda x: {"base": [f"H2O_ice,radius={50 + 50 * x:.5g}"]},
}

environment = {**os.environ, "XDG_STATE_HOME": tempfile.mkdtemp()}
server = subprocess.Popen([PROGRAM, "studio", "--no-open", "--quiet"], stdout=subprocess.PIPE, text=True, env=environment)
base, token = re.search(r"(http://\S+)/\?token=(\w+)", server.stdout.readline()).groups()


def processor_time():
    with open(f"/proc/{server.pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def ask(words, preview):
    body = json.dumps({"words": {**words, "wavelengths": ["400:700:20"]}, "preview": preview, "tab": "bench"}).encode()
    request = urllib.request.Request(base + "/api/solve", data=body, headers={"X-Studio-Token": token, "Content-Type": "application/json"})
    wall, processor = time.monotonic(), processor_time()
    with urllib.request.urlopen(request) as reply:
        json.load(reply)
    return time.monotonic() - wall, processor_time() - processor


for preview in (True, False):
    for name, scene in CASES.items():
        if ONLY not in name:
            continue
        ask(scene(0), preview)
        times = [ask(scene((k + 1) / CHANGES), preview) for k in range(CHANGES)]
        walls, processors = (sorted(column) for column in zip(*times))
        last = int(0.95 * CHANGES)
        print(f"{name:26s} {'preview ' if preview else 'solution'}  until the answer {statistics.median(walls):6.3f} s (95 % {walls[last]:6.3f}), "
              f"processor time {statistics.median(processors):6.2f} s (95 % {processors[last]:6.2f})", flush=True)
server.send_signal(signal.SIGINT)
server.wait()
