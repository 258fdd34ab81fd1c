"""A table of films, one run a row: what scripts/run-series makes of it, by name. Nothing is run here.

Columns: film, and any of label, gamma, track, analyze. `film` is a video, a picture or a pattern of pictures
(frames/*.tif), below the folder of the table. `gamma` is the control parameter Γ. `track` and `analyze` are options of
these commands, as they stand on a command line. Lines that begin with # are left out.
"""

import csv
import glob
import itertools
import pathlib
import re
import shlex
import struct
from typing import NamedTuple

import jobs

COLUMNS = ("film", "label", "gamma", "track", "analyze")
OURS = ("-o", "--output", "--resume", "--force", "--json", "--threads", "--label", "--gamma", "-c", "--config")

# A video is not opened: a pixel is a byte, or ten of them are one at most. A frame has no more pixels than these.
PACKED_PIXELS_A_BYTE = 10
VIDEO_FRAME = 4_000_000
# A thick layer has 1.2 spheres per a^2; where a is not given, a sphere is about 150 pixels.
SPHERES_PER_A2 = 1.2
PIXELS_A_SPHERE = 150
DIAMETERS = ("--sphere-diameter", "--disc-diameter", "--diameter")  # [px], with the unit or without


class TableError(ValueError):
    """Names the file, the line, what is wrong with it and what was expected."""


class Film(NamedTuple):
    """The frames of a film, the pixels of one, and how many times as many frames there may be."""

    frames: float
    pixels: float
    packed: float = 1


def picture_size(path):
    """(width, height) that the first bytes of a PNG, TIFF or PGM say; None for other files."""
    with open(path, "rb") as file:
        head = file.read(64)
        if head.startswith(b"\x89PNG") and len(head) >= 24:
            return struct.unpack(">II", head[16:24])
        if pgm := re.match(rb"P5(?:\s+#[^\n]*)*\s+(\d+)\s+(\d+)\s", head):
            return int(pgm[1]), int(pgm[2])
        if head[:4] not in (b"II*\0", b"MM\0*"):
            return None
        order = "<" if head[:2] == b"II" else ">"
        try:
            file.seek(struct.unpack(order + "I", head[4:8])[0])
            (count,) = struct.unpack(order + "H", file.read(2))
            found = {}
            for _ in range(count):
                tag, kind, _number, value = struct.unpack(order + "HHI4s", file.read(12))
                if tag in (256, 257):  # width, height
                    found[tag] = struct.unpack(order + "H", value[:2])[0] if kind == 3 else struct.unpack(order + "I", value)[0]
            return found[256], found[257]
        except (struct.error, KeyError):
            return None


def film_size(files):
    """Of a film by its files. Several pictures are one frame each; one may hold many."""
    size = picture_size(files[0])
    if size and len(files) > 1:
        return Film(len(files), size[0] * size[1])
    bytes_ = sum(pathlib.Path(file).stat().st_size for file in files)
    if size:
        return Film(max(1.0, bytes_ / (size[0] * size[1])), size[0] * size[1])
    pixels = min(bytes_, VIDEO_FRAME)
    return Film(bytes_ / pixels if pixels else 0, pixels, PACKED_PIXELS_A_BYTE)


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

    def spheres(self, pixels):
        """In a frame of so many pixels, were it full."""
        for word, value in itertools.pairwise([*self.track, ""]):
            name, _, given = word.partition("=")
            try:
                if name in DIAMETERS and (a := float((given or value).strip().removesuffix("px"))) > 0:
                    return SPHERES_PER_A2 * pixels / a**2
            except ValueError:
                pass  # the program says what is wrong with it
        return pixels / PIXELS_A_SPHERE

    def _job(self, kind):
        """Time is asked for were the film packed, memory is not: it doubles when it was too little."""
        film = film_size(self.files)
        job = kind(film.frames, self.spheres(film.pixels), film.pixels)
        return job._replace(seconds=job.seconds * film.packed)

    def track_job(self):
        return self._job(jobs.track)

    def analyze_job(self):
        return self._job(lambda frames, spheres, _pixels: jobs.analyze(frames, spheres))

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
