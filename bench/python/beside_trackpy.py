#!/usr/bin/env python3
"""Linking beside trackpy, by the walk-throughs of soft-matter/trackpy-examples: links found and the time of a frame.

usage: bench/python/beside_trackpy.py [--foam FOLDER] [--rounds N]

PYTHONPATH names the package, and trackpy where it is. Without trackpy only ours is measured, and that is said.

prediction       that notebook's sheared lattice as it grows: N particles, 20 frames, steps up to 1.4 spacings, from slow
                 to fast; predicted by the nearest velocity
adaptive-search  that notebook's grid of 441 points which contracts to 0.95, in two frames
foam             the bubbles of "custom-feature-detection": sample_data/foam of those examples. Bubbles are found as
                 there, with scipy in place of scikit-image; no truth: how many links both have
"""
import argparse
import glob
import os
import statistics
import time
import warnings

import numpy as np
import pandas as pd

import grainfield

try:
    import trackpy
    import trackpy.predict

    trackpy.quiet()
except ImportError:
    trackpy = None


def sheared(side, frames=20, seed=4):
    """A lattice with noise of 0.03 spacings; row y moves by 1.4 y/side t/frames a frame: accelerating shear."""
    random = np.random.default_rng(seed)
    x, y = (grid.ravel().astype(float) for grid in np.mgrid[:side, :side])
    tables = []
    for t in range(frames):
        moved = x + 0.7 * (y / side) * t * t / frames
        noise = random.normal(0, 0.03, (2, side * side))
        tables.append(pd.DataFrame({"x": moved + noise[0], "y": y + noise[1], "frame": t, "true": np.arange(side * side)}))
    return pd.concat(tables, ignore_index=True)


def contracting_grid(scale=0.95):
    x, y = (grid.ravel().astype(float) for grid in np.mgrid[-10:11, -10:11])
    first = pd.DataFrame({"x": x, "y": y, "frame": 0, "true": np.arange(x.size)})
    return pd.concat([first, first.assign(x=scale * x, y=scale * y, frame=1)], ignore_index=True)


def bubbles(folder):
    """As the notebook finds them: threshold of the neighbourhood, labels, areas; scipy's uniform filter is the mean."""
    from PIL import Image
    from scipy import ndimage

    tables = []
    for number, path in enumerate(sorted(glob.glob(os.path.join(folder, "*.tif")))):
        picture = np.asarray(Image.open(path), float)
        picture = (picture if picture.ndim == 2 else picture[..., 0])[100:-300, 45:-35]
        edges = ndimage.binary_dilation(picture < ndimage.gaussian_filter(picture, 50), iterations=2)
        labels, count = ndimage.label(~edges)
        areas = ndimage.sum_labels(np.ones_like(picture), labels, np.arange(1, count + 1))
        centres = np.array(ndimage.center_of_mass(~edges, labels, np.arange(1, count + 1)))
        kept = (areas >= 5) & (areas <= 800) & ~((centres[:, 0] < 260) & (areas < 80))
        tables.append(pd.DataFrame({"x": centres[kept, 1], "y": centres[kept, 0], "frame": number}))
    return pd.concat(tables, ignore_index=True)


def links(tracks):
    """Pairs of rows of the table that are one step, of consecutive frames."""
    steps = tracks.reset_index().sort_values(["particle", "frame"], kind="stable")
    row, particle, frame = (steps[name].to_numpy() for name in ("index", "particle", "frame"))
    is_step = (np.diff(particle) == 0) & (np.diff(frame) == 1)
    return set(zip(row[:-1][is_step], row[1:][is_step]))


def true_links(table):
    return links(table.assign(particle=table["true"]))


def measured(call, rounds):
    """What it gives and the median time of the processor [s]; None if it raises."""
    times, found = [], None
    for _ in range(rounds):
        begin = time.process_time()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = call()
        except Exception as failure:  # which one belongs to trackpy
            return type(failure).__name__, time.process_time() - begin
        times.append(time.process_time() - begin)
    return found, statistics.median(times)


def row(name, found, seconds, frames, truth):
    if isinstance(found, str):
        print(f"| {name} | {found} | | {1e3 * seconds / frames:.2f} ms |")
        return
    have = links(found)
    print(f"| {name} | {len(have & truth)} of {len(truth)} | {len(have - truth)} | {1e3 * seconds / frames:.2f} ms |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--foam")
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    packages = [("gf", grainfield)] + ([("tp", trackpy)] if trackpy else [])
    print(f"grainfield {grainfield.__version__}" + ("" if trackpy else "; trackpy is not installed: only ours is measured"))

    for side in (4, 20, 60):
        table = sheared(side)
        print(f"\n| sheared lattice, {side * side} particles | right links | wrong | a frame |\n| --- | --- | --- | --- |")
        for name, package in packages:
            found = measured(lambda: package.link_df(table, 0.5), given.rounds)
            row(f"`{name}.link_df(f, 0.5)`", *found, 20, true_links(table))
            found = measured(lambda: package.predict.NearestVelocityPredict().link_df(table, 0.5), given.rounds)
            row(f"`{name}.predict.NearestVelocityPredict().link_df(f, 0.5)`", *found, 20, true_links(table))

    table = contracting_grid()
    print("\n| contracting grid | right links | wrong | a frame |\n| --- | --- | --- | --- |")
    for name, package in packages:
        for words in ({"search_range": 0.65}, {"search_range": 0.8}, {"search_range": 0.95, "adaptive_stop": 0.56,
                                                                      "adaptive_step": 0.99}):
            found = measured(lambda: package.link_df(table, **words), 1)
            text = ", ".join(f"{k}={v}" for k, v in words.items())
            row(f"`{name}.link_df(f, {text})`", *found, 2, true_links(table))

    if given.foam:
        table = bubbles(given.foam)
        frames = table["frame"].nunique()
        print(f"\n| foam, {len(table) / frames:.0f} bubbles a frame, {frames} frames | links | only here | a frame |\n"
              "| --- | --- | --- | --- |")
        found = {name: measured(lambda: package.link_df(table, 11, memory=5), given.rounds) for name, package in packages}
        for name, (tracks, seconds) in found.items():
            have = links(tracks)
            others = [links(other) for key, (other, _) in found.items() if key != name]
            only = len(have - others[0]) if others else ""
            print(f"| `{name}.link_df(f, 11, memory=5)` | {len(have)} | {only} | {1e3 * seconds / frames:.2f} ms |")


if __name__ == "__main__":
    main()
