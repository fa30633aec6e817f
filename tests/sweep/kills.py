#!/usr/bin/env python3
"""Ends `miebrdf sweep` with kill -9 at random moments, again and again, until it completes.

    kills.py PROGRAM FOLDER KILLS

Checks that no chunk that was finished before a kill is computed again (its file stays the same
file), and that the table equals, byte for byte, that of a run that nobody disturbed. Prints a tally.
"""
import pathlib
import random
import shutil
import subprocess
import sys
import time

SWEEP = """outputs = ["plane_albedo", "brdf"]
chunk = 2
[scene]
base = "hg:{albedo},{g}"
coat = "hg:0.9,0.5@{depth}"
tolerance = 1e-2
[axes]
albedo = "0.1:0.9:9 linear"
g = [0, 0.2, 0.4]
depth = "0.1:3:30 log"
mu_in = [0.5, 1]
mu_out = [0.3, 0.9]
azimuth_deg = [0, 180]
wavelength_nm = 550
"""


def main():
    program, folder, wanted = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "sweep.toml").write_text(SWEEP)
    tables = ["calm.csv", "killed.csv"]
    command = [program, "sweep", str(folder / "sweep.toml"), "-q", "-o"]
    start = time.monotonic()
    subprocess.run([*command, str(folder / tables[0])], check=True)
    calm = time.monotonic() - start

    parts = folder / (tables[1] + ".parts")
    chance = random.Random(1)
    kills = runs = replaced = restarts = 0
    known = {}

    def look():
        nonlocal replaced
        for file in parts.glob("chunk-???????"):
            inode = file.stat().st_ino, file.stat().st_mtime_ns
            if known.setdefault(file.name, inode) != inode:
                replaced += 1

    while kills < wanted:
        runs += 1
        running = subprocess.Popen([*command, str(folder / tables[1])])
        # Early kills meet the start, late ones the table and the removal of the parts.
        try:
            running.wait(timeout=chance.uniform(0.0, 0.4 * calm + 0.02))
            ended = True
        except subprocess.TimeoutExpired:
            running.kill()
            running.wait()
            kills += 1
            ended = False
        whole = (folder / tables[1]).exists()
        if not whole:
            look()
        if whole:  # complete: begin again for the kills that are left
            if not same(folder, tables):
                sys.exit("the table differs from that of an undisturbed run")
            if ended:
                restarts += 1
                (folder / tables[1]).unlink()
                shutil.rmtree(parts, ignore_errors=True)
                known.clear()
    subprocess.run([*command, str(folder / tables[1])], check=True)
    if not same(folder, tables):
        sys.exit("the table differs from that of an undisturbed run")
    left = sorted(file.name for file in folder.iterdir())
    if left != sorted([*tables, "sweep.toml"]):
        sys.exit(f"left behind: {left}")
    if replaced:
        sys.exit(f"{replaced} finished chunks were computed again")
    print(f"{kills} kills in {runs} runs, {restarts} completed between them; "
          f"0 finished chunks computed again; tables equal")


def same(folder, tables):
    return (folder / tables[0]).read_bytes() == (folder / tables[1]).read_bytes()


main()
