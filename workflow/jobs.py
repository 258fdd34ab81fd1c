"""What a job takes, from the numbers of spheres, frames, pixels and steps, and what a scheduler is asked for.

The rates are measured ones, in workflow/rates.toml. Nothing is run here.
"""

import pathlib
import tomllib
from typing import NamedTuple

with open(pathlib.Path(__file__).parent / "rates.toml", "rb") as _file:
    _RATES = tomllib.load(_file)
SECONDS, BYTES, SPEED_UP = _RATES["seconds"], _RATES["bytes"], _RATES["speed-up"]

ROOM_OF_TIME = 3  # a slower machine, and other work beside
ROOM_OF_MEMORY = 2
LEAST_MINUTES = 10
LEAST_MB = 500
LARGE_LAYER = 50_000  # grains; a smaller one is not faster on two threads


class Job(NamedTuple):
    """Expected: seconds of one core, megabytes at most, and what a second thread brings."""

    seconds: float
    megabytes: float
    speed_up: float = 1.0

    def clock(self, threads=1):
        """Expected seconds by the clock."""
        return self.seconds / (self.speed_up if threads > 1 else 1)

    def minutes(self, threads=1, attempt=1):
        """To ask for, doubled with each attempt. A job that was cut off goes on from its checkpoint besides."""
        return round(2 ** (attempt - 1) * (LEAST_MINUTES + ROOM_OF_TIME * self.clock(threads) / 60))

    def mem_mb(self, attempt=1):
        """To ask for, doubled with each attempt."""
        return round(2 ** (attempt - 1) * max(LEAST_MB, ROOM_OF_MEMORY * self.megabytes))


def _megabytes(more):
    return (BYTES["program"] + more) / 1e6


def simulate_md(grains, periods, walls):
    rate = SECONDS["grain-period-walls" if walls else "grain-period-periodic"]
    speed_up = SPEED_UP["grains"] if grains >= LARGE_LAYER else 1
    return Job(grains * periods * rate, _megabytes(grains * BYTES["grain"]), speed_up)


def simulate_field(sites, steps, dimension):
    plane = dimension == 2
    rate = SECONDS["site-step" if plane else "node-step"]
    return Job(sites * steps * rate, _megabytes(sites * BYTES["site"]), SPEED_UP["sites"] if plane else 1)


def render(frames, pixels, instants):
    """`pixels` of one frame, as in track; `instants` in its exposure."""
    seconds = frames * pixels / 1e6 * (1 + instants) * SECONDS["megapixel-render"]
    return Job(seconds, _megabytes(pixels * BYTES["pixel-render"]))


def track(frames, spheres, pixels):
    """`spheres` of one frame, as in analyze."""
    return Job(frames * spheres * SECONDS["sphere-track"], _megabytes(pixels * BYTES["pixel-track"]), SPEED_UP["track"])


def analyze(frames, spheres, motion=True):
    """`motion`: the spheres are followed from frame to frame (msd, phase)."""
    kept = frames * spheres * BYTES["observation"] if motion else 0
    return Job(frames * spheres * SECONDS["sphere-analyze"], _megabytes(spheres * BYTES["sphere-analyze"] + kept))
