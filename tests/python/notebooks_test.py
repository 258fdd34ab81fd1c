"""The notebooks of examples/notebooks run, say what they should, and are kept without their output.

Jupyter's own kernel runs them where Debian's python3-nbclient and python3-ipykernel are; else their cells run one after
another.
"""
import contextlib
import io
import json
import pathlib
import re

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples/notebooks"
NUMBER = r"([\d.]+)"

pytest.importorskip("matplotlib")


def content(name):
    return json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))


def printed_by_jupyter(name):
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs), "no picture"
    return "".join(output["text"] for output in outputs if output.get("name") == "stdout")


def printed_by_cells(name):
    import matplotlib

    matplotlib.use("agg")
    names, text = {}, io.StringIO()
    with contextlib.redirect_stdout(text):
        for cell in content(name)["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), name, "exec"), names)
    return text.getvalue()


def printed(name):
    try:
        import ipykernel  # noqa: F401
        import nbclient  # noqa: F401
    except ImportError:
        return printed_by_cells(name)
    return printed_by_jupyter(name)


def numbers(pattern, text):
    found = re.search(pattern, text)
    assert found, text
    return [float(number) for number in found.groups()]


def test_a_film_is_tracked():
    text = printed("track_a_film")
    spheres, error = numbers(rf"{NUMBER} spheres, typical error {NUMBER} px", text)
    assert 290 <= spheres <= 301 and 0 < error < 0.2
    frames, tracks, diameter = numbers(rf"{NUMBER} frames, {NUMBER} tracks, disc diameter {NUMBER} px", text)
    assert frames == 61 and 295 <= tracks <= 320 and 12 < diameter < 16.5
    order, its_error = numbers(rf"Q4\| = {NUMBER} ± {NUMBER}", text)
    assert 0.2 < order < 0.8 and 0 < its_error < 0.05


def test_what_was_found_is_scored_against_the_truth():
    text = printed("validate_on_rendered_frames")
    spheres, missed, false = numbers(rf"{NUMBER} spheres: {NUMBER} missed, {NUMBER} false", text)
    assert spheres > 7000 and missed < 0.003 * spheres and false < 0.003 * spheres
    (rmse,) = numbers(rf"RMS error {NUMBER} px", text)
    pulls, within = numbers(rf"RMS of the pulls {NUMBER}, within two standard errors {NUMBER}", text)
    assert rmse < 0.2 and 0.75 < pulls < 1.2 and 0.93 < within < 0.98
    tracked, true = numbers(rf"Q4\|: {NUMBER} tracked, {NUMBER} true", text)
    assert tracked == pytest.approx(true, abs=0.01)


def test_three_systems_have_the_fluctuations_that_are_known():
    text = printed("hyperuniformity_of_three_systems")
    (gas,) = numbers(rf"ideal gas: S = {NUMBER}", text)
    (lattice,) = numbers(rf"shuffled lattice: S = {NUMBER}", text)
    assert 0.6 < gas < 1.5  # 4 modes of 80 frames: 5 standard errors are 0.3
    # 1 − exp(−k²σ²) = 0.0062 at k = 2π/24, to 5 standard errors of 320 modes.
    assert lattice == pytest.approx(0.0062, abs=0.002)
    for name, expected in (("s0", 0), ("s1", 0.09)):
        value, its_error = numbers(rf"{name} = (-?[\d.]+) ± {NUMBER}", text)
        assert abs(value - expected) < 5 * its_error < 0.03
    (layer,) = numbers(rf"layer: S = {NUMBER}", text)
    assert layer < 0.5 * gas
    assert "field: S = " in text


def test_notebooks_are_kept_without_output_and_small():
    files = sorted(FOLDER.glob("*.ipynb"))
    assert len(files) == 3
    for path in files:
        assert path.stat().st_size < 100_000
        for cell in content(path.stem)["cells"]:
            assert cell["cell_type"] == "markdown" or (cell["outputs"] == [] and cell["execution_count"] is None), path.name
