"""A table of films, one run a row: what scripts/run-series makes of it, by name. Nothing is run here.

Columns: film, and any of label, gamma, track, analyze. `film` is a video, a picture or a pattern of pictures
(frames/*.tif), below the folder of the table. `gamma` is the control parameter Γ. `track` and `analyze` are options of
these commands, as they stand on a command line. Lines that begin with # are left out.
"""

import csv
import glob
import pathlib
import re
import shlex

COLUMNS = ("film", "label", "gamma", "track", "analyze")
OURS = ("-o", "--output", "--resume", "--force", "--json", "--threads", "--label", "--gamma", "-c", "--config")

# What a job takes. Tracking: a sphere and frame of a thick layer costs 9.4e-5 s of a core (workflow/scales.toml), a
# sphere is about 150 pixels, and video packs ten of them into a byte at most. The rest is room for a slower machine.
TRACK_SECONDS_A_BYTE = 10 * 9.4e-5 / 150
ANALYZE_SECONDS_A_BYTE = 1e-6
LEAST_MINUTES = 10


class TableError(ValueError):
    """Names the file, the line, what is wrong with it and what was expected."""


class Run:
    """One film: its files, its options, and what its jobs take."""

    def __init__(self, name, files, label, gamma, track, analyze):
        self.name = name
        self.files = files
        self.label = label
        self.gamma = gamma
        self.track = track
        self.analyze = analyze

    def bytes(self):
        return sum(pathlib.Path(file).stat().st_size for file in self.files)

    def track_minutes(self, attempt=1):
        """Doubled with each attempt. A job that was cut off goes on from its checkpoint besides."""
        return round(2 ** (attempt - 1) * (LEAST_MINUTES + self.bytes() * TRACK_SECONDS_A_BYTE / 60))

    def analyze_minutes(self, attempt=1):
        return round(2 ** (attempt - 1) * (LEAST_MINUTES + self.bytes() * ANALYZE_SECONDS_A_BYTE / 60))

    def analyze_options(self):
        options = ["--label", self.label, *self.analyze]
        return options + (["--gamma", self.gamma] if self.gamma else [])


def _files(folder, pattern, where):
    path = folder / pattern
    found = sorted(glob.glob(str(path))) if re.search(r"[*?\[]", pattern) else [str(path)]
    if not found or not all(pathlib.Path(file).is_file() for file in found):
        raise TableError(f"{where}: there is no film '{pattern}'; expected a file, or a pattern of pictures, below {folder}")
    return found


def _words(text, column, where):
    try:
        words = shlex.split(text)
    except ValueError as wrong:
        raise TableError(f"{where}: {column} '{text}': {wrong}") from wrong
    for word in words:
        if word.split("=")[0] in OURS:
            raise TableError(f"{where}: {column} has {word}, which the series sets itself; leave it out")
    return words


def _gamma(text, where):
    try:
        if text and not 0 <= float(text) < float("inf"):
            raise ValueError
    except ValueError:
        raise TableError(f"{where}: gamma '{text}'; expected a number, or nothing") from None
    return text


def _name(film, taken):
    """Of the files of a run: the name of the film, or of the folder of its pictures."""
    path = pathlib.Path(film)
    stem = path.parent.name if re.search(r"[*?\[]", path.name) and path.parent.name else path.stem
    base = re.sub(r"[^A-Za-z0-9.-]+", "-", stem).strip("-.") or "film"
    name, number = base, 1
    while name in taken:
        number += 1
        name = f"{base}-{number}"
    return name


def read_table(path):
    """The runs of a table, in its order. Raises TableError."""
    path = pathlib.Path(path)
    with open(path, newline="", encoding="utf-8-sig") as file:
        lines = [(number, line) for number, line in enumerate(file, 1) if line.strip() and not line.startswith("#")]
    rows = csv.reader(line for _, line in lines)
    header = [word.strip() for word in next(rows, [])]
    unknown = [word for word in header if word not in COLUMNS]
    if unknown or "film" not in header or len(set(header)) < len(header):
        raise TableError(f"{path}: columns {', '.join(header) or 'none'}; expected film and any of {', '.join(COLUMNS[1:])}")
    runs, taken = [], set()
    for (number, _), values in zip(lines[1:], rows, strict=False):
        where = f"{path}, line {number}"
        if len(values) != len(header):
            raise TableError(f"{where}: {len(values)} values; expected {len(header)}, as the header has columns")
        row = {column: "" for column in COLUMNS} | dict(zip(header, (value.strip() for value in values), strict=True))
        name = _name(row["film"], taken)
        taken.add(name)
        runs.append(Run(name, _files(path.resolve().parent, row["film"], where), row["label"] or name,
                        _gamma(row["gamma"], where), _words(row["track"], "track", where),
                        _words(row["analyze"], "analyze", where)))
    if not runs:
        raise TableError(f"{path}: there is no film in it; expected one a line")
    return runs


def has_critical_point(runs):
    """Whether the films are of a series: three values of Γ or more, each film having one."""
    return all(run.gamma for run in runs) and len({float(run.gamma) for run in runs}) >= 3
