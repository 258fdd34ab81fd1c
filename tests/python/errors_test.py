"""Bad input and bad options are exceptions of the names of the C++ library."""
import numpy as np
import pytest

import grainfield as gf


def test_exceptions_are_of_python_s_kinds_too():
    assert issubclass(gf.OptionError, (gf.Error, ValueError))
    assert issubclass(gf.OptionError, ValueError) and issubclass(gf.InputError, ValueError)
    for kind in (gf.OptionError, gf.InputError, gf.OutputError, gf.PhysicsError):
        assert issubclass(kind, gf.Error)
    assert issubclass(gf.Error, RuntimeError)


@pytest.mark.parametrize("image, said", [
    (np.zeros(5), "not one grey image"),
    (np.zeros((4, 5, 3)), "take one channel"),
    (np.zeros((0, 5)), "not empty"),
    (np.full((30, 30), np.nan), "not finite"),
    (np.linspace(0, 1, 900).reshape(30, 30), "span 2 or more"),
    (np.array([["a"]]), "does not hold numbers"),
    (np.zeros((30, 30), complex), "does not hold numbers"),
])
def test_what_is_no_image_is_refused(image, said):
    with pytest.raises(gf.InputError, match=said):
        gf.locate(image)


@pytest.mark.parametrize("film, said", [
    ([], "no frame"), ([None, None], "no frame"), (iter([]), "no frame"),
    (np.zeros((30, 30)), "frame 0 is not one grey image"), (5, "no frames to be had"),
])
def test_what_is_no_film_is_refused(film, said):
    with pytest.raises(gf.InputError, match=said):
        gf.track(film)


def test_a_frame_of_another_size_is_named(frames):
    with pytest.raises(gf.InputError, match="frame 2 has another size: 200 x 280"):
        gf.track([frames[0], frames[1], frames[2][:, :200]])


def test_an_exception_of_the_film_comes_through(frames):
    def film():
        yield from frames[:14]
        raise LookupError("the camera is gone")

    with pytest.raises(LookupError, match="the camera is gone"):
        gf.track(film())


def test_options_of_files_are_refused_for_arrays(frames):
    with pytest.raises(gf.OptionError, match="'region' is for films by name"):
        gf.track(frames, region=[0, 0, 50, 50])
    with pytest.raises(gf.OptionError, match="a picture by name"):
        gf.track("film.avi", mask=np.ones((3, 3)))


def test_an_unknown_option_is_refused_with_the_nearest(frames):
    with pytest.raises(gf.OptionError, match="did you mean 'search_range'"):
        gf.track(frames, serch_range=3)
    with pytest.raises(gf.OptionError, match="did you mean 'restitution'"):
        gf.simulate_md(grain={"restitutoin": 0.9})


@pytest.mark.parametrize("options", [
    {"search_range": -1}, {"search_range": "wide"}, {"memory": 1.5}, {"polarity": "grey"},
    {"memory": True}, {"search_range": float("nan")}, {"memory": [1, 2]}, {"edge_width": object()},
])
def test_values_are_checked_by_the_option_tables(frames, options):
    with pytest.raises(gf.OptionError):
        gf.track(frames[:1], **options)


def test_values_come_in_numpy_s_types_too(frames):
    for memory in (2, np.int64(2), np.uint8(2)):
        gf.track(frames[:1], memory=memory, search_range=np.float32(5), polarity="dark")


def test_a_name_of_two_sections_asks_for_the_section():
    with pytest.raises(gf.OptionError, match="grain_restitution, plate_restitution"):
        gf.simulate_md(restitution=0.9)


def test_sections_and_flat_keywords_are_the_same(layer):
    a = gf.simulate_md(grains=30, length_x=8, length_y=8, periods=2, snapshot_every=1,
                       grain_restitution=0.9)
    b = gf.simulate_md(cell={"grains": 30, "length-x": 8, "length_y": 8},
                       run={"periods": 2, "snapshot-every": 1}, grain={"restitution": 0.9})
    np.testing.assert_array_equal(a[-1]["position"], b[-1]["position"])
    c = gf.simulate_md(grains=30, length_x=8, length_y=8, periods=2, snapshot_every=1)
    assert not np.array_equal(a[-1]["position"], c[-1]["position"])


def test_the_options_that_are_listed_are_accepted():
    listed = {row["keyword"]: row for row in gf.options("simulate_md")}
    assert {"grains", "grain_restitution", "plate_restitution", "snapshot_every"} <= set(listed)
    assert listed["height"]["unit"] == "a" and listed["height"]["default"] == 1.84
    assert "grains" in gf.simulate_md.__doc__ and "search_range" in gf.track.__doc__
    with pytest.raises(gf.OptionError, match="simulate_md"):
        gf.options("simulate")


def test_every_function_documents_its_options():
    for name in ("locate", "batch", "track", "link", "analyze", "q4", "msd", "structure_factor",
                 "number_variance", "pair_distribution", "fit_hyperuniform", "simulate_md",
                 "simulate_field", "render"):
        text = getattr(gf, name).__doc__
        assert "Other Parameters" in text and gf.options(name)[0]["keyword"] in text, name


def test_files_are_refused_as_the_program_refuses_them(tmp_path, layer):
    with pytest.raises(gf.InputError, match="nothing.h5"):
        gf.read(tmp_path / "nothing.h5")
    (tmp_path / "a.h5").write_text("no HDF5")
    with pytest.raises(gf.InputError):
        gf.read(tmp_path / "a.h5")
    with pytest.raises(gf.InputError):
        gf.track(tmp_path / "nothing.avi")
    with pytest.raises(gf.OutputError, match="a.h5"):
        layer.save(tmp_path / "a.h5")
    layer.save(tmp_path / "a.h5", overwrite=True)


def test_a_run_that_blows_up_is_a_physics_error():
    with pytest.raises(gf.PhysicsError):
        gf.simulate_field(nx=32, scheme="paper", dt=100, nu=1e-4, relax=1e5, record=1e5)


def test_warnings_point_at_the_caller(frames):
    with pytest.warns(gf.GrainfieldWarning) as caught:
        gf.batch(np.zeros((2, 40, 40), np.uint8))
    assert caught[0].filename == __file__
