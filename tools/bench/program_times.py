#!/usr/bin/env python3
"""How long the program takes for the requests of docs/performance.md, and how much memory.

    program_times.py PROGRAM [--rounds 5] [--threads 0] [--path NAME]... [--docs docs]

Every round runs every request once, without the cache; the smallest time of each request counts. The
processor time is that of the whole process, its start included; the wall-clock time means something
on an idle machine only. --path adds the processor time along another path of a build that has
several (MIEBRDF_PROCESSOR_PATH). --docs rewrites the generated part of performance.md.
"""
import argparse
import datetime
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

PAIR = ["--base", "TiO2", "--coat", "AlGaAs7@0.1[grey]"]
LIST = ["--mu-in", "0.2,0.5,0.8,1", "--mu-out", "0.1:1:0.1"]
EVEN = "0.03125:1:0.03125"
SPECTRUM = ["--wavelengths", "400:700:10"]

# The name of each request, its words, and the exit codes that it may have.
REQUESTS = [
    ("the pair: 31 wavelengths, 280 directions, exact retro-reflection among them",
     ["brdf", *PAIR, *SPECTRUM, *LIST, "--azimuth", "0:180:30"], (0, 4)),
    ("the same with a tolerance of 1e-2 (`tools/quickstart`)",
     ["brdf", *PAIR, *SPECTRUM, *LIST, "--azimuth", "0:180:30", "--tolerance", "1e-2"], (0, 4)),
    ("the pair at azimuths up to 150 degrees",
     ["brdf", *PAIR, *SPECTRUM, *LIST, "--azimuth", "0:150:25"], (0, 4)),
    ("the pair at red, green and blue, 32 x 32 x 36 directions",
     ["brdf", *PAIR, "--wavelengths", "rgb", "--mu-in", EVEN, "--mu-out", EVEN,
      "--azimuth", "0:350:10"], (0, 4)),
    ("the pair at red, green and blue as a file (`export --format npz`)",
     ["export", "--format", "npz", *PAIR, "--wavelengths", "rgb", "-o", "pair.npz"], (0, 4)),
    ("albedo of the pair, 31 wavelengths", ["albedo", *PAIR, *SPECTRUM], (0,)),
    ("albedo of snow, grains of 500 um, 221 wavelengths",
     ["albedo", "--base", "H2O_ice,radius=500", "--wavelengths", "300:2500:10"], (0,)),
    ("white paint on black: 31 wavelengths, a binder with a smooth boundary",
     ["albedo", "--substrate", "black", "--boundary", "smooth", *SPECTRUM,
      "--coat", "TiO2,radius=0.13,volume=15% in PMMA@20um"], (0,)),
    ("Table 1", ["table1"], (0,)),
    ("`--version`", ["--version"], (0,)),
]


class Cost:
    def __init__(self):
        self.processor = self.wall = self.memory_mb = float("inf")

    def add(self, processor, wall, memory_mb):
        self.processor = min(self.processor, processor)
        self.wall = min(self.wall, wall)
        self.memory_mb = min(self.memory_mb, memory_mb)


def run_once(program, words, allowed, threads, path):
    """Processor time in s, wall-clock time in s and largest resident memory in MB of one process."""
    command = [program, *words]
    if words[0] in ("brdf", "albedo", "export"):
        command += ["--no-cache", "--threads", str(threads)]
    environment = dict(os.environ)
    if path:
        environment["MIEBRDF_PROCESSOR_PATH"] = path
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - started
    code = process.returncode = os.waitstatus_to_exitcode(status)
    if code not in allowed:
        sys.exit(f"exit code {code} of: {' '.join(command)}")
    return usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024


def seconds(value):
    return f"{value:.2f} s" if value >= 0.095 else f"{1000 * value:.0f} ms"


def processor_name():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def table_of(program, rounds, threads, paths):
    costs = {(name, path): Cost() for name, _, _ in REQUESTS for path in [None, *paths]}
    for _ in range(rounds):
        for name, words, allowed in REQUESTS:
            for path in [None, *paths]:
                costs[name, path].add(*run_once(program, words, allowed, threads, path))
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split("\n")
    text = (f"Measured with {version[0]}; {processor_name()}, {os.cpu_count()} processors, "
            f"{threads or os.cpu_count()} threads; {'; '.join(v for v in version[1:] if v)}; the least of "
            f"{rounds} rounds; {datetime.date.today()}.\n\n")
    text += "| request | processor time | wall-clock time | memory |" + "".join(
        f" along {path} |" for path in paths)
    text += "\n|---|---|---|---|" + "---|" * len(paths) + "\n"
    for name, _, _ in REQUESTS:
        cost = costs[name, None]
        text += (f"| {name} | {seconds(cost.processor)} | {seconds(cost.wall)} | "
                 f"{cost.memory_mb:.0f} MB |")
        text += "".join(f" {seconds(costs[name, path].processor)} |" for path in paths) + "\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--path", action="append", default=[])
    parser.add_argument("--docs", type=pathlib.Path)
    arguments = parser.parse_args()
    text = table_of(str(pathlib.Path(arguments.program).resolve()), arguments.rounds,
                    arguments.threads, arguments.path)
    print(text)
    if arguments.docs:
        page = arguments.docs / "performance.md"
        opening, closing = "<!-- generated times -->\n", "<!-- end times -->"
        old = page.read_text()
        if opening not in old or closing not in old:
            sys.exit(f"{page}: the marks {opening.strip()} and {closing} are not there")
        page.write_text(old[:old.index(opening) + len(opening)] + text + old[old.index(closing):])


if __name__ == "__main__":
    main()
