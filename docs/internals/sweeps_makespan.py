#!/usr/bin/env python3
"""How long a sweep takes on many processors: list scheduling of measured costs.

    sweeps_makespan.py COSTS.csv SCENES_PER_GROUP [OPERATIONS_PER_SECOND]

COSTS.csv is of `miebrdf sweep --threads 1 --costs` with `chunk = 1`. Each process takes chunks as
run_crew (pipeline/sweep/crew.cpp) does: from its own share on, then whatever is left. The first
scene that a process computes of a group costs the group's Mie theory too, unless another one has
stored it by then; that is the measured cost of the group's first scene less the median of its
others. A chunk takes four operations of the shared file system (claim, create, rename, look), Mie
theory two more; these are done one after the other, as many per second as the last argument says
(default 10000).
"""
import csv
import heapq
import statistics
import sys


def makespan(chunks, mie, group_of, processes, per_second):
    """Seconds until all is done, processor seconds spent, and those of Mie theory done again."""
    count = len(chunks)
    following = list(range(count + 1))  # the next chunk that nobody has, from each place

    def untaken(place):
        while following[place] != place:
            following[place] = following[following[place]]
            place = following[place]
        return place

    known = [set() for _ in range(processes)]
    place = [number * count // processes for number in range(processes)]
    free = [(0.0, number) for number in range(processes)]
    files, end, spent, mie_spent = 0.0, 0.0, 0.0, 0.0
    stored = {}  # when the Mie theory of a group is there for all
    left = count
    while left:
        now, number = heapq.heappop(free)
        chunk = untaken(place[number])
        if chunk == count:
            chunk = untaken(0)
        following[chunk] = chunk + 1
        place[number] = chunk + 1
        left -= 1
        group = group_of(chunk)
        cost = chunks[chunk]
        if group not in known[number]:
            known[number].add(group)
            files = max(files, now) + 2.0 / per_second
            if now < stored.get(group, float("inf")):
                cost += mie[group]
                mie_spent += mie[group]
                stored[group] = min(stored.get(group, float("inf")), now + mie[group])
        spent += cost
        files = max(files, now) + 4.0 / per_second
        done = max(now + cost, files)
        end = max(end, done)
        heapq.heappush(free, (done, number))
    return end, spent, mie_spent - sum(mie)


def main():
    size = int(sys.argv[2])
    per_second = float(sys.argv[3]) if len(sys.argv) > 3 else 1e4
    with open(sys.argv[1], encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        costs = [float(row["processor_seconds"]) for row in rows]
    groups = [costs[first:first + size] for first in range(0, len(costs), size)]
    mie, chunks = [], []
    for group in groups:
        usual = statistics.median(group[1:])
        mie.append(max(group[0] - usual, 0.0))
        chunks += [min(group[0], usual), *group[1:]]
    once = sum(chunks) + sum(mie)
    print(f"{len(chunks)} scenes in {len(groups)} groups, {once:.1f} s, {sum(mie):.1f} s of them Mie "
          f"theory; longest scene {max(chunks):.3f} s, Mie theory of a group up to {max(mie):.3f} s")
    print("| processes | seconds | speed-up | efficiency | Mie theory done again |")
    print("|---|---|---|---|---|")
    for processes in (1, 2, 10, 100, 1000, 10000):
        end, _, again = makespan(chunks, mie, lambda c: c // size, processes, per_second)
        print(f"| {processes} | {end:.3g} | {once / end:.4g} | {once / end / processes:.1%} | "
              f"{again / once:.1%} |")


main()
