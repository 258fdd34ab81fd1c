#!/usr/bin/env python3
"""What tracking from Python costs over the command line, on a film of 100 frames.

usage: bench/python/overhead.py PROGRAM [--frames N] [--rounds N] [--size PX] [--grains N] [--threads N]

The package is that of the program's build folder, or the one that PYTHONPATH names. The film is a simulated layer under a
noisy camera. The command line and Python track it in turns: the same files to the same output, the same files in memory, the
array. Each must find the same, bit by bit. Times are of whole processes: by the clock, and of the processor (user and
system), which holds on a machine that does other work too. Ratios are medians over the rounds. What importing and saving
take is measured alone, too: a difference above both is the machine's.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

if len(sys.argv) > 1 and "PYTHONPATH" not in os.environ:
    os.environ["PYTHONPATH"] = str(pathlib.Path(sys.argv[1]).resolve().parent / "python")
    sys.path.insert(0, os.environ["PYTHONPATH"])

import grainfield as gf  # noqa: E402


def write_pictures(frames, folder):
    paths = []
    for i, frame in enumerate(frames):
        path = folder / f"frame_{i:04d}.pgm"
        path.write_bytes(b"P5 %d %d 255\n" % frame.shape[::-1] + frame.tobytes())
        paths.append(str(path))
    return paths


def seconds(words):
    """Of a process: by the clock, and of the processor."""
    begin = time.perf_counter()
    child = subprocess.Popen([str(word) for word in words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        raise RuntimeError(f"{words[0]} ended with {child.returncode}")
    return wall, usage.ru_utime + usage.ru_stime


def saving(file, copy, rounds):
    """Of the processor [s], to write what was tracked."""
    tracks, times = gf.read(file), []
    for _ in range(rounds):
        begin = time.process_time()
        tracks.save(copy, overwrite=True)
        times.append(time.process_time() - begin)
    return statistics.median(times)


def median(pairs, which):
    return statistics.median(pair[which] for pair in pairs)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, default=800)
    parser.add_argument("--grains", type=int, default=1800)
    parser.add_argument("--threads", type=int, default=1)
    given = parser.parse_args()

    side = (given.grains / 0.75) ** 0.5
    layer = gf.simulate_md(grains=given.grains, length_x=side, length_y=side, sides_x="walls", sides_y="walls", discard=10,
                           periods=10 + 0.05 * (given.frames - 1), snapshot_every=0.05)
    frames = gf.render(layer, width=given.size, height=given.size).frames
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pictures = write_pictures(frames, folder)
        np.save(folder / "frames.npy", frames)
        options = f"sphere_diameter=20, memory=2, threads={given.threads}"
        script = f"""
import sys, numpy as np, grainfield as gf
folder = {str(folder)!r}
"""
        run = {
            "command line": [given.program, "track", *pictures, "-o", folder / "a.h5", "--force", "--sphere-diameter",
                             "20", "--memory", "2", "--quiet", "--threads", str(given.threads)],
            "track(files, output=…)": [sys.executable, "-c", script + f"""
gf.track(sys.argv[1:], output=folder + "/b.h5", overwrite=True, {options})""", *pictures],
            "track(files).save": [sys.executable, "-c", script + f"""
gf.track(sys.argv[1:], {options}).save(folder + "/c.h5", overwrite=True)""", *pictures],
            "track(array).save": [sys.executable, "-c", script + f"""
gf.track(np.load(folder + "/frames.npy"), {options}).save(folder + "/d.h5", overwrite=True)"""],
        }
        times = {what: [] for what in run}
        for _ in range(given.rounds):
            for what, words in run.items():
                times[what].append(seconds(words))
        start = [seconds([sys.executable, "-c", "import grainfield"]) for _ in range(given.rounds)]
        save = saving(folder / "a.h5", folder / "e.h5", given.rounds)
        expected = gf.read(folder / "a.h5").columns()
        for other in "bcd":
            found = gf.read(folder / f"{other}.h5").columns()
            for column in ("x", "y", "particle"):
                np.testing.assert_array_equal(found[column], expected[column])
    print(f"{len(frames)} frames of {given.size} x {given.size} px, {len(expected['x']) / len(frames):.0f} spheres a frame; "
          f"{given.rounds} rounds, threads: {given.threads}; importing the module alone {median(start, 1):.2f} s of the "
          f"processor, save() alone {save:.3f} s; load {os.getloadavg()[0]:.1f}")
    for what, measured in times.items():
        in_python = what != "command line"
        without = 100 * (statistics.median((m[1] - in_python * median(start, 1)) / b[1]
                                           for m, b in zip(measured, times["command line"], strict=True)) - 1)
        more = [100 * (statistics.median(m[k] / b[k] for m, b in zip(measured, times["command line"], strict=True)) - 1)
                for k in (0, 1)]
        print(f"{what:24s} {median(measured, 0):7.2f} s by the clock {more[0]:+6.1f} %, "
              f"{median(measured, 1):7.2f} s of the processor {more[1]:+6.1f} %, without the import {without:+.1f} %")


if __name__ == "__main__":
    main()
