"""Films of known truth that the tests of the package share."""
import os
import pathlib
import subprocess

import numpy as np
import pytest

import grainfield as gf


@pytest.fixture(scope="session")
def layer():
    """A vibrated layer whose grains move little between snapshots."""
    return gf.simulate_md(grains=300, length_x=20, length_y=20, periods=12, discard=10,
                          snapshot_every=0.1, sides_x="walls", sides_y="walls", seed=3)


@pytest.fixture(scope="session")
def film(layer):
    return gf.render(layer, width=280, height=280, dust=0, seed=5)


@pytest.fixture(scope="session")
def frames(film):
    return film.frames


def write_pictures(frames, folder):
    """Frames as PGM files, which any program reads."""
    paths = []
    for i, frame in enumerate(frames):
        path = pathlib.Path(folder) / f"frame_{i:04d}.pgm"
        height, width = frame.shape
        path.write_bytes(b"P5 %d %d 255\n" % (width, height) + frame.tobytes())
        paths.append(str(path))
    return paths


def run_program(*words):
    """The program of the same build."""
    return subprocess.run([os.environ["GRAINFIELD_PROGRAM"], *map(str, words)], check=True,
                          capture_output=True, text=True)


@pytest.fixture(scope="session")
def tracked_by_program(frames, tmp_path_factory):
    """Pictures, and the trajectory file that the command line makes of them."""
    folder = tmp_path_factory.mktemp("program")
    pictures = write_pictures(frames, folder)
    output = folder / "tracks.h5"
    run_program("track", *pictures, "-o", output, "--search-range", 6, "--memory", 2)
    return pictures, output


def same_columns(a, b, names):
    """Every bit, NaN included."""
    for name in names:
        np.testing.assert_array_equal(np.asarray(a[name]), np.asarray(b[name]), err_msg=name)
