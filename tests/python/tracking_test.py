"""Locating and tracking from Python is that of the program, whatever holds the frames."""
import numpy as np
import pytest
from conftest import run_program, same_columns, write_pictures

import grainfield as gf

NUMBERS = ["x", "y", "x_std", "y_std", "quality"]


def test_locate_gives_the_bits_of_the_command_line(frames, tmp_path):
    (picture,) = write_pictures(frames[:1], tmp_path)
    run_program("track", picture, "-o", tmp_path / "one.h5")
    same_columns(gf.locate(frames[0]), gf.read(tmp_path / "one.h5").columns(), NUMBERS)


def test_track_of_arrays_gives_the_bits_of_the_command_line(frames, tracked_by_program):
    expected = gf.read(tracked_by_program[1]).columns()
    found = gf.track(frames, search_range=6, memory=2)
    same_columns(found.columns(), expected, [*NUMBERS, "frame", "particle"])


def test_track_of_files_gives_the_bits_of_the_command_line(tracked_by_program, tmp_path):
    pictures, file = tracked_by_program
    expected = gf.read(file).columns()
    in_memory = gf.track(pictures, search_range=6, memory=2)
    written = gf.track(pictures, search_range=6, memory=2, output=tmp_path / "tracks.h5")
    for found in (in_memory, written, gf.read(tmp_path / "tracks.h5")):
        same_columns(found.columns(), expected, [*NUMBERS, "frame", "particle"])


def test_results_do_not_depend_on_threads(frames):
    same_columns(gf.track(frames[:6], threads=1).columns(), gf.track(frames[:6], threads=2).columns(),
                 [*NUMBERS, "particle"])


def test_spheres_are_where_they_are(film):
    features = gf.locate(film.frames[0])
    truth = film.truth[0]["position"]
    found = features[["x", "y"]].to_numpy()
    distance = np.linalg.norm(truth[:, None] - found[None], axis=2)
    inside = (truth > 8).all(axis=1) & (truth < 271).all(axis=1)
    assert (distance.min(axis=1)[inside] < 3.5).mean() > 0.98  # a quarter of a sphere
    assert np.median(distance.min(axis=1)[inside]) < 0.2


@pytest.mark.parametrize("held", ["list", "generator", "iterator", "sequence", "fortran", "uint16",
                                  "big endian", "int32", "float32", "float64"])
def test_frames_come_from_anywhere(frames, held):
    few = frames[:6]

    class Sequence:
        def __len__(self):
            return len(few)

        def __getitem__(self, index):
            return few[index]

    forms = {"list": lambda: list(few), "generator": lambda: (frame for frame in few),
             "iterator": lambda: iter(few), "sequence": Sequence,
             "fortran": lambda: [np.asfortranarray(frame) for frame in few],
             "big endian": lambda: few.astype(">u2")}
    film = forms[held]() if held in forms else few.astype(held)
    same_columns(gf.track(film).columns(), gf.track(few).columns(), [*NUMBERS, "particle"])


def test_a_generator_may_hand_out_the_same_array_again(frames):
    def camera():
        buffer = np.empty_like(frames[0])
        for frame in frames:
            buffer[:] = frame
            yield buffer

    same_columns(gf.track(camera()).columns(), gf.track(frames).columns(), [*NUMBERS, "particle"])


@pytest.mark.filterwarnings("ignore")
def test_a_stream_may_begin_with_nine_blank_frames(frames):
    film = [np.zeros_like(frames[0])] * 9 + [frames[0]]
    same_columns(gf.track(iter(film)).columns(), gf.track(film).columns(), [*NUMBERS, "frame"])
    assert len(gf.track(iter([np.zeros_like(frames[0])] * 30))) == 30


def test_a_missing_frame_leaves_a_gap(frames):
    film = [frames[0], frames[1], None, frames[3]]
    trajectory = gf.track(iter(film))
    assert list(trajectory.frames) == [0, 1, 3]
    assert trajectory.summary["frames_missing"] == 1


def test_a_frame_that_knows_its_number_keeps_it(frames):
    class Numbered(np.ndarray):
        frame_no = None

    def numbered(i):
        frame = frames[i].view(Numbered)
        frame.frame_no = i
        return frame

    assert set(gf.batch([numbered(3), numbered(4)])["frame"]) == {3, 4}
    assert set(gf.locate(numbered(7))["frame"]) == {7}


def test_batch_has_the_columns_of_trackpy(frames):
    features = gf.batch(frames[:3])
    assert {"x", "y", "frame", "x_std", "y_std", "layer", "quality"} <= set(features.columns)
    assert list(features["frame"].unique()) == [0, 1, 2]
    assert features.attrs["grainfield"]["box"]["length"] == (280.0, 280.0)


def test_what_is_masked_is_not_found(frames):
    mask = np.ones(frames[0].shape, np.uint8)
    mask[:, 140:] = 0
    whole, half = gf.locate(frames[0]), gf.locate(frames[0], mask=mask)
    assert 0.3 * len(whole) < len(half) < 0.7 * len(whole)
    assert half["x"].max() < 147


def test_invert_of_trackpy_is_the_polarity(frames):
    same_columns(gf.locate(255 - frames[0], invert=False), gf.locate(255 - frames[0]), NUMBERS)
    with pytest.warns(gf.GrainfieldWarning, match="minmass"):
        same_columns(gf.locate(frames[0], invert=True, minmass=20), gf.locate(frames[0]), NUMBERS)


def test_a_given_diameter_is_kept(frames):
    assert gf.track(frames[:1], 12.5).summary["disc_diameter"] == 12.5
