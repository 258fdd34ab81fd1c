"""Snippets of docs/python.md, the examples, and Octave's way to our files run as they stand."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest
from conftest import run_program

import grainfield as gf

ROOT = pathlib.Path(__file__).resolve().parents[2]


def snippets(language):
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def test_the_snippets_of_the_page_run_one_after_another(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    names = {}
    found = snippets("python")
    assert len(found) == 4
    for snippet in found:
        exec(compile(snippet, "docs/python.md", "exec"), names)
    assert names["first"].shape[1] == 2 and len(names["em"]) > 5
    assert (tmp_path / "report.html").exists()


@pytest.mark.parametrize("name, said", [
    ("track_and_validate.py", r"(\d+) spheres, [0-9] missed, median error 0\.0\d+ px"),
    ("fast_particles.py", r"uniform motion: 16 of 32 links without prediction, 32 of 32 .*, 32 of 32 .*\n"
                          r"accelerating shear: 28 of 32 links without prediction, 32 of 32 with it"),
    ("three_systems.py", r"ideal gas: S = (0\.9|1\.)\d+ .*\nlayer: S = 0\.[1-4]\d+ .*\nfield: S = "),
])
def test_an_example_says_what_it_should(name, said):
    output = subprocess.run([sys.executable, "-W", "ignore", ROOT / "examples/python" / name], check=True,
                            capture_output=True, text=True).stdout
    assert re.fullmatch(said + r".*\n", output), output


def test_the_stubs_name_what_the_module_has():
    text = (ROOT / "python/grainfield/_grainfield.pyi").read_text()
    named = set(re.findall(r"^(?:def|class) (\w+)", text, re.MULTILINE)) | {"version"}
    from grainfield import _grainfield
    assert named == {name for name in dir(_grainfield) if not name.startswith("_")}


def octave(script, folder):
    if not shutil.which("octave-cli"):
        pytest.skip("Octave is not installed (scripts/install-dependencies --tests)")
    outcome = subprocess.run(["octave-cli", "--quiet", "--eval", "try, pkg load hdf5oct; catch, end;\n" + script], cwd=folder,
                             capture_output=True, text=True)
    assert outcome.returncode == 0, outcome.stderr
    return outcome.stdout.split()


def numbers_in_octave(snippet, folder):
    return [float(number) for number in octave(snippet + 'printf("%.17g\\n", sort(x));', folder)]


@pytest.mark.parametrize("language", ["octave", "matlab"])
def test_octave_reads_a_trajectory(tmp_path, tracked_by_program, language):
    if language == "matlab" and octave('printf("%d", exist("h5read"))', tmp_path) == ["0"]:
        pytest.skip("this Octave has no h5read (package hdf5oct)")
    shutil.copy(tracked_by_program[1], tmp_path / "tracks.h5")
    last = gf.read(tmp_path / "tracks.h5")[-1]["position"]
    (snippet,) = snippets(language)
    assert numbers_in_octave(snippet, tmp_path) == sorted(last[:, 0])


def test_octave_reads_an_exported_table(tmp_path, tracked_by_program):
    run_program("export", tracked_by_program[1], "-o", tmp_path / "tracks.csv", "--digits", "all")
    last = gf.read(tracked_by_program[1])[-1]["position"]
    columns = (tmp_path / "tracks.csv").read_text().split("\n", 1)[0].split(",")
    frame, x = columns.index("frame") + 1, columns.index("x") + 1
    script = ('table = dlmread("tracks.csv", ",", 1, 0);\n'
              f"x = table(table(:, {frame}) == max(table(:, {frame})), {x});\n")
    assert numbers_in_octave(script, tmp_path) == sorted(last[:, 0])


def test_pandas_reads_an_exported_table_as_it_stands(tmp_path, layer):
    pandas = pytest.importorskip("pandas")
    layer.save(tmp_path / "tracks.h5")
    run_program("export", tmp_path / "tracks.h5", "-o", tmp_path / "tracks.csv")
    table = pandas.read_csv(tmp_path / "tracks.csv")
    assert list(table.columns[:3]) in (["frame", "particle", "x"], ["frame", "x", "y"])
    last = table[table.frame == table.frame.max()]
    assert sorted(last.x) == pytest.approx(sorted(layer[-1]["position"][:, 0]), abs=0.05)


def test_importing_takes_no_optional_library():
    script = ("import sys, grainfield; "
              "assert not {'pandas', 'xarray', 'MDAnalysis', 'napari', 'pims'} & set(sys.modules)")
    subprocess.run([sys.executable, "-c", script], check=True, env=os.environ)
    assert gf.__version__
