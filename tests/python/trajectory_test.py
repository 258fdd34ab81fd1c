"""Trajectories share their memory with numpy and go to other libraries."""
import gc

import numpy as np
import pytest
from conftest import same_columns

import grainfield as gf


def test_arrays_of_a_snapshot_share_the_memory_of_the_trajectory(layer):
    first, again = layer[0]["position"], layer[0]["position"]
    assert np.shares_memory(first, again)
    assert first.shape == (300, 2) and not first.flags.writeable and not first.flags.owndata
    with pytest.raises(ValueError):
        first[0, 0] = 1


def test_arrays_outlive_their_trajectory():
    trajectory = gf.simulate_md(grains=100, length_x=12, length_y=12, periods=1, snapshot_every=1)
    position, velocity = trajectory[0]["position"], trajectory[0]["velocity"]
    expected = position.copy()
    del trajectory
    gc.collect()
    filler = [np.random.default_rng(i).random((100, 2)) for i in range(200)]
    np.testing.assert_array_equal(position, expected)
    assert velocity.shape == (100, 3) and len(filler) == 200


def test_columns_are_the_snapshots_one_after_another(layer):
    columns = layer.columns()
    np.testing.assert_array_equal(columns["x"], np.concatenate([s["position"][:, 0] for s in layer]))
    np.testing.assert_array_equal(columns["vz"], np.concatenate([s["velocity"][:, 2] for s in layer]))
    np.testing.assert_array_equal(np.unique(columns["frame"]), layer.frames)
    with pytest.raises(IndexError):
        layer[len(layer)]
    np.testing.assert_array_equal(layer[-1]["position"], layer[len(layer) - 1]["position"])


def test_a_saved_trajectory_reads_back_every_bit(layer, tmp_path):
    layer.save(tmp_path / "layer.h5")
    again = gf.read(tmp_path / "layer.h5")
    same_columns(again.columns(), layer.columns(), layer.columns())
    assert again.info == {**layer.info, "source": "layer.h5"}
    np.testing.assert_array_equal(again.times, layer.times)


def test_the_table_has_a_row_for_each_particle_and_frame(layer):
    table = layer.to_pandas()
    assert len(table) == 300 * len(layer)
    assert table.attrs["grainfield"]["length_unit"] == "a"


def test_xarray_has_nan_where_a_particle_is_absent(frames):
    pytest.importorskip("xarray")
    trajectory = gf.track(frames, search_range=6, fps=50)
    data = trajectory.to_xarray()
    table = trajectory.to_pandas()
    assert data["x"].shape == (len(frames), table["particle"].nunique())
    assert int(data["x"].notnull().sum()) == len(table)
    row = table.iloc[len(table) // 2]
    assert float(data["y"].sel(frame=row["frame"], particle=row["particle"])) == row["y"]
    np.testing.assert_allclose(data["time"], np.arange(len(frames)) / 50)


def test_mdanalysis_gets_positions_times_and_box(layer):
    pytest.importorskip("MDAnalysis")
    universe = layer.to_mdanalysis()
    assert universe.atoms.n_atoms == 300 and len(universe.trajectory) == len(layer)
    universe.trajectory[3]
    order = np.argsort(layer[3]["particle"])
    np.testing.assert_allclose(universe.atoms.positions[:, :2], layer[3]["position"][order], atol=1e-5)
    np.testing.assert_allclose(universe.atoms.positions[:, 2], layer[3]["z"][order], atol=1e-5)
    np.testing.assert_allclose(universe.trajectory.ts.dimensions[:3], [20, 20, 1.84])


def test_points_may_be_one_frame_many_or_a_table():
    points = np.random.default_rng(1).random((5, 40, 2)) * 10
    stacked = gf.Trajectory.from_positions(points, box=(10, 10), boundary="periodic", fps=2)
    listed = gf.Trajectory.from_positions(list(points), box=(10, 10), boundary="periodic", fps=2)
    table = gf.Trajectory.from_positions(stacked.to_pandas().sample(frac=1, random_state=1))
    assert "particle" in stacked.columns() and "particle" not in listed.columns()
    same_columns(stacked.columns(), listed.columns(), ["x", "y", "frame"])
    assert sorted(table.columns()["x"]) == sorted(stacked.columns()["x"])
    assert table.info["box"]["boundary"] == ("periodic", "periodic")
    np.testing.assert_allclose(stacked.times, np.arange(5) / 2)
    points[2, 7] = np.nan
    with_gap = gf.Trajectory.from_positions(points, box=(10, 10))
    assert [len(s["position"]) for s in with_gap] == [40, 40, 39, 40, 40]
    assert 7 not in with_gap[2]["particle"] and 7 in with_gap[3]["particle"]


def test_what_are_no_positions_is_refused():
    for wrong in (np.zeros((0, 2)), np.zeros(4), np.zeros((3, 3))):
        with pytest.raises((gf.InputError, ValueError)):
            gf.Trajectory.from_positions(wrong)
    with pytest.raises(gf.OptionError, match="needs the box"):
        gf.Trajectory.from_positions(np.ones((3, 2)), boundary="periodic")
    with pytest.raises(gf.OptionError, match="walls or periodic"):
        gf.Trajectory.from_positions(np.ones((3, 2)), boundary="open")


def test_napari_gets_points_and_tracks(frames):
    trajectory = gf.track(frames[:4])
    shown = []

    class Viewer:
        def __getattr__(self, name):
            return lambda data, **attributes: shown.append((name, np.shape(data)))

    layers = gf.to_napari(trajectory, Viewer(), frames=frames[:4])
    count = len(trajectory.to_pandas())
    assert shown == [("add_image", frames[:4].shape), ("add_points", (count, 3)),
                     ("add_tracks", (count, 4))]
    tracks = layers[2][0]
    assert (np.diff(tracks[:, 0]) >= 0).all()  # napari wants them by particle, then by time
    assert [kind for _, _, kind in gf.to_napari(gf.locate(frames[0]))] == ["points"]
    with pytest.raises(gf.InputError):
        gf.to_napari(frames)


def test_napari_accepts_the_layers(frames):
    layer = pytest.importorskip("napari.layers")
    for data, attributes, kind in gf.to_napari(gf.track(frames[:4])):
        layer.Layer.create(data, attributes, kind)
