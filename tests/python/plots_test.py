"""Pictures of what was found: what they show stands where it stands in the frame."""
import numpy as np
import pandas as pd
import pytest

import grainfield as gf

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")
plt = pytest.importorskip("matplotlib.pyplot")


@pytest.fixture
def ax():
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


TRACKS = pd.DataFrame({"x": [1.0, 2, 3, 7, 8], "y": [5.0, 5, 6, 1, 1], "frame": [0, 1, 2, 0, 1],
                       "particle": [4, 4, 4, 9, 9]})


def test_circles_have_the_measured_diameter_and_y_points_down(frames, ax):
    found = gf.locate(frames[0])
    assert gf.annotate(found, frames[0], ax=ax) is ax
    (circles,) = ax.collections
    np.testing.assert_array_equal(circles.get_offsets(), found[["x", "y"]])
    ax.figure.canvas.draw()
    assert len(circles.get_paths()) == 1 and ax.yaxis_inverted()
    (image,) = ax.images
    np.testing.assert_array_equal(image.get_array(), frames[0])
    low, high = sorted(image.get_extent()[:2])
    assert (low, high) == (-0.5, frames[0].shape[1] - 0.5)
    # A unit circle, scaled to the radius on the screen: twice that is the diameter in pixels of the frame.
    diameter = found.attrs["grainfield"]["diameter"]
    corner, edge = ax.transData.transform([(0, 0), (diameter, 0)])
    assert 2 * circles.get_transforms()[0][0, 0] * circles.get_transform().get_matrix()[0, 0] == pytest.approx(
        edge[0] - corner[0], rel=1e-6)


def test_marks_of_points_without_a_diameter_stand_on_them(ax):
    gf.annotate(TRACKS, np.zeros((8, 10)), color="b", ax=ax, plot_style={"markersize": 3})
    (marks,) = ax.lines
    np.testing.assert_array_equal(marks.get_xydata(), TRACKS[["x", "y"]])
    assert marks.get_markersize() == 3


def test_each_track_is_a_line(ax):
    gf.plot_traj(TRACKS.sample(frac=1, random_state=1), mpp=0.5, label=True, superimpose=np.ones((8, 10)), ax=ax)
    first, second = ax.lines
    np.testing.assert_array_equal(first.get_xydata(), [[0.5, 2.5], [1, 2.5], [1.5, 3]])
    np.testing.assert_array_equal(second.get_xydata(), [[3.5, 0.5], [4, 0.5]])
    assert [text.get_text() for text in ax.texts] == ["4", "9"]
    assert ax.get_xlabel() == "x [µm]" and ax.yaxis_inverted()
    assert tuple(ax.images[0].get_extent()) == (-0.25, 4.75, 3.75, -0.25)


def test_tracks_may_have_the_colours_of_their_frames(ax):
    gf.plot_traj(TRACKS, colorby="frame", ax=ax)
    assert [len(lines.get_segments()) for lines in ax.collections] == [2, 1]
    np.testing.assert_array_equal(ax.collections[0].get_array(), [1, 2])
    assert ax.yaxis_inverted()


def test_an_empty_table_has_no_tracks_to_plot(ax):
    with pytest.raises(gf.InputError, match="no tracks"):
        gf.plot_traj(TRACKS[:0], ax=ax)
