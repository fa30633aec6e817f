#!/usr/bin/env python3
"""What derivatives err by at the default tolerance, as a table.

    derivative_errors.py PROGRAM [--count 25] [--seed 1] [--kind NAME]... [--worst 10] [--jobs 1]

Every kind gets `count` derivatives by numbers of random scenes. The truth is a central difference of
values at a tolerance of 1e-8 (rough boundaries 1e-5), of numbers 1 and 2 % to both sides, or of the
steps that a kind names, extrapolated to none. Errors are relative to the largest derivative by the
same number over the cosines or directions of the request. Derivatives are counted where the truth
is certain: where both differences agree to 3e-3 of it (the extrapolated one errs by far less), and
the number moves a value by at least 1e-3 of the largest value when it changes by its own size.
"""
import argparse
import concurrent.futures
import random
import re
import subprocess

STEP = 0.01
ALBEDO = ["albedo", "--mu-in", "0.2,0.5,1", "--stokes", "1"]
BRDF = ["brdf", "--mu-in", "0.3,0.8", "--mu-out", "0.2,0.6,1", "--azimuth", "0,90,180", "--stokes",
        "1"]


class Case:
    """Words of a scene with `{a}`, and the value of a."""

    def __init__(self, words, value, step=None, tight="1e-8", one_sided=False):
        self.words, self.value, self.tight = words, value, tight
        self.step = step if step is not None else STEP * value
        self.one_sided = one_sided  # at the least value that is allowed

    def words_at(self, value):
        return [word.replace("{a}", repr(value)) for word in self.words]


def hg(rng):
    return f"hg:{rng.uniform(.5, .99):.4f},{rng.uniform(-.2, .85):.4f}"


def ground(rng):
    return rng.choice([["--base", hg(rng)],
                       ["--substrate", f"lambert:{rng.uniform(.1, .9):.3f}"],
                       ["--substrate", "black"]])


def asked(rng):
    return list(rng.choice([ALBEDO, BRDF]))


def one_number(rng, text):
    """One `<value>` of a text becomes the number; others are what they are."""
    numbers = re.findall(r"<([^<>]*)>", text)
    chosen = rng.randrange(len(numbers))
    count = iter(range(len(numbers)))
    return (re.sub(r"<([^<>]*)>",
                   lambda m: "{a}" if next(count) == chosen else m.group(1), text),
            float(numbers[chosen]))


def layers(rng):
    text, value = one_number(rng, f"hg:<{rng.uniform(.5, .99):.4f}>,<{rng.uniform(.1, .85):.4f}>"
                                  f"@<{10 ** rng.uniform(-1.5, .8):.4f}>")
    return Case([*asked(rng), *ground(rng), "--coat", text], value)


def grounds(rng):
    text, value = one_number(rng, rng.choice(
        [f"lambert:<{rng.uniform(.1, .9):.3f}>",
         f"mirror:index:<{rng.uniform(.2, 2):.3f}>,<{rng.uniform(2, 6):.3f}>"]))
    boundary = ["--boundary", "smooth"] if rng.random() < .5 else []
    host = " in index:1.5" if boundary else ""
    return Case([*asked(rng), "--substrate", text, "--coat",
                 f"{hg(rng)}{host}@{10 ** rng.uniform(-1.5, .5):.4f}", *boundary], value)


def lobes(rng):
    return Case([*asked(rng), "--base", hg(rng), "--surface-index", f"{rng.uniform(1.3, 2.5):.3f}",
                 "--roughness", "{a}"], round(rng.uniform(.1, .5), 3))


def laboratory(rng):
    text, value = one_number(
        rng, f"turbid:<{10 ** rng.uniform(-3, 0):.4f}>,<{10 ** rng.uniform(-.5, 1):.3f}>,"
             f"<{rng.uniform(.3, .9):.3f}>")
    return Case([*asked(rng), *ground(rng), "--coat", f"{text}@{rng.uniform(.1, 3):.3f}mm"], value)


def mixtures(rng):
    text, value = one_number(
        rng, f"index:2.7,1e-4,radius=.13,variance=.2,volume=<{rng.uniform(1, 15):.2f}>% + "
             f"index:1.6,{10 ** rng.uniform(-4, -2):.5f},radius=<{rng.uniform(.1, 1.5):.3f}>,"
             f"variance=.1,volume=<{rng.uniform(.5, 10):.2f}>% in index:1.5"
             f"@<{rng.uniform(5, 40):.1f}>um")
    return Case([*asked(rng), "--substrate", rng.choice(["black", "lambert:.5", "none"]),
                 "--boundary", "smooth", "--coat", text], value)


