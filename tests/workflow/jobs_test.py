"""What jobs take, what is asked for them, and that every rule asks for it.

    jobs_test.py REPOSITORY
"""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else __file__).resolve()
if ROOT.name == "jobs_test.py":
    ROOT = ROOT.parents[2]
sys.path.insert(0, str(ROOT / "workflow"))

import jobs  # noqa: E402
import plan  # noqa: E402


class WhatAJobTakes(unittest.TestCase):
    def test_seconds_are_those_measured_within_a_factor_of_two(self):
        # bench/results: 3,000 frames of 8,927 spheres in 119 s on two threads were single discs; a thick layer of 11,700
        # takes 0.6 to 1.2 s a frame. The field's 1.5e6 steps of 512 x 512 cells took 0.82 h.
        for seconds, low, high in [(jobs.track(1, 11700, 1600**2).seconds, 0.6, 1.2),
                                   (jobs.simulate_field(512**2, 1.5e6, 2).seconds, 0.41 * 3600, 1.64 * 3600)]:
            self.assertGreater(seconds, low)
            self.assertLess(seconds, high)

    def test_memory_asked_for_holds_what_was_measured(self):
        # Largest resident sets in bench/results [MB].
        for job, measured in [(jobs.simulate_md(355500, 4, walls=False), 116), (jobs.simulate_md(9875, 200, walls=False), 54),
                              (jobs.render(1, 1600**2, 5), 189), (jobs.track(3000, 8927, 1600**2), 377),
                              (jobs.simulate_field(512**2, 1, 2), 100), (jobs.analyze(3000, 11704), 560)]:
            self.assertGreaterEqual(job.mem_mb(), 1.2 * measured)
            self.assertLess(job.megabytes, 2 * measured)

    def test_work_grows_with_each_number(self):
        for work, numbers in [(lambda g, p: jobs.simulate_md(g, p, walls=True), (1000, 50)),
                              (lambda s, t: jobs.simulate_field(s, t, 1), (512, 1000)), (jobs.render, (30, 250000, 3)),
                              (lambda f, s: jobs.track(f, s, 1), (30, 900)), (jobs.analyze, (30, 900))]:
            once = work(*numbers).seconds
            for i in range(len(numbers)):
                more = [n * (2 if k == i else 1) for k, n in enumerate(numbers)]
                self.assertGreater(work(*more).seconds, 1.4 * once)
                self.assertLess(work(*more).seconds, 2.1 * once)

    def test_motion_is_what_takes_memory(self):
        self.assertAlmostEqual(jobs.analyze(3000, 11704).megabytes - jobs.analyze(3000, 11704, motion=False).megabytes,
                               3000 * 11704 * 16 / 1e6)

    def test_a_second_thread_shortens_and_a_third_is_not_counted_on(self):
        job = jobs.track(3000, 11704, 1600**2)
        self.assertLess(job.clock(2), job.clock(1))
        self.assertEqual(job.clock(8), job.clock(2))
        small = jobs.simulate_md(11704, 1000, walls=True)
        self.assertEqual(small.clock(2), small.clock(1), "a small cell is one strip")

    def test_time_and_memory_double_with_each_attempt(self):
        job = jobs.track(3000, 11704, 1600**2)
        for attempt in (1, 2, 3):
            self.assertAlmostEqual(job.minutes(2, attempt + 1) / job.minutes(2, attempt), 2, delta=0.02)
            self.assertAlmostEqual(job.mem_mb(attempt + 1) / job.mem_mb(attempt), 2, delta=0.02)
        self.assertGreaterEqual(job.minutes(1) * 60, jobs.ROOM_OF_TIME * job.seconds)
        self.assertEqual(jobs.Job(0, 0).minutes(), jobs.LEAST_MINUTES)
        self.assertEqual(jobs.Job(0, 0).mem_mb(), jobs.LEAST_MB)


class TheRules(unittest.TestCase):
    def setUp(self):
        self.rules = {}
        for name in ("series.smk", "Snakefile"):
            text = (ROOT / "workflow" / name).read_text(encoding="utf-8")
            local = re.search(r"(?m)^localrules:\n((?:    \w+,\n)+)", text)[1].replace(",", " ").split()
            for rule, body in re.findall(r"(?ms)^rule (\w+):\n(.*?)(?=^\S|\Z)", text):
                self.rules[name, rule] = (body, rule in local)

    def test_every_rule_that_is_not_local_says_what_it_takes(self):
        self.assertEqual(sum(not local for _, local in self.rules.values()), 10)
        for name, (body, local) in self.rules.items():
            for word in ("mem_mb=", "runtime="):
                self.assertEqual(word in body, not local, name)

    def test_every_long_rule_is_tried_again_and_goes_on_from_its_checkpoint(self):
        for name, (body, local) in self.rules.items():
            if re.search(r"\{PROGRAM\} (track|simulate)", body):
                self.assertIn("--resume", body, name)
                self.assertIn("retries: 2", body, name)
            elif not local:
                self.assertRegex(body, "retries: 2|group:", name)

    def test_short_jobs_are_grouped_and_the_profile_says_how_many(self):
        grouped = [name for name, (body, _) in self.rules.items() if re.search(r'group:\s+"analyze"', body)]
        self.assertEqual([rule for _, rule in grouped], ["analyze", "analyze_film", "analyze_layer", "analyze_field"])
        self.assertIn('"analyze=8"', (ROOT / "workflow/profiles/slurm/config.yaml").read_text())
        full = plan.Plan("full")
        for _, rule, wildcards in full.jobs():
            if rule.startswith("analyze"):
                self.assertLess(full.job(rule, **wildcards).seconds, 300, rule)


if __name__ == "__main__":
    unittest.main()
