#!/usr/bin/env python3
"""How far converged BRDFs of spheres near retro-reflection are from solutions with many more nodes.

    retro_reflection.py PROGRAM [--scenes 260] [--seed 1] [--radii 0.4 6] [--nodes 256]

Random half-spaces of spheres at 550 nm (n 1.25 to 3.4; k 0, or 1e-6 to 1e-2; variance 0.05 to 0.3),
half of them under a coat. Seven in ten are asked for at 0, 0.4 and 2 degrees from exact
retro-reflection, the others at a list of directions. The reference has the given number of nodes and
a Mie tolerance of 1e-5. Errors are relative to the largest value at the same incidence. The table
says, for each tolerance, how many scenes converge and how many of these are beyond it.
"""
import argparse
import json
import random
import subprocess
import sys

TOLERANCES = ("1e-2", "1e-3")


def number(rng, low, high):
    """A number between two positive ones, every decade alike."""
    return float(f"{low * (high / low) ** rng.random():.3g}")


def spheres(rng, radii):
    k = 0 if rng.random() < 0.5 else number(rng, 1e-6, 1e-2)
    return (f"index:{rng.uniform(1.25, 3.4):.3f},{k},radius={number(rng, *radii)},"
            f"variance={rng.uniform(0.05, 0.3):.2f}")


def request(rng, radii):
    words = ["--base", spheres(rng, radii), "--wavelengths", "550"]
    if rng.random() < 0.5:
        words += ["--coat", f"{spheres(rng, radii)}@{number(rng, 0.02, 2)}"]
    if rng.random() < 0.7:
        mu = f"{rng.choice([0.2, 0.5, 0.8, 1.0]):g}"
        return words + ["--mu-in", mu, "--mu-out", mu, "--azimuth", "180,179.6,178"]
    return words + ["--mu-in", f"{rng.uniform(0.1, 1):.3f}", "--mu-out", "0.1,0.35,0.6,0.9",
                    "--azimuth", "0,60,120,175"]


def brdf(program, words):
    """Values and whether they converged."""
    done = subprocess.run([program, "brdf", *words, "--no-cache", "--threads", "1", "--json"],
                          capture_output=True, text=True)
    if done.returncode not in (0, 4):
        sys.exit(f"exit code {done.returncode}: {' '.join(words)}\n{done.stderr}")
    table = json.loads(done.stdout)
    column = [c if isinstance(c, str) else c["name"] for c in table["columns"]].index("brdf")
    return [row[column] for row in table["rows"]], done.returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--scenes", type=int, default=260)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--radii", type=float, nargs=2, default=[0.4, 6.0], metavar="UM")
    parser.add_argument("--nodes", type=int, default=256)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    errors = {tolerance: [] for tolerance in TOLERANCES}
    for _ in range(arguments.scenes):
        words = request(rng, arguments.radii)
        exact, _ = brdf(arguments.program, [*words, "--streams", str(arguments.nodes),
                                            "--mie-tolerance", "1e-5"])
        for tolerance in TOLERANCES:
            values, converged = brdf(arguments.program, [*words, "--tolerance", tolerance])
            if converged:
                worst = max(abs(v - e) for v, e in zip(values, exact)) / max(exact)
                errors[tolerance].append((worst / float(tolerance), " ".join(words)))
    low, high = arguments.radii
    print("| spheres | tolerance | scenes | converged | of these beyond the tolerance | beyond twice "
          "| median | worst |\n|---|---|---|---|---|---|---|---|")
    for tolerance, found in errors.items():
        found.sort()
        print(f"| {low:g} to {high:g} um, against {arguments.nodes} nodes | {tolerance} | "
              f"{arguments.scenes} | {len(found)} | {sum(not e <= 1 for e, _ in found)} | "
              f"{sum(not e <= 2 for e, _ in found)} | {found[len(found) // 2][0]:.2g} times | "
              f"{found[-1][0]:.2g} times |")
    for tolerance, found in errors.items():
        print(f"worst at {tolerance}: {found[-1][1]}", file=sys.stderr)


if __name__ == "__main__":
    main()
