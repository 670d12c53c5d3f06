"""Threads, interrupts, forks, and an interpreter that closes: right results, or an exception, and never a process that hangs."""
import gc
import multiprocessing
import os
import pathlib
import signal
import threading
import time
import traceback

import numpy as np
import pytest
from conftest import AMPHORA, cube, run

import pysherd

LONG = {"resolution": 600, "growth": "chain", "roughness": 2, "pieces": 300}


def test_progress_comes_from_the_calling_thread(amphora):
    seen = []
    f = pysherd.fracture(AMPHORA, resolution=200, pieces=20, progress=lambda *stage: seen.append((threading.get_ident(), *stage)))
    assert len(f) == 20
    assert {thread for thread, _, _ in seen} <= {threading.get_ident()}
    assert all(isinstance(stage, str) and 0 <= fraction <= 1 for _, stage, fraction in seen)


@pytest.mark.parametrize("wanted", ["voxelize", "any"])
def test_progress_cancels(wanted):
    start, stopped = time.monotonic(), []

    def progress(stage, fraction):
        if wanted in (stage, "any") and not stopped:
            stopped.append(time.monotonic())
            return False

    with pytest.raises(pysherd.Cancelled) as caught:
        pysherd.fracture(AMPHORA, **LONG, progress=progress)
    assert caught.value.code == 130
    assert time.monotonic() - stopped[0] < 1.5 and stopped[0] >= start


def test_an_exception_of_progress_passes():
    def progress(stage, fraction):
        raise KeyError(stage)

    with pytest.raises(KeyError):
        pysherd.fracture(AMPHORA, **LONG, progress=progress)
    assert len(pysherd.fracture(cube(), pieces=2, resolution=16)) == 2


