"""What the scripts of long runs share: how they run a program, and what bench/results/paper holds."""

import csv
import math
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench/results/paper"

WORDS = ("modes", "origin", "geometry", "folder")  # columns of text

# The ends of the annuli whose S is printed, narrow enough for one number and wide enough for many waves.
ANNULI = [(0.02, 0.045), (0.045, 0.07), (0.07, 0.1), (0.1, 0.15), (0.15, 0.2), (0.2, 0.3)]
THIRDS = ("first", "second", "last")
VARIANTS = {"": "300 a", "-literal": "one coefficient of friction", "-large": "600 a",
            "-literal-large": "one coefficient, 600 a"}


def output_of(command):
    """What a command prints; ends the script with its message if it fails, and as Ctrl-C does if it was stopped."""
    script = pathlib.Path(sys.argv[0]).name
    command = [str(word) for word in command]
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except OSError as error:
        sys.exit(f"{script}: cannot run '{command[0]}': {error.strerror}; give the path of grainfield")
    if done.returncode in (130, 143):
        raise KeyboardInterrupt
    if done.returncode:
        sys.exit(f"{script}: {' '.join(command[:3])} ended with exit code {done.returncode}:\n{done.stderr}")
    return done.stdout


def table(path):
    with open(path, newline="") as file:
        return [{name: float(value) if value else math.nan for name, value in row.items()
                 if name not in WORDS} | {name: row[name] for name in WORDS if name in row} for row in csv.DictReader(file)]


def runs(prefix, suffix=""):
    """Γ or ν, which stands in the name, and folder of all runs, from low to high."""
    names = re.compile(re.escape(prefix) + r"([\d.]+)" + re.escape(suffix))
    found = [(names.fullmatch(folder.name), folder) for folder in RESULTS.iterdir()]
    return sorted((float(match[1]), folder) for match, folder in found if match)


def averaged(rows, low, high):
    """S of all waves of an annulus: the mean of its shells, each as often as it has waves; none without a shell."""
    inside = [r for r in rows if low <= r["k"] < high]
    return sum(r["s"] * r["n"] for r in inside) / sum(r["n"] for r in inside) if inside else math.nan


def thirds(folder):
    """S of each annulus, in each third of a run."""
    return [[averaged(table(folder / f"sk_third_{part}.csv"), low, high) for low, high in ANNULI] for part in (1, 2, 3)]