def hosts_apart(rng):
    n = rng.uniform(1.2, 1.45)
    text, value = one_number(rng, f"{hg(rng)} in index:<{n + rng.uniform(.1, .4):.4f}>@1")
    return Case([*asked(rng), *ground(rng), "--coat", f"{hg(rng)} in index:{n:.4f}@0.8", "--coat",
                 text, "--boundary", "smooth"], value, step=2e-3)


def hosts_close(rng):
    n = rng.uniform(1.2, 1.6)
    apart = rng.choice([0.0, *(10 ** rng.uniform(-5, -1.5) for _ in range(5))])
    # Around the other index truth is had from differences that stay on one side, where there are
    # two.
    return Case([*asked(rng), "--substrate", "lambert:.5", "--coat",
                 f"{hg(rng)} in index:{n:.5f}@1", "--coat", f"{hg(rng)} in index:{{a}}@1",
                 "--boundary", "smooth"], round(n, 5) + apart,
                step=max(1e-5, 0.2 * apart) if apart else 2e-4)


def close_to_air(rng):
    apart = 10 ** rng.uniform(-5, -1.5)
    return Case([*asked(rng), "--base", f"{hg(rng)} in index:{{a}}", "--boundary", "smooth"],
                1 + apart, step=0.1 * apart, tight="1e-9")


def rough(rng):
    text, value = one_number(rng, f"rough:<{rng.uniform(.1, .5):.3f}>")
    host = f"{rng.uniform(1.35, 1.6):.3f}"
    if rng.random() < .5:
        text, (host, value) = f"rough:{value}", ("{a}", float(host))
    return Case([*asked(rng), *ground(rng), "--coat", f"{hg(rng)} in index:{host}@1", "--boundary",
                 text], value, tight="1e-5")


def spheres(law):
    def case(rng):
        variance = {"mono": "", "power-law": f",variance=<{rng.uniform(.05, .25):.3f}>"}.get(
            law, f",variance=<{rng.uniform(.05, .4):.3f}>")
        k = 10 ** rng.uniform(-4, -1)
        text, value = one_number(
            rng, f"index:<{rng.uniform(1.3, 2.7):.3f}>,<{k:.6f}>,radius="
                 f"<{10 ** rng.uniform(-1.3, .7):.4f}>{variance}")
        if law != "mono":
            text += f",distribution={law}"
        words = [*asked(rng), *ground(rng)]
        return Case([*words, "--coat", f"{text}@1"], value)
    return case


def films(rng):
    text, value = one_number(
        rng, f"index:<2.7>,<1e-4>,radius=<{rng.uniform(.08, .3):.3f}>,variance=<.2>,"
             f"distribution=log-normal,volume=<{rng.uniform(1, 20):.2f}>% in index:1.5"
             f"@<{rng.uniform(5, 40):.1f}>um")
    packing = ["--packing", "percus-yevick"] if rng.random() < .5 else []
    return Case([*asked(rng), "--substrate", "black", "--boundary", "smooth", "--coat", text,
                 *packing], value)


def coatings(rng):
    law = rng.choice(["gamma", "log-normal", "power-law"])
    thickness = rng.choice([0.0, 10 ** rng.uniform(-2, 1.5)])
    text = (f"index:{rng.uniform(1.4, 2.6):.3f},{10 ** rng.uniform(-3, -1):.5f},"
            f"radius={10 ** rng.uniform(-1.3, .2):.4f},variance=.1,distribution={law},"
            f"coating=index:{rng.uniform(1.3, 1.6):.3f},0@{{a}}nm")
    return Case([*asked(rng), *ground(rng), "--coat", f"{text}@1"], thickness,
                step=0.02 if thickness == 0 else None, one_sided=thickness == 0)


def large(rng):
    law = rng.choice(["gamma", "log-normal", "power-law"])
    text, value = one_number(
        rng, f"index:<1.31>,<{10 ** rng.uniform(-5, -3):.7f}>,radius=<{rng.uniform(20, 200):.1f}>,"
             f"variance=<{rng.uniform(.1, .25):.3f}>")
    return Case([*ALBEDO, "--base", f"{text},distribution={law}"], value, step=.03 * value,
                tight="1e-6")


def polarised(rng):
    case = rng.choice([spheres("gamma"), layers])(rng)
    case.words[case.words.index("--stokes") + 1] = "3"
    return case


