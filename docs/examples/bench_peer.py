#!/usr/bin/env python3
"""A peer of `miebrdf bench` (docs/benchmarking.md): isotropic half-spaces by Chandrasekhar's
H-function, iterated on Gauss nodes. Put your own program in place of `reflection` and `albedo`.

    miebrdf bench --suite half-space --peer "H by iteration=python3 docs/examples/bench_peer.py" -o out
"""

import json
import math
import sys
import time


def gauss(n):
    """Nodes and weights on (0, 1), by Newton's iteration."""
    nodes, weights = [], []
    for i in range(n):
        x = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        for _ in range(50):
            p, q = 1.0, 0.0
            for k in range(1, n + 1):
                p, q = ((2 * k - 1) * x * p - (k - 1) * q) / k, p
            slope = n * (x * p - q) / (x * x - 1)
            x -= p / slope
        nodes.append(0.5 * (1 + x))
        weights.append(1 / ((1 - x * x) * slope * slope))
    return nodes, weights


def h_function(albedo, n):
    """H of the nodes solves 1 / H = sqrt(1 - a) + a / 2 int t H(t) / (t + mu) dt."""
    nodes, weights = gauss(n)
    root, h = math.sqrt(1 - albedo), [1.0] * n

    def at(mu):
        return 1 / (root + albedo / 2 * sum(w * t * H / (t + mu)
                                            for t, w, H in zip(nodes, weights, h)))

    for _ in range(200):
        h = [at(mu) for mu in nodes]
    return at


def values(question):
    albedo, n = question["base"]["albedo"], int(question["setting"])
    h = h_function(albedo, n)
    if question["quantity"] == "plane_albedo":
        return [1 - math.sqrt(1 - albedo) * h(mu) for mu in question["mu_in"]]
    return [albedo / (4 * (i + o)) * h(i) * h(o)
            for i in question["mu_in"] for o in question["mu_out"] for _ in question["azimuth_deg"]]


for line in sys.stdin:
    question = json.loads(line)
    if question["ask"] == "settings":
        can = question["base"]["asymmetry"] == 0 and "coat" not in question
        answer = {"settings": ["8", "16", "32"] if can else []}
    else:
        start = time.process_time()
        answer = {"values": values(question), "seconds": time.process_time() - start}
    print(json.dumps(answer), flush=True)
