"""Simulations and frames from Python."""
import pathlib

import numpy as np
import pytest

import grainfield as gf


def test_a_run_is_that_of_the_command_line(tmp_path):
    import tomllib

    from conftest import run_program

    text = """[cell]
grains = 80
length-x = 10.0
length-y = 10.0
[run]
periods = 3
snapshot-every = 1
"""
    (tmp_path / "md.toml").write_text(text)
    run_program("simulate", "md", "-c", tmp_path / "md.toml", "-o", tmp_path / "md.h5", "--seed", 4)
    ours = gf.simulate_md(seed=4, **tomllib.loads(text))
    for a, b in zip(gf.read(tmp_path / "md.h5"), ours, strict=True):
        np.testing.assert_array_equal(a["position"], b["position"])
        np.testing.assert_array_equal(a["velocity"], b["velocity"])


def test_grains_stay_between_the_plates():
    layer = gf.simulate_md(grains=80, length_x=10, length_y=10, periods=3, snapshot_every=1)
    z = layer.columns()["z"]
    assert layer.info["origin"] == "md" and z.min() > 0.4 and z.max() < 1.5


def test_the_density_of_the_field_model_is_conserved():
    field = gf.simulate_field(nx=32, record=100, relax=50, seed=2)
    assert field.density.shape == (len(field.time), 1, 32, 32)
    assert field.order.shape == (len(field.time), 32, 32)
    means = field.density.mean(axis=(2, 3))
    # The initial density has mean zero, and fluxes between cells sum to nothing.
    assert np.abs(means - means[0]).max() < 1e-5
    assert field.density.std() > 0.3


def test_the_field_goes_to_xarray():
    pytest.importorskip("xarray")
    field = gf.simulate_field(nx=16, record=20, relax=50)
    data = field.to_xarray()
    assert data["density"].dims == ("time", "replica", "y", "x")
    assert float(data["x"][0]) == field.spacing / 2


def test_frames_have_the_bits_of_the_camera(layer):
    eight = gf.render(layer, width=120, height=100)
    assert eight.frames.dtype == np.uint8 and eight.frames.shape == (len(layer), 100, 120)
    twelve = gf.render(layer, width=120, height=100, bits=12)
    assert twelve.frames.dtype == np.uint16 and 255 < twelve.frames.max() <= 4095


def test_a_camera_is_a_file_a_dict_or_a_word(layer, tmp_path):
    (tmp_path / "camera.toml").write_text('camera = "ideal"\n[view]\nwidth = 90\nheight = 90\n')
    from_file = gf.render(layer, tmp_path / "camera.toml")
    as_dict = gf.render(layer, {"camera": "ideal", "view": {"width": 90, "height": 90}})
    as_word = gf.render(layer, "ideal", width=90, height=90)
    np.testing.assert_array_equal(from_file.frames, as_dict.frames)
    np.testing.assert_array_equal(from_file.frames, as_word.frames)
    assert gf.render(layer, tmp_path / "camera.toml", width=70).frames.shape[2] == 70
    with pytest.raises(gf.InputError, match="nothing.toml"):
        gf.render(layer, pathlib.Path("nothing.toml"))


def test_lost_frames_are_marked(layer):
    film = gf.render(layer, width=60, height=60, drop_rate=0.5, seed=3)
    assert 0 < film.lost.sum() < len(layer)
    assert not film.frames[film.lost].any()
    assert len(film.truth) == (~film.lost).sum()