@pytest.mark.parametrize("delay", [0.1, 0.4, 0.8])
def test_an_interrupt_stops_within_a_second(delay):
    def interrupt():
        sent.append(time.monotonic())
        signal.raise_signal(signal.SIGINT)

    sent = []
    timer = threading.Timer(delay, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        pysherd.fracture(AMPHORA, **LONG)
    timer.join()
    assert time.monotonic() - sent[0] < 1.0 + 0.5  # of a busy machine
    assert len(pysherd.fracture(cube(), pieces=2, resolution=16)) == 2


def test_other_threads_go_on_meanwhile():
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    pysherd.fracture(AMPHORA, resolution=200, pieces=10)
    done.set()
    thread.join()
    assert counted[0] > 50


def test_four_threads_at_once(amphora):
    expected = {seed: pysherd.fracture(amphora, pieces=5, seed=seed) for seed in range(4)}
    results, faults = {}, []

    def work(seed):
        try:
            for _ in range(5):
                results[seed] = pysherd.fracture(amphora, pieces=5, seed=seed)
                results[seed].points(50)
                assert np.array_equal(results[seed].labels, expected[seed].labels)
                assert np.array_equal(results[seed][0].vertices, expected[seed][0].vertices)
        except BaseException as e:
            faults.append(e)

    threads = [threading.Thread(target=work, args=[seed]) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults and len(results) == 4


def test_one_fracture_read_by_four_threads(amphora):
    f = pysherd.fracture(amphora, pieces=5)
    volumes = []
    threads = [threading.Thread(target=lambda: volumes.append([len(g.vertices) for g in f])) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(volumes) == 4 and all(v == volumes[0] for v in volumes)


def test_arrays_are_read_and_written_while_another_thread_renders(amphora):
    f, images = pysherd.fracture(amphora, pieces=5), []
    expected = f.render(size=(300, 200))
    threads = [threading.Thread(target=lambda: images.append(f.render(size=(300, 200)))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for fragment in f:
        fragment.vertices[...] = np.nan
        time.sleep(0.05)
    for thread in threads:
        thread.join()
    assert len(images) == 3 and all(np.array_equal(image, expected) for image in images)


def forked(work):
    """Runs work in a forked process; returns its status, or fails after a minute."""
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            status = work()
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)
    end = time.monotonic() + 60
    while time.monotonic() < end:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    pytest.fail("the forked process hangs")


@pytest.mark.parametrize("rounds", [1, 5])
def test_after_a_fork_work_goes_on(amphora, rounds):
    expected = pysherd.fracture(amphora, pieces=5, seed=1)
    expected[0].vertices, expected.points(10)
    for _ in range(rounds):

        def work():
            again = pysherd.fracture(amphora, pieces=5, seed=1)
            new = pysherd.voxelize(AMPHORA, resolution=32)
            return 0 if np.array_equal(again.labels, expected.labels) and len(pysherd.fracture(new, pieces=3)[0].vertices) else 2

        assert forked(work) == 0
        assert len(pysherd.fracture(amphora, pieces=3)[0].vertices) > 0  # nor does the parent hang


def test_a_fork_of_a_fork(amphora):
    assert forked(lambda: forked(lambda: 0 if len(pysherd.fracture(amphora, pieces=3)) == 3 else 2)) == 0


def test_a_fork_during_a_fracture_refuses():
    started = threading.Event()

    def progress(stage, fraction):
        started.set()

    def work():
        try:
            pysherd.fracture(cube(), pieces=2, resolution=16)
        except pysherd.DeviceError as e:
            return 3 if "was forked while a fracture was under way" in str(e) else 4
        return 5

    def breaks():
        with pytest.raises(pysherd.Cancelled):
            pysherd.fracture(AMPHORA, **LONG, progress=lambda *a: progress(*a) if not stop.is_set() else False)

    stop = threading.Event()
    thread = threading.Thread(target=breaks)
    thread.start()
    assert started.wait(30)
    try:
        assert forked(work) == 3
    finally:
        stop.set()
        thread.join()
    time.sleep(1)
    assert len(pysherd.fracture(cube(), pieces=2, resolution=16)) == 2


def labels_of(arguments):
    solid, seed = arguments
    return pysherd.fracture(solid, pieces=4, seed=seed).labels.sum()


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_multiprocessing(amphora, method):
    expected = [labels_of((amphora, seed)) for seed in range(6)]
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(labels_of, [(amphora, seed) for seed in range(6)]).get(120) == expected


def test_a_forked_process_ends_by_itself(amphora):
    """Its exit handlers run, which wait for threads that it does not have if something is wrong."""
    pysherd.fracture(amphora, pieces=3)[0].vertices
    for target in (int, lambda: pysherd.fracture(amphora, pieces=3)[0].vertices):
        process = multiprocessing.get_context("fork").Process(target=target)
        process.start()
        process.join(60)
        assert process.exitcode == 0


FORKED_OPENCL = """
import os, sys, pysherd
try:
    pysherd.fracture("{mesh}", pieces=2, resolution=16, device="pocl")
except pysherd.DeviceError:
    print("no driver")
    sys.exit()
pid = os.fork()
if pid == 0:
    assert len(pysherd.fracture("{mesh}", pieces=2, resolution=16)) == 2
    try:
        pysherd.fracture("{mesh}", pieces=2, resolution=16, device="pocl")
    except pysherd.DeviceError as e:
        print("refused:", e, flush=True)
    os._exit(0)
os.waitpid(pid, 0)
print("done")
"""


def test_opencl_after_a_fork_refuses_and_the_builtin_device_works():
    result = run(FORKED_OPENCL.format(mesh=AMPHORA), env={**os.environ, "OCL_ICD_VENDORS": "pocl.icd"})
    if "no driver" in result.stdout:
        pytest.skip("no OpenCL driver")
    assert "refused: this process was forked from one that used OpenCL" in result.stdout and "done" in result.stdout, result.stderr


CLOSING = """
import threading, time, pysherd
threading.Thread(target=lambda: pysherd.fracture("{mesh}", resolution=600, growth="chain", roughness=2, pieces=300), daemon=True).start()
time.sleep({delay})
print("closing")
"""


@pytest.mark.parametrize("delay", [0.05, 0.4, 0.8])
def test_an_interpreter_that_closes(delay):
    result = run(CLOSING.format(mesh=AMPHORA, delay=delay))
    assert (result.returncode, result.stdout) == (0, "closing\n"), result.stderr
    assert "terminate" not in result.stderr and "Fatal" not in result.stderr


def test_an_interpreter_that_closes_with_all_alive():
    code = f"import pysherd; s = pysherd.voxelize({str(AMPHORA)!r}, resolution=32); f = pysherd.fracture(s, pieces=3); v = f[0].vertices; 1 / 0"
    result = run(code)
    assert result.returncode == 1 and result.stderr.strip().endswith("ZeroDivisionError: division by zero")


MANY = """
import gc, os, pathlib, sys, pysherd
sys.path.insert(0, {tests!r})
from conftest import cube

solid = pysherd.voxelize(cube(), resolution=12)

def resident():
    gc.collect()
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

for _ in range(2):
    for f in solid.fractures(pieces=3, seeds=range({count})):
        f.labels, f.points(4), f[0].vertices, f.contacts
    print(resident())
"""


def test_many_small_fractures_leave_memory_flat():
    """With one arena of malloc: with one for each thread, free memory within them varies by tens of megabytes."""
    count = int(os.environ.get("SHERD_PYTHON_FRACTURES", "2000"))
    code = MANY.format(tests=str(pathlib.Path(__file__).parent), count=count)
    result = run(code, env={**os.environ, "MALLOC_ARENA_MAX": "1"}, timeout=max(600, count // 5))
    first, second = map(float, result.stdout.split())
    assert second - first < 4


def test_files_are_closed():
    before = len(os.listdir("/proc/self/fd"))
    for seed in range(50):
        pysherd.fracture(cube(), pieces=2, resolution=12, seed=seed)
    gc.collect()
    assert len(os.listdir("/proc/self/fd")) <= before + 2


def test_threads_are_limited(amphora):
    try:
        pysherd.limit_threads(1)
        one = pysherd.fracture(amphora, pieces=5)
    finally:
        pysherd.limit_threads(0)
    assert np.array_equal(one.labels, pysherd.fracture(amphora, pieces=5).labels)