KINDS = {
    "layers of analytic media: albedo, g, depth": layers,
    "grounds: albedo, n and k of a mirror": grounds,
    "roughness of an opaque lobe": lobes,
    "turbid media: absorption, scattering, g": laboratory,
    "index of a host": hosts_apart,
    "index of a host close to another (1e-5 to .03, or the same)": hosts_close,
    "index of a host close to air (1e-5 to .03)": close_to_air,
    "rough boundary: roughness, index of the host": rough,
    "one size: n, k, radius": spheres("mono"),
    "gamma: n, k, radius, variance": spheres("gamma"),
    "log-normal": spheres("log-normal"),
    "power law": spheres("power-law"),
    "films of rutile: amounts, thickness, n, k, sizes; half of them crowded": films,
    "mixtures of two: amounts, a radius, thickness": mixtures,
    "thickness of a coating, or none yet": coatings,
    "large grains": large,
    "polarised light": polarised,
}


def run(program, words, columns):
    done = subprocess.run([program, *words, "--wavelengths", "550"], capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if not line.startswith("#")]
    if done.returncode not in (0, 4) or not lines:
        raise RuntimeError(done.stderr.strip() or "no values")
    names = lines[0].split(",")
    rows = [line.split(",") for line in lines[1:]]
    return [[float(row[names.index(column)]) for row in rows] for column in columns]


def measured(program, case):
    """(error, or None where the truth is not certain)"""
    column = "plane_albedo" if case.words[0] == "albedo" else "brdf"
    named = [word.replace("{a}", f"{{a={case.value!r}}}") for word in case.words]
    values, found = run(program, [*named, "--derivatives", "a"], [column, f"{column}_d_a"])

    def at(steps):
        return run(program, [*case.words_at(case.value + steps * case.step), "--tolerance",
                             case.tight], [column])[0]

    if case.one_sided:
        f = [at(s) for s in range(5)]
        fine = [(-3 * a + 4 * b - c) / (2 * case.step) for a, b, c in zip(f[0], f[1], f[2])]
        wide = [(-3 * a + 4 * b - c) / (4 * case.step) for a, b, c in zip(f[0], f[2], f[4])]
    else:
        f = {s: at(s) for s in (-2, -1, 1, 2)}
        fine = [(b - a) / (2 * case.step) for a, b in zip(f[-1], f[1])]
        wide = [(b - a) / (4 * case.step) for a, b in zip(f[-2], f[2])]
    truth = [(4 * a - b) / 3 for a, b in zip(fine, wide)]
    largest = max(map(abs, truth))
    doubt = max(abs(a - b) for a, b in zip(fine, wide))
    size = max(abs(case.value), 100 * case.step)
    if not doubt <= 3e-3 * largest or not largest * size >= 1e-3 * max(map(abs, values)):
        return None
    return max(abs(a - b) for a, b in zip(found, truth)) / largest


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append", default=[])
    parser.add_argument("--worst", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()

    def outcome(case):
        try:
            return measured(options.program, case), None
        except RuntimeError as error:
            return None, str(error)

    everything, failed = [], []
    print("| kind | derivatives | median | 90 % | largest | above 1e-3 | uncertain |")
    print("|---|---|---|---|---|---|---|")
    for name, make in KINDS.items():
        if options.kind and not any(part in name for part in options.kind):
            continue
        rng = random.Random(f"{options.seed} {name}")
        cases = [make(rng) for _ in range(options.count)]
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            outcomes = list(pool.map(outcome, cases))
        errors = sorted(error for error, _ in outcomes if error is not None)
        failed += [(case, why) for case, (_, why) in zip(cases, outcomes) if why]
        everything += [(error, case) for case, (error, _) in zip(cases, outcomes)
                       if error is not None]
        if not errors:
            print(f"| {name} | 0 |  |  |  |  | {len(cases)} |", flush=True)
            continue
        print(f"| {name} | {len(errors)} | {errors[len(errors) // 2]:.1e} | "
              f"{errors[int(.9 * (len(errors) - 1))]:.1e} | {errors[-1]:.1e} | "
              f"{sum(e > 1e-3 for e in errors)} | {len(cases) - len(errors)} |", flush=True)
    print(f"| all | {len(everything)} |  |  |  | {sum(e > 1e-3 for e, _ in everything)} | |")
    for error, case in sorted(everything, key=lambda one: -one[0])[:options.worst]:
        print(f"{error:.1e}  a = {case.value!r}: {' '.join(case.words)}")
    for case, why in failed:
        print(f"failed  a = {case.value!r}: {' '.join(case.words)}: {why}")


if __name__ == "__main__":
    main()
