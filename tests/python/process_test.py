"""Ctrl-C, threads, forks and memory."""
import concurrent.futures
import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import grainfield as gf

# Each begins a work of a minute or more. The last ones have units of work that take seconds.
LONG = {
    "track": "gf.track(frame for frame in itertools.cycle(frames))",
    "link": "gf.link(many, 3)",
    "simulate_md": "gf.simulate_md(grains=9875, length_x=100, length_y=100, periods=1e5)",
    "simulate_field": "gf.simulate_field(nx=256, record=1e7)",
    "render": "gf.render(layer, optics='raytrace', width=1600, height=1600)",
    "locate": "[gf.locate(large) for _ in range(100)]",
}
SCRIPT = """
import itertools, os, sys, time
import numpy as np
import pandas as pd
import grainfield as gf

layer = gf.simulate_md(grains=300, length_x=20, length_y=20, periods=4, snapshot_every=1)
frames = gf.render(layer, width=280, height=280).frames
points = np.random.default_rng(1).random((2000, 2000, 2)) * 500
many = pd.DataFrame({"x": points[..., 0].ravel(), "y": points[..., 1].ravel(),
                     "frame": np.repeat(np.arange(2000), 2000)}) if "WORK" == "link" else None
large = np.tile(frames[0], (4, 4))
print("begins", flush=True)
try:
    CALL
except KeyboardInterrupt:
    print("stopped", time.monotonic(), flush=True)
    assert len(gf.locate(frames[0])) > 100
    print("works on", flush=True)
"""


@pytest.mark.parametrize("work", LONG)
def test_ctrl_c_stops_within_two_seconds_and_the_module_works_on(work):
    script = SCRIPT.replace("CALL", LONG[work]).replace("WORK", work)
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "begins\n"
        time.sleep(1.5)
        asked = time.monotonic()
        child.send_signal(signal.SIGINT)
        word, when = child.stdout.readline().split()
        assert word == "stopped" and float(when) - asked < 2
        assert child.stdout.readline() == "works on\n"
        assert child.wait(60) == 0, child.stderr.read()
    finally:
        child.kill()
        child.communicate()


def test_a_camera_that_hangs_does_not_keep_the_interpreter():
    script = """
import time, numpy as np, grainfield as gf
def camera():
    for _ in range(30):
        yield np.zeros((50, 50), np.uint8)
    print("begins", flush=True)
    time.sleep(1000)
try:
    gf.track(camera())
except KeyboardInterrupt:
    print("stopped", flush=True)
"""
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True)
    try:
        assert child.stdout.readline() == "begins\n"
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "stopped\n"
        time.sleep(1)
        assert child.poll() is None  # waits for the camera, until it is told again
        child.send_signal(signal.SIGINT)
        child.wait(10)
    finally:
        child.kill()
        child.communicate()


def test_a_handler_that_does_not_raise_lets_the_work_go_on(frames):
    caught = []
    before = signal.signal(signal.SIGINT, lambda *_: caught.append(1))
    try:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        found = gf.track(list(frames) * 2)
    finally:
        signal.signal(signal.SIGINT, before)
    assert caught and len(found) == 2 * len(frames)


def test_the_interpreter_lock_is_released(frames):
    count, done = 0, False

    def other():
        nonlocal count
        while not done:
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=other)
    thread.start()
    begin = time.monotonic()
    gf.track(frames, threads=1)
    elapsed = time.monotonic() - begin
    done = True
    thread.join()
    # A thread that never gets the lock counts none; one that sleeps counts some hundreds a second.
    assert count > 20 * elapsed


def test_calls_from_many_threads_give_the_same(frames):
    def places(frame):
        return gf.locate(frame, threads=1)[["x", "y"]].to_numpy()

    expected = [places(frame) for frame in frames[:6]]
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        for found, here in zip(pool.map(places, frames[:6]), expected, strict=True):
            np.testing.assert_array_equal(found, here)


def count_spheres(frame):
    return len(gf.locate(frame))


def test_a_forked_child_works(frames):
    expected = [count_spheres(frame) for frame in frames[:4]]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(count_spheres, frames[:4]).get(60) == expected


def memory():
    """Resident memory [bytes]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def test_memory_does_not_grow_over_a_thousand_calls(frames):
    small = np.ascontiguousarray(frames[0][:64, :64])
    points = gf.batch(frames[:3])
    layer = gf.Trajectory.from_positions(points)

    def use():
        gf.locate(small, 13.8, edge_width=1.4, polarity="dark", meeting_edges="product", threads=1)
        gf.link(points, 5)
        layer.columns()
        layer[0]["position"]
        gf.bond_order(layer)
        with pytest.raises(gf.OptionError):
            gf.locate(small, diameter=-1)

    def used_after(calls):
        for _ in range(calls):
            use()
        return memory()

    before = used_after(100)
    # One kept image of 64 x 64 px a call would be 16 MB, one kept table 40 MB.
    assert used_after(1000) - before < 4e6
