"""Observables from Python: known patterns, and the numbers of the program."""
import numpy as np
import pytest
from conftest import run_program

import grainfield as gf


def square(n=20, spacing=1.0):
    side = spacing * np.arange(n) + 0.5 * spacing
    return np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)


def test_a_square_lattice_has_order_one():
    order = gf.q4(square(), box=(20, 20), boundary="periodic")
    assert float(order["q4_mean"]) == pytest.approx(1, abs=1e-12)
    assert order["lattice_spacing"].unit == "a"
    q, neighbours = gf.bond_order(square(), box=(20, 20), boundary="periodic")
    np.testing.assert_allclose(np.abs(q), 1)
    assert (neighbours == 4).all()
    q6, _ = gf.bond_order(square(), box=(20, 20), boundary="periodic", symmetry=6)
    np.testing.assert_allclose(np.abs(q6), 0, atol=1e-12)


def test_bond_order_has_one_value_for_each_position_though_some_are_not_finite():
    whole = square()
    lost = [0, 7, 399]
    holed = whole.copy()
    holed[lost, [0, 1, 0]] = np.nan
    seen = np.setdiff1d(np.arange(len(whole)), lost)
    where = dict(box=(20, 20), boundary="periodic")
    expected, expected_neighbours = gf.bond_order(whole[seen], **where)
    for data in (holed, [holed], np.stack([holed, whole])):
        q, neighbours = gf.bond_order(data, **where)
        assert q.shape == neighbours.shape == (len(whole),)
        assert np.isnan(q[lost]).all()
        assert (neighbours[lost] == 0).all()
        np.testing.assert_array_equal(q[seen], expected)
        np.testing.assert_array_equal(neighbours[seen], expected_neighbours)
    # Without a box it is that of the positions that are finite.
    lost_far = whole.copy()
    lost_far[0] = [np.inf, -np.inf]
    assert np.isnan(gf.bond_order(lost_far)[0][0])
    np.testing.assert_array_equal(gf.bond_order(lost_far)[0][1:], gf.bond_order(whole[1:])[0])
    # A frame without a finite position is a frame all the same.
    frames = [np.full((3, 2), np.nan), holed]
    assert np.isnan(gf.bond_order(frames, frame=0, **where)[0]).all()
    np.testing.assert_array_equal(gf.bond_order(frames, frame=1, **where)[0][seen], expected)


def test_lengths_are_in_units_of_the_diameter():
    a = gf.q4(square(spacing=12.0), box=(240, 240), boundary="periodic", diameter=12.0)
    assert float(a["lattice_spacing"]) == pytest.approx(1, abs=1e-9)


def test_points_without_correlation_scatter_with_one():
    # 200 frames of 200 points: the mean of the shells above k = 1 has a relative error of 0.2 %.
    points = np.random.default_rng(7).random((200, 200, 2)) * 20
    curve = gf.structure_factor(list(points), box=(20, 20), boundary="periodic").table()
    far = curve[curve["k"] > 1]
    assert np.average(far["s"], weights=far["n"]) == pytest.approx(1, abs=0.02)
    variance = gf.number_variance(list(points), box=(20, 20), boundary="periodic").table()
    small = variance[variance["l"] < 2]
    np.testing.assert_allclose(small["variance"] / small["mean"], 1, atol=0.1)


def test_points_at_random_have_no_pair_correlation():
    # 3.7 million pairs further apart than 1 a; a bin of them is right to 1 %.
    points = np.random.default_rng(8).random((100, 400, 2)) * 20
    curve = gf.pair_distribution(list(points), box=(20, 20), boundary="walls", bin=0.1).table()
    np.testing.assert_allclose(curve["g"][curve["s"] > 1], 1, atol=0.06)
    assert float(curve["s"].max()) < 8


def test_results_are_those_of_the_command_line(tracked_by_program, tmp_path):
    run_program("analyze", tracked_by_program[1], "-o", tmp_path / "results.h5",
                "--observables", "q4,msd,sk,variance", "--sk-k-max", "5")
    expected = gf.read_results(tmp_path / "results.h5")
    found = gf.analyze(gf.read(tracked_by_program[1]), "q4,msd,sk,variance", sk_k_max=5)
    for name in ("q4", "msd", "sk", "variance"):
        assert found[name].measurements == expected[name].measurements
        assert set(found[name].curves) == set(expected[name].curves)
        for curve in found[name].curves:
            a, b = found[name].table(curve), expected[name].table(curve)
            for column in a:
                np.testing.assert_array_equal(a[column], b[column], err_msg=f"{curve}.{column}")


def test_options_reach_the_observable():
    points = np.random.default_rng(7).random((4, 500, 2)) * 30
    few = gf.structure_factor(list(points), box=(30, 30), boundary="periodic", k_max=2).table()
    assert few["k"].max() <= 2
    alone = gf.analyze(list(points), "sk", box=(30, 30), boundary="periodic", sk={"k_max": 2})
    np.testing.assert_array_equal(alone["sk"].table()["s"], few["s"])


def test_what_cannot_be_measured_says_why():
    two = [square(), square()]
    assert "not linked" in gf.msd(two, box=(20, 20), boundary="periodic").reason
    assert "no maximum" in gf.fit_hyperuniform(two, box=(20, 20), boundary="periodic").reason


def test_points_without_correlation_are_not_hyperuniform():
    points = np.random.default_rng(7).random((200, 200, 2)) * 20
    fit = gf.fit_hyperuniform(list(points), box=(20, 20), boundary="periodic", k_max=2, alpha=1)
    # S = 1: five standard errors are a false alarm of 6e-7.
    assert abs(float(fit["s0"]) - 1) < 5 * fit["s0"].error < 0.25
    assert abs(float(fit["s1"])) < 5 * fit["s1"].error
    assert float(fit["k_fit"]) == 2 and fit["alpha"].reason == "given, not fitted"


def test_a_fit_that_could_not_be_made_says_why():
    points = np.random.default_rng(8).random((60, 800, 2)) * 30
    fit = gf.fit_hyperuniform(list(points), box=(30, 30), boundary="periodic")
    assert "no maximum" in (fit.reason or fit["s0"].reason)
    assert fit["s_growth"].value is not None and "s0" not in repr(fit).replace("s0_", "")
    with pytest.raises(KeyError, match="no maximum"):
        fit.table()


def test_a_report_compares_results(tmp_path, layer, frames):
    md = gf.analyze(layer, "q4,sk", label="MD")
    film = gf.analyze(gf.track(frames, search_range=6), "q4,sk", label="film")
    written = gf.compare(md, film, output=tmp_path / "report.html", figures=False, title="Both")
    assert written == [str(tmp_path / "report.html")]
    page = (tmp_path / "report.html").read_text()
    assert "Both" in page and "film" in page
    with pytest.raises(gf.OutputError):
        gf.compare(md, output=tmp_path / "report.html", figures=False)
    with pytest.raises(gf.OptionError):
        gf.compare(output=tmp_path / "none.html", figures=False)
    md.save(tmp_path / "md.h5")
    assert gf.read_results(tmp_path / "md.h5").label == "MD"


def test_a_trajectory_brings_its_own_box(layer):
    with pytest.raises(gf.OptionError, match="its own box"):
        gf.q4(layer, box=(3, 3))
