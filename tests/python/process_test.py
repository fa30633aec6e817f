"""Copies, threads, processes, signals, memory: what long-running scripts do."""

import copy
import gc
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import miebrdf
from miebrdf import Scene, coat, medium

MU = np.linspace(0.1, 1, 10)
NM = [450.0, 650.0]
PAINT = Scene(
    medium("TiO2", radius_um=0.2),
    coats=[coat("Au", depth=0.5, radius_um=0.03), "hg:0.9,0.1@0.2[grey]"],
    roughness=0.3,
    surface_index=1.5,
    coupling="reciprocal",
)
# Many jobs of a tenth of a second or so.
LONG = Scene(medium("TiO2", radius_um=20.0, variance=0.1))
LONG_NM = np.arange(400, 701, 2)


@pytest.mark.parametrize(
    "twice", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))]
)
@pytest.mark.parametrize(
    "thing",
    [
        PAINT,
        Scene(substrate=miebrdf.lambertian([0.1, 0.2], [400, 700]), coats="hg:0.9,0.1@1"),
        Scene(medium(index=[1.6 + 0.01j, 1.5 + 0.01j], wavelengths_nm=[400, 700], radius_um=0.2)),
        Scene("TiO2", size_distribution=([0.1, 0.2, 0.3], [0.0, 1.0, 0.0])),
        Scene("TiO2,radius=0.12,coating=SiO2@5nm,coating=index:1.5,0.01@10%"),
        Scene("TiO2,junge=4,from=0.1,to=1", coats="H2O_ice,ssa=60m2/kg,shape=koch,aspect=2@0.1"),
    ],
    ids=["paint", "ground", "own index", "own sizes", "coated", "grains"],
)
def test_scenes_are_copied_and_pickled(thing, twice):
    other = twice(thing)
    assert other == thing and hash(other) == hash(thing) and str(other) == str(thing)
    np.testing.assert_array_equal(other.brdf(550, 0.5, MU), thing.brdf(550, 0.5, MU))


def test_solved_scenes_are_copied_and_pickled():
    solved = PAINT.solve(NM)
    values = solved(0.5, MU)
    for other in (copy.deepcopy(solved), pickle.loads(pickle.dumps(solved))):
        np.testing.assert_array_equal(other(0.5, MU), values)
    assert pickle.loads(pickle.dumps(PAINT.solve(550)))(0.5, MU).shape == (10,)


def test_small_things_are_pickled():
    for thing in (
        medium("TiO2,volume=2% + SiO2,volume=1% in PMMA"),
        medium("H2O_ice,radius=0.5,shape=spheroid,method=t-matrix", layer_density_kg_m3=300),
        coat("TiO2@40um"),
        miebrdf.Depth("inf"),
    ):
        assert str(pickle.loads(pickle.dumps(thing))) == str(thing)
    material = pickle.loads(pickle.dumps(miebrdf.materials["TiO2"]))
    assert material.nk(550) == miebrdf.materials["TiO2"].nk(550)
    error = pickle.loads(pickle.dumps(_error()))
    assert str(error) == str(_error()) and error.field == "mu_in"


def _error():
    try:
        PAINT.brdf(550, 7.0, 0.5)
    except miebrdf.UsageError as error:
        return error
    raise AssertionError


def test_threads_share_a_solved_scene():
    solved = PAINT.solve(NM)
    alone = [solved(mu, MU[:, None], np.arange(0, 181, 10)) for mu in MU]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda mu: solved(mu, MU[:, None], np.arange(0, 181, 10)), MU))
    np.testing.assert_array_equal(together, alone)
    fresh = PAINT.solve(NM)
    with ThreadPoolExecutor(4) as pool:
        exact = list(pool.map(lambda mu: fresh.exact(mu, MU), MU))
    np.testing.assert_array_equal(exact, [solved.exact(mu, MU) for mu in MU])


def test_results_do_not_depend_on_the_number_of_threads():
    np.testing.assert_array_equal(
        PAINT.brdf(NM, 0.5, MU, threads=1), PAINT.brdf(NM, 0.5, MU, threads=2)
    )


def test_other_threads_run_during_long_calls():
    """The interpreter's lock is released: a counter goes on."""
    steps, done = [], threading.Event()

    def count():
        while not done.is_set():
            steps.append(time.monotonic())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    begin = time.monotonic()
    LONG.brdf(LONG_NM[:20], 0.5, MU, tolerance=1e-2)
    end = time.monotonic()
    done.set()
    counter.join()
    during = [step for step in steps if begin < step < end]
    # Held throughout, there would be one step at most.
    assert len(during) >= 5 or end - begin < 0.05


