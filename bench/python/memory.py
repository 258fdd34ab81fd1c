#!/usr/bin/env python3
"""Whether memory grows over many calls of the module.

usage: bench/python/memory.py [--calls N]

PYTHONPATH names the package. For each function: resident memory after a tenth of the calls, when buffers and caches have
their size, and how much more there is after N more (1000). One kept frame of 64 x 64 px a call would be 16 MB in 1,000
calls as numbers of four bytes. What is kept for good shows as growth that doubles with the calls.
"""
import argparse
import gc
import resource
import time

import numpy as np

import grainfield as gf


def resident():
    """[MB]"""
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def refused(call):
    try:
        call()
    except gf.Error:
        return
    raise AssertionError("was to be refused")


def broken():
    yield np.zeros((64, 64), np.uint8)
    raise KeyError("camera")


def interrupted():
    try:
        gf.track(broken(), threads=1)
    except KeyError:
        return
    raise AssertionError("was to come through")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=1000)
    given = parser.parse_args()
    layer = gf.simulate_md(grains=60, length_x=9, length_y=9, periods=3, snapshot_every=1, discard=1)
    film = gf.render(layer, width=96, height=96).frames
    size = dict(diameter=9.5, edge_width=1.0, polarity="dark", meeting_edges="product", threads=1)
    table = gf.batch(film, **size)
    functions = {
        "locate": lambda: gf.locate(film[0], **size),
        "batch": lambda: gf.batch(film, **size),
        "link": lambda: gf.link(table, 5),
        "track": lambda: gf.track(film, **size),
        "track, of a generator": lambda: gf.track((frame for frame in film), **size),
        "Trajectory.from_positions": lambda: gf.Trajectory.from_positions(table),
        "columns, to_pandas, to_xarray": lambda: (layer.columns(), layer.to_pandas(), layer.to_xarray()),
        "analyze": lambda: gf.analyze(layer, "q4,sk,variance", threads=1),
        "bond_order": lambda: gf.bond_order(layer),
        "simulate_md": lambda: gf.simulate_md(grains=20, length_x=6, length_y=6, periods=1, discard=0, threads=1),
        "simulate_field": lambda: gf.simulate_field(nx=16, record=5, relax=1),
        "render": lambda: gf.render(layer, width=64, height=64, threads=1),
        "wrong options": lambda: refused(lambda: gf.locate(film[0], diameter=-1)),
        "an error of a generator": interrupted,
    }
    print(f"| function | ms a call | MB after {given.calls // 10} calls | MB more after {given.calls} more |\n| --- | --- | --- | --- |")
    for name, call in functions.items():
        for _ in range(max(1, given.calls // 10)):
            call()
        before, begin = resident(), time.process_time()
        for _ in range(given.calls):
            call()
        spent = (time.process_time() - begin) / given.calls
        print(f"| {name} | {1e3 * spent:.2f} | {before:.1f} | {resident() - before:+.2f} |", flush=True)


if __name__ == "__main__":
    main()
