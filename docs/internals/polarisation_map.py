#!/usr/bin/env python3
"""Where polarisation matters: what leaving it out changes of R11, over size parameter and index.

    docs/internals/polarisation_map.py [PROGRAM] > map.md

Half-spaces of spheres that absorb nothing, in air at 550 nm (gamma distribution, effective variance
0.1), solved by the program with --stokes 1 and --stokes 3. The table of docs/polarisation.md: the
largest |R1 / R3 - 1| of the directions mu_in, mu_out 0.1 ... 1, azimuth 0 ... 180 in steps of 15
degrees, and the polarisation that goes with it.
"""

import csv
import subprocess
import sys

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "miebrdf"
SIZE_PARAMETERS = [0.3, 0.6, 1, 1.5, 2, 3, 4, 6, 10, 20, 30]
INDICES = [1.33, 1.5, 2, 2.7]
WAVELENGTH_UM = 0.55
COSINES = "0.1,0.2,0.4,0.6,0.8,1"
TOLERANCE = 1e-4


def columns(index: float, radius_um: float, stokes: int) -> dict[str, list[float]]:
    """What the program prints, by column."""
    command = [PROGRAM, "brdf", "--base", f"index:{index},0,radius={radius_um:.9g}",
               "--size-distribution", "gamma", "--effective-variance", "0.1",
               "--wavelengths", f"{1e3 * WAVELENGTH_UM:g}", "--mu-in", COSINES,
               "--mu-out", COSINES, "--azimuth", "0:180:15", "--stokes", str(stokes),
               "--tolerance", str(TOLERANCE), "--no-cache"]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4):  # 4: written, single values miss the tolerance
        sys.exit(done.stderr)
    rows = csv.DictReader(line for line in done.stdout.splitlines() if not line.startswith("#"))
    table: dict[str, list[float]] = {}
    for row in rows:
        for name, text in row.items():
            table.setdefault(name, []).append(float(text))
    return table


def cell(index: float, size_parameter: float) -> str:
    """Largest change of R11, and largest degree of linear polarisation."""
    radius_um = size_parameter * WAVELENGTH_UM / (2 * 3.141592653589793)
    scalar = columns(index, radius_um, 1)["brdf"]
    polarised = columns(index, radius_um, 3)
    change = max(abs(a / b - 1) for a, b in zip(scalar, polarised["m11"]))
    return f"{change:.1e}, {max(polarised['dolp']):.2f}"


def main() -> None:
    print("| x | " + " | ".join(f"n {index:g}" for index in INDICES) + " |")
    print("|---" * (1 + len(INDICES)) + "|")
    for size_parameter in SIZE_PARAMETERS:
        cells = [cell(index, size_parameter) for index in INDICES]
        print(f"| {size_parameter:g} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
