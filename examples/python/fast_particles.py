"""The walk-through "Prediction" of trackpy, with another import: particles that go farther in one step than half their
spacing."""
import numpy as np
import pandas

import grainfield as trackpy  # was: import trackpy


def fakeframe(t=0.0, Nside=4):
    xg, yg = np.mgrid[:Nside, :Nside]
    return pandas.DataFrame(dict(x=xg.flatten() + t, y=yg.flatten() - t, frame=t, true=np.arange(Nside**2)))


def fakeshear(t=0.0, Nside=4):
    xg, yg = np.mgrid[:Nside, :Nside]
    return pandas.DataFrame(dict(x=(xg + 0.45 * t * yg).flatten(), y=yg.flatten(), frame=t, true=np.arange(Nside**2)))


def right(tracks):
    """Links that join what belongs together, and those that there are to find."""
    steps = tracks.sort_values(["true", "frame"])
    same = (steps["particle"].diff() == 0) & (steps["true"].diff() == 0)
    return f"{same.sum()} of {len(tracks) - tracks['true'].nunique()}"


# Small displacements first, then it speeds up.
frames = [fakeframe(t) for t in (0, 0.25, 0.65)]
plain = pandas.concat(trackpy.link_df_iter(frames, 0.5))
pred = trackpy.predict.NearestVelocityPredict()
nearest = pandas.concat(pred.link_df_iter(frames, 0.5))
pred = trackpy.predict.DriftPredict()
drift = pred.link_df(pandas.concat(frames), 0.5)
print(f"uniform motion: {right(plain)} links without prediction, {right(nearest)} with that of the nearest velocity, "
      f"{right(drift)} with that of the drift")

frames = [fakeshear(t) for t in (0, 0.25, 0.65)]
plain = pandas.concat(trackpy.link_df_iter(frames, 0.5))
pred = trackpy.predict.ChannelPredict(0.5, "x", minsamples=3)
channel = pandas.concat(pred.link_df_iter(frames, 0.5))
print(f"accelerating shear: {right(plain)} links without prediction, {right(channel)} with it")
