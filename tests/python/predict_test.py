"""Prediction in trackpy's words finds particles that go farther than half their spacing."""
import numpy as np
import pandas as pd
import pytest

import grainfield as gf


def lattice(t, velocity, side=6):
    """Points one apart that have gone `t` times the velocity, which is a function of y."""
    x, y = (grid.ravel().astype(float) for grid in np.mgrid[:side, :side])
    return pd.DataFrame({"x": x + t * velocity(y), "y": y, "frame": t, "true": np.arange(side**2)})


def uniform(times=(0, 0.4, 1.1)):
    """A first step of 0.4 spacings, a second one of 0.7."""
    return [lattice(t, np.ones_like) for t in times]


def shear(times=(0, 0.25, 0.65)):
    return [lattice(t, lambda y: 0.3 * y) for t in times]


def wrong_or_missing(tracks):
    return int((tracks.groupby("true")["particle"].nunique() - 1).sum())


def test_without_prediction_particles_are_taken_for_their_neighbours():
    with pytest.warns(gf.GrainfieldWarning):
        assert wrong_or_missing(gf.link_df(pd.concat(uniform()), 0.5)) >= 30


@pytest.mark.parametrize("frames, predictor", [
    (uniform(), gf.predict.NearestVelocityPredict()),
    (uniform(), gf.predict.DriftPredict()),
    (shear(), gf.predict.NearestVelocityPredict()),
    (shear(), gf.predict.ChannelPredict(0.5, "x", minsamples=3))])
def test_with_prediction_every_particle_keeps_its_number(frames, predictor):
    assert wrong_or_missing(predictor.link_df(pd.concat(frames), 0.5)) == 0
    assert wrong_or_missing(pd.concat(predictor.link_df_iter(frames, 0.5))) == 0


def test_null_prediction_is_none():
    with pytest.warns(gf.GrainfieldWarning):
        plain = gf.link(pd.concat(uniform()), 0.5)
        pd.testing.assert_frame_equal(gf.predict.NullPredict().link(pd.concat(uniform()), 0.5), plain)


def test_tables_of_an_iterator_come_back_one_by_one_with_their_index():
    frames = [table.set_index(np.arange(100, 100 + len(table))) for table in uniform()]
    found = list(gf.link_df_iter(iter(frames), 0.5, predictor="drift"))
    assert len(found) == 3
    for before, after in zip(frames, found, strict=True):
        pd.testing.assert_frame_equal(after.drop(columns="particle"), before)
    assert "particle" not in frames[0].columns
    assert list(gf.link_df_iter([], 1)) == []


def test_empty_tables_of_an_iterator_stay_where_they_are():
    full = uniform()
    empty = full[0].iloc[:0]
    frames = [empty, full[0], empty, full[1], empty]
    found = list(gf.link_df_iter(frames, 0.5, memory=1))
    assert [len(table) for table in found] == [len(table) for table in frames]
    for before, after in zip(frames, found, strict=True):
        pd.testing.assert_frame_equal(after.drop(columns="particle"), before)
        assert after["particle"].dtype == np.int64
    nothing = list(gf.link_df_iter([empty, empty], 0.5))
    assert [list(table.columns) for table in nothing] == [[*full[0].columns, "particle"]] * 2


def test_what_has_no_counterpart_is_refused_or_said():
    with pytest.raises(gf.OptionError, match="initial_guess"):
        gf.predict.DriftPredict(initial_guess=(0, 1))
    with pytest.warns(gf.GrainfieldWarning, match="span"):
        gf.predict.NearestVelocityPredict(span=3)
    with pytest.raises(gf.OptionError, match="grainfield.predict"):
        gf.link(uniform()[0], 1, predictor=lambda t, particles: particles)
    with pytest.raises(gf.OptionError, match="dist_func"):
        gf.link(uniform()[0], 1, dist_func=max)


def test_no_group_of_candidates_is_too_large_for_a_wide_search_range():
    # trackpy's walk-through "Adaptive search": each point of the contracted grid lies within reach of several.
    x, y = (grid.ravel().astype(float) for grid in np.mgrid[-10:11, -10:11])
    first = pd.DataFrame({"x": x, "y": y, "frame": 0, "true": np.arange(x.size)})
    both = pd.concat([first, first.assign(x=0.95 * x, y=0.95 * y, frame=1)])
    with pytest.warns(gf.GrainfieldWarning, match="adaptive_stop"):
        tracks = gf.link_df(both, 0.95, adaptive_stop=0.56)
    assert wrong_or_missing(tracks) == 0
