"""The plan of scripts/reproduce-paper, and a dry run of its workflow (skipped without snakemake).

    plan_test.py REPOSITORY
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else __file__).resolve()
if ROOT.name == "plan_test.py":
    ROOT = ROOT.parents[2]
sys.path.insert(0, str(ROOT / "workflow"))

import plan  # noqa: E402


def option(options, name):
    return next(o.split("=", 1)[1] for o in options if o.startswith(f"--{name}="))


class TheScales(unittest.TestCase):
    def test_small_takes_20_minutes_on_two_cores_and_each_scale_more_than_the_one_before(self):
        hours = [plan.Plan(scale).hours(2) for scale in plan.SCALES]
        self.assertLessEqual(hours[0], 20 / 60)
        self.assertLess(hours[0], hours[1] / 5)
        self.assertLess(hours[1], hours[2] / 5)
        self.assertLess(hours[2], hours[3] / 2)
        self.assertLessEqual(hours[1], 12, "a night")

    def test_full_has_the_sizes_of_the_paper(self):
        full = plan.Plan("full")
        self.assertEqual(full.layer_grains(), 355500)
        self.assertEqual(full.experiment_grains(), 11704)
        self.assertEqual(full.film_frames("slow1"), 3000)
        self.assertEqual(full.film_frames("fast"), 3000)
        self.assertEqual(full.films(), ["slow1", "slow2", "fast"])
        self.assertEqual(full.experiment["pixels"], 1600)
        self.assertIn("--nx=512", full.field_options("plane-b4-0.001"))
        self.assertIn("--nx=4096", full.field_options("line-b2-0.001"))

    def test_decide_has_3000_snapshots_of_nine_accelerations_and_films_two_slowly_and_one_fast(self):
        decide = plan.Plan("decide")
        self.assertEqual(len(decide.gammas()), 9)
        self.assertEqual((decide.gammas()[0], decide.gammas()[-1]), ("2.5", "6"))
        self.assertEqual(decide.film_frames("long"), 3000)
        options = decide.film_options("4.7", "long")
        self.assertEqual(option(options, "snapshot-every"), "8")
        self.assertEqual(int(option(options, "periods")) - int(option(options, "discard")), 8 * 2999)
        filmed = [gamma for gamma, film in decide.runs() if film == "slow1"]
        self.assertEqual(filmed, ["4", "5"])
        self.assertEqual(decide.film_frames("slow1"), 600)
        self.assertEqual([gamma for gamma, film in decide.runs() if film == "fast"], ["4.7"])
        self.assertEqual(decide.film_frames("fast"), 3000)
        self.assertEqual([rule for _, rule, words in decide.jobs() if words.get("film") == "long" and
                          rule in ("film", "track")], [])

    def test_decide_has_layers_of_two_sizes_and_two_readings_of_the_friction(self):
        decide = plan.Plan("decide")
        self.assertEqual(decide.layer_grains("2.2"), 88875)
        self.assertEqual(decide.layer_grains("2.2-large"), 355500)
        self.assertEqual([name for name in decide.layers() if name.endswith("-large")], ["1.9-large", "2.2-large", "1.15-literal-large"])
        self.assertEqual([name for name in decide.layers() if name.endswith("-literal")],
                         ["0.95-literal", "1.05-literal", "1.15-literal", "1.25-literal", "1.5-literal"])
        for name in ("1.5-literal", "1.15-literal-large"):
            self.assertIn(name, decide.layers())
            self.assertEqual(option(decide.layer_options(name), "grain-static-friction"), "0.03")
        self.assertEqual(decide.layer_grains("1.15-literal-large"), 355500)
        self.assertFalse([o for o in decide.layer_options("2.2-large") if "friction" in o])
        self.assertEqual(float(option(decide.layer_options("1.5-literal"), "amplitude")), 0.06)

    def test_decide_lets_grains_of_its_layers_come_to_rest_on_the_plate(self):
        decide = plan.Plan("decide")
        for name in decide.layers():
            self.assertEqual(option(decide.layer_options(name), "contact-time"), "1e-05")
        self.assertFalse([o for o in plan.Plan("medium").layer_options("2.3") if "contact-time" in o])

    def test_decide_has_one_nu_at_three_sizes(self):
        decide = plan.Plan("decide")
        sizes = [option(decide.field_options(name), "nx") for name in decide.fields()
                 if name.startswith("plane-b4-0.001")]
        self.assertEqual(sizes, ["512", "256", "1024"])
        quarter, whole = (decide.job("field", name=name).seconds for name in ("plane-b4-0.001-n256", "plane-b4-0.001"))
        self.assertAlmostEqual(whole / quarter, 4)

    def test_fast_films_last_at_least_the_averaging_time_of_the_phases(self):
        for scale in plan.SCALES:
            if "fast" in plan.Plan(scale).films():
                self.assertGreaterEqual(plan.Plan(scale).film_frames("fast") / 500, 0.4)

    def test_an_unknown_scale_is_refused_by_name(self):
        with self.assertRaisesRegex(ValueError, "unknown scale 'huge'; there are small, medium, decide, full"):
            plan.Plan("huge")


class TheRuns(unittest.TestCase):
    def test_gamma_and_amplitude_agree(self):
        small = plan.Plan("small")
        amplitude = float(option(small.film_options("4.5", "slow1"), "amplitude"))
        self.assertAlmostEqual(amplitude * plan.EXPERIMENT_OMEGA**2, 4.5, places=4)
        for gamma, given in zip(small.layer_gammas(), small.layer["amplitude"]):
            self.assertAlmostEqual(float(option(small.layer_options(gamma), "amplitude")), given, places=6)

    def test_films_have_the_frame_rates_of_the_laboratory(self):
        period = 0.0125  # s
        self.assertAlmostEqual(1 / (plan.SLOW_EVERY * period), 10)
        self.assertAlmostEqual(1 / (plan.FAST_EVERY * period), 500)

    def test_each_film_begins_where_the_one_before_it_ended(self):
        full = plan.Plan("full")
        self.assertIsNone(full.film_before("4.5", "slow1"))
        self.assertEqual(full.film_before("4.5", "slow2"), "slow1")
        self.assertEqual(full.film_before("4.5", "fast"), "slow2")
        self.assertEqual(option(full.film_options("4.5", "fast"), "discard"), "0")

    def test_a_fast_film_beside_a_long_run_begins_where_that_ended(self):
        decide = plan.Plan("decide")
        self.assertEqual(decide.film_before("4.7", "fast"), "long")
        self.assertEqual(option(decide.film_options("4.7", "fast"), "discard"), "0")
        self.assertEqual(decide.previews("4.7", "fast"), 20)

    def test_only_long_layers_and_full_leave_the_range_of_the_fit_of_particles_to_the_pre_peak(self):
        by_pre_peak = {(scale, system) for scale in plan.SCALES for system in ("experiment", "layer")
                       if not any(option.startswith("--fit-k-max=") for option in plan.Plan(scale).particle_fit_options(system))}
        self.assertEqual(by_pre_peak, {("full", "experiment"), ("full", "layer"), ("decide", "layer")})

    def test_long_runs_are_fitted_with_plane_waves_and_with_the_modes_between_walls(self):
        decide = plan.Plan("decide")
        self.assertEqual(decide.kinds("long"), ("true", "box"))
        self.assertIn("--modes=plane-waves", decide.particle_fit_options("experiment", "true"))
        self.assertNotIn("--modes=plane-waves", decide.particle_fit_options("experiment", "box"))

    def test_only_films_are_fitted_with_plane_waves_between_walls(self):
        full = plan.Plan("full")
        self.assertEqual(full.particle_fit_options("experiment"), ["--modes=plane-waves"])
        self.assertEqual(full.particle_fit_options("layer"), [])

    def test_all_names_differ(self):
        for scale in plan.SCALES:
            p = plan.Plan(scale)
            for names in (p.gammas(), p.layers(), p.fields()):
                self.assertEqual(len(names), len(set(names)), scale)


def reproduce(*words, **environment):
    return subprocess.run([ROOT / "scripts/reproduce-paper", *words], capture_output=True, text=True,
                          env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **environment})


class TheScript(unittest.TestCase):
    def test_says_what_is_wrong_with_its_words(self):
        for words, text in [((), "--scale small, medium, decide or full"), (("--scale", "huge"), "'huge'"),
                            (("--scale",), "needs a value"), (("--sale", "small"), "'--sale'"),
                            (("--scale", "small", "--cores", "two"), "'two'")]:
            outcome = reproduce(*words)
            self.assertEqual(outcome.returncode, 2, words)
            self.assertIn(text, outcome.stderr)

    @unittest.skipUnless(shutil.which("snakemake"), "no snakemake here (Debian: apt-get install snakemake)")
    def test_dry_run_prints_the_hours_and_plans_every_panel(self):
        for scale in plan.SCALES:
            p = plan.Plan(scale)
            with tempfile.TemporaryDirectory() as folder:
                outcome = reproduce("--scale", scale, "--cores", "2", "--output", folder, "--dry-run")
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            self.assertIn("expected on 2 cores", outcome.stdout)
            text = outcome.stdout + outcome.stderr
            cells = len(p.runs())
            films = sum(film != "long" for _, film in p.runs())
            for rule, count in [("cell", cells), ("film", films), ("track", films),
                                ("analyze_film", 2 * cells), ("layer", len(p.layers())),
                                ("analyze_layer", len(p.layers())), ("field", len(p.fields())),
                                ("analyze_field", len(p.fields())), ("critical", 6), ("report", 1)]:
                self.assertRegex(text, rf"(?m)^{rule}\s+{count}\b", scale)

    @unittest.skipUnless(shutil.which("snakemake"), "no snakemake here (Debian: apt-get install snakemake)")
    def test_what_is_there_is_not_made_again(self):
        p = plan.Plan("small")
        with tempfile.TemporaryDirectory() as folder:
            for gamma in p.layer_gammas():
                for name in (f"md/layer-{gamma}.h5", f"results/layer-{gamma}.h5"):
                    path = pathlib.Path(folder, name)
                    path.parent.mkdir(exist_ok=True)
                    path.write_text("made before")
            outcome = reproduce("--scale", "small", "--cores", "2", "--output", folder, "--dry-run")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertNotRegex(outcome.stdout + outcome.stderr, r"(?m)^(layer|analyze_layer)\s")


if __name__ == "__main__":
    unittest.main()
