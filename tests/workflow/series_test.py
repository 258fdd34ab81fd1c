"""The table of scripts/run-series, and a dry run of its workflow (skipped without snakemake).

    series_test.py REPOSITORY
"""

import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else __file__).resolve()
if ROOT.name == "series_test.py":
    ROOT = ROOT.parents[2]
sys.path.insert(0, str(ROOT / "workflow"))

import jobs  # noqa: E402
import series  # noqa: E402


class WithFilms(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("slow.avi", "b/slow.avi", "frames/1.tif", "frames/2.tif", "it's.avi"):
            path = self.folder / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(b"x" * 1000)

    def table(self, text):
        path = self.folder / "table.csv"
        path.write_text(text, encoding="utf-8")
        return path

    def read(self, text):
        return series.read_table(self.table(text))


class TheTable(WithFilms):
    def test_one_column_is_enough_and_films_are_below_the_table(self):
        (run,) = self.read("film\nslow.avi\n")
        self.assertEqual((run.name, run.label, run.gamma, run.track, run.analyze), ("slow", "slow", "", [], []))
        self.assertEqual(run.files, [str(self.folder.resolve() / "slow.avi")])

    def test_options_are_words_of_a_command_line(self):
        (run,) = self.read('film,label,gamma,track,analyze\nslow.avi,Slow one,2.5,--fps 500,"--observables q4,sk"\n')
        self.assertEqual(run.track, ["--fps", "500"])
        self.assertEqual(run.analyze_options(), ["--label", "Slow one", "--observables", "q4,sk", "--gamma", "2.5"])

    def test_a_pattern_of_pictures_is_one_film_named_after_its_folder(self):
        (run,) = self.read("film\nframes/*.tif\n")
        self.assertEqual(run.name, "frames")
        self.assertEqual([pathlib.Path(f).name for f in run.files], ["1.tif", "2.tif"])

    def test_films_of_one_name_get_numbers(self):
        names = [run.name for run in self.read("film\nslow.avi\nb/slow.avi\nit's.avi\n")]
        self.assertEqual(names, ["slow", "slow-2", "it-s"])

    def test_comments_and_empty_lines_do_not_count(self):
        self.assertEqual(len(self.read("# mine\n\nfilm\n# not yet\nslow.avi\n\n")), 1)

    def test_what_is_wrong_is_named_with_its_line(self):
        for text, said in [
            ("film\nnothing.avi\n", "line 2: there is no film 'nothing.avi'"),
            ("film\nframes/*.png\n", r"line 2: there is no film 'frames/\*.png'"),
            ("film\nframes\n", "line 2: there is no film 'frames'"),
            ("film,gamma\n# a comment\nslow.avi,2,5\n", "line 3: 3 values; expected 2"),
            ("film,gamma\nslow.avi,fast\n", "line 2: gamma 'fast'; expected a number"),
            ("film,gamma\nslow.avi,nan\n", "gamma 'nan'"),
            ("film,track\nslow.avi,-o x.h5\n", "track has -o, which the series sets itself"),
            ("film,track\nslow.avi,--output=x.h5\n", "track has --output=x.h5"),
            ("film,track\nslow.avi,\"--label 'a\"\n", "No closing quotation"),
            ("movie\nslow.avi\n", "columns movie; expected film and any of label"),
            ("film,film\nslow.avi,slow.avi\n", "columns film, film"),
            ("film\n", "there is no film in it"), ("", "columns none"),
        ]:
            with self.assertRaisesRegex(series.TableError, said):
                self.read(text)

    def test_a_critical_point_takes_three_values_of_gamma(self):
        line = "slow.avi,{}\n"
        for values, expected in [((1, 2, 3), True), ((1, 2, 2), False), ((1, 2, ""), False), ((1, 2, 3, ""), False)]:
            runs = self.read("film,gamma\n" + "".join(line.format(v) for v in values))
            self.assertEqual(series.has_critical_point(runs), expected, values)

    def test_frames_and_pixels_are_those_of_the_pictures(self):
        tiff = b"II*\0" + struct.pack("<IH", 8, 2) + struct.pack("<HHIHH", 256, 3, 1, 300, 0) + \
            struct.pack("<HHII", 257, 4, 1, 200) + bytes(4)
        large = b"MM\0*" + struct.pack(">IH", 8, 2) + struct.pack(">HHIHH", 256, 3, 1, 301, 0) + \
            struct.pack(">HHII", 257, 4, 1, 200) + bytes(4)
        png = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + struct.pack(">II", 640, 480) + bytes(40)
        for name, head, size in [("a.tif", tiff, (300, 200)), ("b.tif", large, (301, 200)), ("c.png", png, (640, 480)),
                                 ("d.pgm", b"P5\n# by hand\n20 10 255\n" + bytes(200), (20, 10)),
                                 ("e.avi", b"RIFF", None), ("f.tif", tiff[:20], None), ("g.png", png[:10], None)]:
            path = self.folder / name
            path.write_bytes(head)
            self.assertEqual(series.picture_size(path), size, name)
        paths = [str(self.folder / "a.tif")] * 7
        self.assertEqual(series.film_size(paths), series.Film(7, 60000))
        stack = self.folder / "stack.tif"
        stack.write_bytes(tiff + bytes(5 * 60000 - len(tiff)))
        self.assertEqual(series.film_size([str(stack)]), series.Film(5, 60000))

    def test_spheres_are_counted_by_the_diameter_that_is_given(self):
        for options, expected in [("--sphere-diameter 20", 1.2 * 10000 / 400), ("--sphere-diameter=10", 120),
                                  ("--fps 25 --disc-diameter 10 --memory 3", 120), ("--fps 25", 10000 / 150),
                                  ("--sphere-diameter 10px", 120), ("--sphere-diameter='20 px'", 30), ("--diameter=10px", 120),
                                  ("--sphere-diameter", 10000 / 150), ("--sphere-diameter wide", 10000 / 150),
                                  ("--sphere-diameter px", 10000 / 150)]:
            (run,) = self.read(f"film,track\nslow.avi,{options}\n")
            self.assertAlmostEqual(run.spheres(10000), expected, msg=options)

    def test_a_video_gets_the_time_of_a_packed_one(self):
        (video,) = self.read("film\nslow.avi\n")
        self.assertEqual(series.film_size(video.files), series.Film(1, 1000, 10))
        self.assertAlmostEqual(video.track_job().seconds, 10 * jobs.track(1, 1000 / 150, 1000).seconds)
        self.assertAlmostEqual(video.analyze_job().megabytes, jobs.analyze(1, 1000 / 150).megabytes)

    def test_an_empty_film_is_no_trouble_of_the_plan(self):
        (self.folder / "empty.avi").write_bytes(b"")
        (run,) = self.read("film\nempty.avi\n")
        self.assertEqual(run.track_job().minutes(), jobs.LEAST_MINUTES)


def run_series(*words, **environment):
    return subprocess.run([ROOT / "scripts/run-series", *map(str, words)], capture_output=True, text=True,
                          env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **environment})


class TheScript(WithFilms):
    def test_says_what_is_wrong_with_its_words(self):
        table = self.table("film\nnothing.avi\n")
        for words, code, text in [((), 2, "give a table"), ((table, table), 2, "one table"),
                                  ((table, "--core", 1), 2, "'--core'"), ((table, "--cores", "two"), 2, "'two'"),
                                  (("none.csv",), 3, "none.csv"), ((table,), 1, "no film 'nothing.avi'")]:
            outcome = run_series(*words)
            self.assertEqual(outcome.returncode, code, words)
            self.assertIn(text, outcome.stderr)

    @unittest.skipUnless(shutil.which("snakemake"), "no snakemake here (Debian: apt-get install snakemake)")
    def test_dry_run_plans_each_film_and_the_critical_point(self):
        table = self.table("film,gamma\nslow.avi,2\nb/slow.avi,3\nit's.avi,4\n")
        outcome = run_series(table, "--dry-run", "--output", self.folder / "out")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        text = outcome.stdout + outcome.stderr
        for rule, count in [("track", 3), ("analyze", 3), ("critical", 1), ("report", 1)]:
            self.assertRegex(text, rf"(?m)^{rule}\s+{count}\b")

if __name__ == "__main__":
    unittest.main()
