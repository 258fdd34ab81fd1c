"""Linking of tables follows trackpy's conventions and gives the program's numbers."""
import numpy as np
import pandas as pd
import pytest

import grainfield as gf


def test_linked_numbers_are_those_of_the_command_line(frames, tracked_by_program):
    expected = gf.read(tracked_by_program[1]).to_pandas()
    linked = gf.link(gf.batch(frames), 6, memory=2)
    pd.testing.assert_series_equal(linked["particle"], expected["particle"])
    assert expected["particle"].nunique() > 100


def walkers(frames=8):
    """Three particles that move by (1, 0.5) a frame, far apart; row order is shuffled."""
    rows = [{"frame": t, "y": 10.0 + 0.5 * t, "x": x + t, "mass": x}
            for t in range(frames) for x in (0.0, 30.0, 60.0)]
    return pd.DataFrame(rows).sample(frac=1, random_state=4)


def test_a_particle_keeps_one_number():
    linked = gf.link(walkers(), 3)
    assert linked.groupby("mass")["particle"].nunique().eq(1).all()
    assert linked["particle"].nunique() == 3


def test_the_table_is_copied_and_comes_in_order_of_frames_with_its_other_columns():
    table = walkers()
    before = table.copy()
    linked = gf.link(table, 3)
    pd.testing.assert_frame_equal(table, before)
    assert linked["frame"].is_monotonic_increasing
    assert linked.index.is_unique and set(linked.index) == set(table.index)
    assert list(linked.columns) == [*table.columns, "particle"]


@pytest.mark.parametrize("memory, numbers", [(0, 2), (1, 1)])
def test_memory_bridges_missing_frames(memory, numbers):
    table = pd.DataFrame({"x": 1.0, "y": 2.0, "frame": [0, 1, 3, 4]})
    assert gf.link(table, 2, memory=memory)["particle"].nunique() == numbers


def test_a_step_longer_than_the_search_range_is_no_link():
    table = pd.DataFrame({"x": [0.0, 1.9, 4.1], "y": 0.0, "frame": [0, 1, 2]})
    assert list(gf.link(table, 2.0)["particle"]) == [0, 0, 1]


def test_other_columns_may_hold_place_and_time():
    table = walkers().rename(columns={"x": "u", "y": "v", "frame": "t"})
    assert gf.link(table, 3, pos_columns=["u", "v"], t_column="t")["particle"].nunique() == 3


def test_the_sum_of_squares_is_least_where_particles_compete():
    # Each nearest neighbour taken first would join 0 → 1 and leave 1 → 2.1 alone.
    table = pd.DataFrame({"x": [0.0, 1.0, 0.9, 2.1], "y": 0.0, "frame": [0, 0, 1, 1]})
    assert list(gf.link(table, 1.5)["particle"]) == [0, 1, 0, 1]


def test_short_tracks_are_left_out():
    table = pd.concat([walkers(), pd.DataFrame({"x": [200.0], "y": 0.0, "frame": 4})])
    assert len(gf.link(table, 3)) == 25
    pd.testing.assert_frame_equal(gf.link(table, 3, minimum_length=2),
                                  gf.filter_stubs(gf.link(table, 3), 2))
    assert len(gf.link(table, 3, minimum_length=2)) == 24


def test_without_a_search_range_the_diameter_is_needed(frames):
    with pytest.raises(gf.OptionError, match="search-range"):
        gf.link(walkers())
    linked = gf.link(gf.batch(frames[:8]))  # brings its diameter
    assert linked.groupby("particle").size().median() >= 6


def test_a_table_without_the_columns_is_refused():
    with pytest.raises(gf.InputError, match="no column 'frame'"):
        gf.link(pd.DataFrame({"x": [1.0], "y": [2.0]}), 3)
    with pytest.raises(gf.InputError, match="finite positions"):
        gf.link(pd.DataFrame({"x": [np.nan], "y": [2.0], "frame": [0]}), 3)


def test_times_that_are_no_whole_numbers_order_the_frames_and_are_kept():
    table = walkers()
    fine = table.assign(frame=0.25 * table["frame"])
    linked, expected = gf.link(fine, 3), gf.link(table, 3)
    np.testing.assert_array_equal(linked["particle"], expected["particle"])
    np.testing.assert_array_equal(linked["frame"], 0.25 * expected["frame"])
    with pytest.raises(gf.InputError, match="whole numbers of frames"):
        gf.Trajectory.from_positions(fine)
    with pytest.raises(gf.InputError, match="does not number frames: it holds nan"):
        gf.link(table.assign(frame=np.nan), 3)


def test_drift_is_found_and_taken_off():
    linked = gf.link(walkers(), 3)
    drift = gf.compute_drift(linked)
    np.testing.assert_allclose(drift["x"], np.arange(1, 8))
    np.testing.assert_allclose(drift["y"], 0.5 * np.arange(1, 8))
    still = gf.subtract_drift(linked)
    assert still.groupby("mass")[["x", "y"]].std().to_numpy().max() < 1e-12


def test_squared_displacements_of_uniform_motion_grow_with_the_square_of_the_lag():
    linked = gf.link(walkers(), 3).query("not (frame == 2 and mass == 30)")  # with a gap
    lag = np.arange(1, 8) / 10.0
    expected = 4.0 * 1.25 * (10 * lag) ** 2  # 2 µm a pixel, 10 frames a second
    each = gf.imsd(linked, mpp=2, fps=10)
    assert each.shape == (7, 3)
    np.testing.assert_allclose(each, np.tile(expected[:, None], 3))
    np.testing.assert_allclose(each.index, lag)
    np.testing.assert_allclose(gf.emsd(linked, mpp=2, fps=10), expected)


def test_the_ensemble_msd_is_that_of_the_analysis(frames):
    tracks = gf.track(frames, search_range=6, fps=50).to_pandas()
    diameter = tracks.attrs["grainfield"]["diameter"]
    of_all = gf.msd(tracks).table().query("phase == 'all'")
    ours = gf.emsd(tracks, mpp=1, fps=50)
    lags = np.round(50 * of_all["t"]).astype(int)
    np.testing.assert_allclose(ours.iloc[lags - 1], of_all["msd"] * diameter**2, rtol=1e-9)