def _ask(mu):
    return PAINT.brdf(NM, float(mu), MU)


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes(method):
    expected = [_ask(mu) for mu in MU[:4]]  # the pool of threads is running when a child is forked
    with multiprocessing.get_context(method).Pool(2) as pool:
        results = pool.map_async(_ask, MU[:4]).get(timeout=120)
    np.testing.assert_array_equal(results, expected)


def test_ctrl_c_ends_a_long_call_and_the_next_one_works():
    main = threading.main_thread()
    assert threading.current_thread() is main
    begin = time.monotonic()
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while time.monotonic() < begin + 60:  # whatever the machine: one call does not suffice
            LONG.brdf(LONG_NM, 0.5, MU)
    timer.join()
    assert PAINT.brdf(550, 0.5, 0.5) > 0


def test_progress_is_told_and_may_stop_the_work():
    seen = []
    LONG.brdf(LONG_NM[:30], 0.5, MU, tolerance=1e-2, progress=lambda *facts: seen.append(facts))
    assert all(0 < done <= total for _, done, total in seen)

    def stop(stage, done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        for _ in range(100):
            LONG.brdf(LONG_NM, 0.5, MU, progress=stop)


def test_progress_without_tqdm_is_a_plain_line(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    from miebrdf import _options

    monkeypatch.setattr(_options, "_FIRST_SHOWN_S", 0.0)
    shown = _options._Shown()
    shown("Mie theory", 3, 31)
    shown.close()
    assert "Mie theory: 3 of 31" in capsys.readouterr().err


def _resident_kb():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") // 1024


def test_nothing_leaks():
    """Half an hour of small calls, shortened: references and memory stay where they are."""
    solved = PAINT.solve(NM)
    directions = np.linspace(0.1, 1, 1000)
    out = np.empty((2, 1000))

    def work():
        for _ in range(50):
            solved(0.5, directions, out=out)
            solved(0.5, directions)
            solved.sample(0.5, directions * 0.9, directions * 0.9)
            miebrdf.sphere(1.5, directions)
            miebrdf.materials["TiO2"].nk([500, 600])
            Scene("hg:0.9,0.1", coats="hg:0.5,0@0.1").brdf(550, 0.5, MU)
            pickle.loads(pickle.dumps(PAINT))
            try:
                solved(7.0, directions)
            except miebrdf.UsageError:
                pass

    for _ in range(3):
        work()  # caches of the interpreter and the allocator fill up
    gc.collect()
    references = [sys.getrefcount(each) for each in (directions, out, PAINT, solved)]
    before = _resident_kb()
    for _ in range(6):
        work()
    gc.collect()
    after = [sys.getrefcount(each) for each in (directions, out, PAINT, solved)]
    assert after == references
    # 300 rounds of 16 to 48 kB arrays: one lost in each would be 5 to 15 MB.
    assert _resident_kb() - before <= 4000


@pytest.mark.parametrize(
    "work",
    [
        lambda: Scene(medium("H2O", radius_um=1000.0, variance=0.01)).brdf(
            550, 0.5, np.linspace(0.1, 1, 20)[:, None], np.linspace(0, 180, 91)
        ),
        lambda: miebrdf.phase("H2O", 550, np.linspace(0, 180, 1801), radius_um=1000, variance=1e-3),
        lambda: Scene("hg:0.99,0.95", coats="hg:0.99,0.9@20").brdf(
            550, 0.5, 0.5, streams=128, coat_method="first-order", coat_substeps=100000
        ),
        lambda: Scene("H2O_ice,radius=600,coating=H2O@10um").brdf(550, 0.5, 0.5),
        lambda: miebrdf.ensemble("H2O", 550, radius_um=2000, variance=1e-3, highest_moment=2000),
        lambda: miebrdf.amplitudes(1.33 + 1e-9j, 1e6, np.linspace(0, 180, 1801)),
    ],
    ids=["many values", "phase function", "steps of a coat", "coated spheres", "moments", "amplitudes"],
)
def test_ctrl_c_ends_one_wavelength(work):
    """Each takes ten seconds and more."""

    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 1.0)
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            work()
        # Half a second on a machine with nothing else to do; a busy one may take a while to wake up.
        assert time.monotonic() - begin <= 1.0 + 0.5 * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
