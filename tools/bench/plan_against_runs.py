#!/usr/bin/env python3
"""How well `miebrdf plan` knows what random requests cost: time and memory planned and measured.

    plan_against_runs.py PROGRAM [--scenes 100] [--seed 1] [--runs 3] [--longest 60] [-o scenes.csv]

Each scene is planned, then computed on one thread without the cache. Time is that of the processor
(the smallest of some runs) without the program's start, memory the largest resident set. Prints how
many scenes lie within a factor of 2, the median of planned to measured time, what planning takes
itself, and the worst. Scenes that are planned to take longer than --longest seconds are counted and left out.
"""
import argparse
import csv
import json
import os
import random
import resource
import subprocess
import sys
import threading


def number(rng, low, high):
    """A number between two positive ones, every decade alike."""
    return float(f"{low * (high / low) ** rng.random():.3g}")


def medium(rng):
    kind = rng.choice(["hg", "hg", "rayleigh", "isotropic", "clear", "absorbing", "absorbing", "name"])
    albedo = f"{1 - number(rng, 1e-4, 1):.5g}"
    if kind == "hg":
        return f"hg:{albedo},{rng.uniform(-0.5, 0.95):.3g}"
    if kind in ("rayleigh", "isotropic"):
        return f"{kind}:{albedo}"
    law = rng.choice(["", ",distribution=gamma", ",distribution=log-normal"])
    sizes = f"radius={number(rng, 0.05, 30)},variance={number(rng, 0.02, 0.3)}{law}"
    if kind == "name":
        return rng.choice(["TiO2", "SiO2", "H2O_ice", "Au"]) + "," + sizes
    k = 0 if kind == "clear" else number(rng, 1e-4, 1)
    return f"index:{rng.uniform(1.2, 2.6):.3g},{k},{sizes}"


def cosines(rng, count):
    return ",".join(f"{rng.uniform(0.05, 1):.4g}" for _ in range(count))


def request(rng):
    words = ["--base", medium(rng)]
    for _ in range(rng.choice([0, 0, 1, 1, 2])):
        words += ["--coat", f"{medium(rng)}@{number(rng, 0.02, 10)}"]
    if rng.random() < 0.2:
        words += ["--roughness", f"{number(rng, 0.05, 0.5)}"]
    tolerance = number(rng, 1e-4, 1e-2)
    nm = rng.choice(["550", "450,550,650", "400:700:50"])
    words += ["--wavelengths", nm, "--tolerance", f"{tolerance}"]
    directions = ["--mu-in", cosines(rng, rng.choice([1, 2, 8]))]
    if rng.random() < 0.3:
        return "albedo", words + directions
    azimuths = rng.choice(["0", "0,180", "0:180:20", "0:180:2"])
    outgoing = cosines(rng, rng.choice([1, 4, 20]))
    return "brdf", words + directions + ["--mu-out", outgoing, "--azimuth", azimuths]


def used(command, seconds=120):
    """Processor time (s) and largest resident set (MB) of a process; None when it takes too long."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    timer = threading.Timer(seconds, process.kill)
    timer.start()
    _, status, usage = os.wait4(process.pid, 0)
    timer.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 4):
        return None
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def planned(program, command, words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = subprocess.run([program, "plan", command, *words, "--json", "--no-cache"],
                          capture_output=True, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if not text:
        return None
    own = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    plan = json.loads(text)
    row = plan["columns"].index("seconds")
    seconds = sum(r[row] for r in plan["rows"] if r[1] == "compute")
    estimate = plan["facts"]["estimate"]  # "brdf: 0.01 s on one thread, 14 MB"
    memory = float(estimate.rsplit(", ", 1)[1].removesuffix(" MB")) if "MB" in estimate else 0.0
    steps = "; ".join(f"{r[2]} {r[row]:.3g}" for r in plan["rows"] if r[1] == "compute")
    return seconds, memory, steps, own


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--longest", type=float, default=60, help="seconds planned; more is left out")
    parser.add_argument("-o", "--output", help="CSV of every scene")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    program = options.program
    empty = ["brdf", "--base", "isotropic:0.5", "--wavelengths", "550", "--mu-in", "1", "--mu-out",
             "1", "--no-cache", "--threads", "1"]
    starts = [used([program, *empty]) for _ in range(5)]
    start_s = min(s for s, _ in starts)
    rows, too_long, plans = [], 0, []
    while len(rows) < options.scenes:
        command, words = request(rng)
        plan = planned(program, command, words)
        if plan is None:
            continue  # a combination that is refused
        if plan[0] > options.longest:
            too_long += 1
            continue
        plans.append(max(plan[3] - start_s, 0.0))
        runs = [used([program, command, *words, "--no-cache", "--threads", "1"])
                for _ in range(options.runs)]
        if None in runs:
            rows.append([command, " ".join(words), plan[0], "", plan[1], "", plan[2]])
            continue
        seconds = max(min(s for s, _ in runs) - start_s, 0.0)
        memory = min(m for _, m in runs)
        rows.append([command, " ".join(words), plan[0], seconds, plan[1], memory, plan[2]])
        print(f"{len(rows)}: planned {plan[0]:.3g} s, took {seconds:.3g} s, {memory:.0f} MB",
              file=sys.stderr)
    if options.output:
        with open(options.output, "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["command", "request", "planned_s", "measured_s", "planned_mb",
                             "measured_mb", "steps"])
            writer.writerows(rows)
    print(f"{too_long} scenes left out: planned to take more than {options.longest:g} s")
    report(rows)
    plans.sort()
    print(f"planning itself: median {plans[len(plans) // 2]:.3f} s, nine of ten within "
          f"{plans[9 * len(plans) // 10]:.3f} s, longest {plans[-1]:.3f} s")


def report(rows):
    # Below this the clock of processes and the start of the program decide.
    least_s = 0.01
    done = [row for row in rows if row[3] != ""]
    print(f"{len(rows)} scenes, {len(rows) - len(done)} took more than two minutes")

    def miss(row):
        a, b = max(row[2], least_s), max(row[3], least_s)
        return max(a / b, b / a)
    ratios = sorted(max(row[2], least_s) / max(row[3], least_s) for row in done)
    if ratios:
        print(f"planned to measured time: median {ratios[len(ratios) // 2]:.2f}, "
              f"{ratios[0]:.2f} to {ratios[-1]:.2f}")
    for factor in (2, 3, 4, 10):
        within = sum(miss(row) <= factor for row in done)
        print(f"time within a factor of {factor} (both at least {least_s} s): {within} of {len(done)}")
    memory = sum(max(row[4] / row[5], row[5] / row[4]) <= 2 for row in done if row[4])
    print(f"memory within a factor of 2: {memory} of {len(done)}")
    for row in sorted(done, key=miss, reverse=True)[:10]:
        print(f"  {row[2]:.3g} s for {row[3]:.3g} s: {row[0]} {row[1]} [{row[6]}]")


if __name__ == "__main__":
    main()
