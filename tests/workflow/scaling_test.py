"""The simulated cluster of bench/workflow/scaling.py against graphs whose times are known.

    scaling_test.py REPOSITORY
"""

import importlib.util
import pathlib
import random
import shutil
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else __file__).resolve()
if ROOT.name == "scaling_test.py":
    ROOT = ROOT.parents[2]
spec = importlib.util.spec_from_file_location("scaling", ROOT / "bench/workflow/scaling.py")
scaling = importlib.util.module_from_spec(spec)
spec.loader.exec_module(scaling)


def job(seconds, cores=1, needs=()):
    return scaling.Job("", "", seconds, cores, tuple(needs))


def at_once(jobs, nodes, **options):
    """On a scheduler that takes no time."""
    return scaling.simulate(jobs, nodes, start=0, sweep=0, **options)


class TheCluster(unittest.TestCase):
    def test_a_chain_takes_the_sum_on_any_number_of_nodes(self):
        chain = [job(3), job(4, needs=[0]), job(5, needs=[1])]
        for nodes in (1, 10, 1000):
            self.assertEqual(at_once(chain, nodes), 12)
        self.assertEqual(scaling.critical_path(chain), [0, 1, 2])

    def test_jobs_apart_fill_the_cores(self):
        jobs = [job(10) for _ in range(8)]
        self.assertEqual([at_once(jobs, nodes) for nodes in (1, 2, 4, 8)], [40, 20, 10, 10])

    def test_a_job_of_two_cores_waits_for_a_whole_node(self):
        # Each node has one core free after 2 s, so the wide job begins when both jobs of one node have ended.
        self.assertEqual(at_once([job(2), job(6), job(1, cores=2)], 1), 7)
        self.assertEqual(at_once([job(4, cores=2), job(4, cores=2)], 1), 8)

    def test_no_more_jobs_are_in_flight_than_allowed(self):
        self.assertEqual(at_once([job(10) for _ in range(6)], 100, in_flight=2), 30)

    def test_local_jobs_run_one_after_another_and_take_no_node(self):
        self.assertEqual(at_once([job(5, cores=0), job(5, cores=0), job(8), job(8)], 1), 10)

    def test_the_scheduler_costs_its_time_once_a_job_of_a_chain(self):
        chain = [job(100), job(100, needs=[0])]
        self.assertAlmostEqual(scaling.simulate(chain, 1, start=5, sweep=10, checks=5), 2 * (5 + 100 + (10 + 1 / 5) / 2))

    def test_any_graph_is_between_its_bounds(self):
        # Graham: no list scheduling of one-core jobs takes longer than work over cores and the longest chain together.
        draw = random.Random(1)
        for _ in range(50):
            jobs = [job(draw.uniform(1, 9), needs=draw.sample(range(i), min(i, draw.randrange(3)))) for i in range(40)]
            chain = sum(jobs[i].seconds for i in scaling.critical_path(jobs))
            for nodes in (1, 2, 5):
                cores = scaling.work(jobs) / (2 * nodes)
                took = at_once(jobs, nodes)
                self.assertGreaterEqual(took, max(chain, cores) - 1e-9)
                self.assertLessEqual(took, chain + cores + 1e-9)

    def test_copies_side_by_side_on_as_many_nodes_take_as_long(self):
        jobs = [job(3), job(4, needs=[0]), job(2)]
        self.assertEqual(at_once(scaling.copies(jobs, 7), 7), at_once(jobs, 1))

    def test_a_circle_is_refused(self):
        circle = [job(1, needs=[1]), job(1, needs=[0])]
        self.assertRaisesRegex(ValueError, "circle", scaling.simulate, circle, 1)
        self.assertRaisesRegex(ValueError, "circle", scaling.critical_path, circle)


class TheGraph(unittest.TestCase):
    def test_jobs_are_read_as_snakemake_prints_them(self):
        text = ("[Mon Jan  1]\nrule track:\n    input: films/a.mkv, b.txt\n    output: tracks/a.h5\n    jobid: 3\n"
                "    wildcards: gamma=2.5, film=slow1\n    threads: 2\n    resources: mem_mb=868, runtime=175\n\n"
                "localrule report:\n    input: tracks/a.h5\n    output: report.html\n    jobid: 0\n\n")
        self.assertEqual(scaling.parse_dry_run(text), [
            ("track", {"gamma": "2.5", "film": "slow1"}, ["films/a.mkv", "b.txt"], ["tracks/a.h5"], 2),
            ("report", {}, ["tracks/a.h5"], ["report.html"], 1)])

    @unittest.skipUnless(shutil.which("snakemake"), "no snakemake here (Debian: apt-get install snakemake)")
    def test_the_graph_of_the_series_is_its_plan(self):
        plan = scaling.planned.Plan("full")
        jobs = scaling.graph("full", 2)
        self.assertEqual(len(jobs), sum(1 for _ in plan.jobs()) + len(plan.fields()) + 6 + 1)
        one = [job for job in jobs if job.cores]
        self.assertEqual({job.cores for job in one if job.rule in ("track", "layer")}, {2})
        self.assertEqual({job.cores for job in one if job.rule in ("cell", "film")}, {1})
        rules = [jobs[i].rule for i in scaling.critical_path(jobs)]
        self.assertEqual(rules[-5:-1], ["cell", "film", "track", "analyze_film"])


if __name__ == "__main__":
    unittest.main()
