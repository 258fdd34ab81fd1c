#!/usr/bin/env python3
"""How the work grows over cores and nodes: measured on this machine, simulated for many.

usage: bench/workflow/scaling.py simulate [--scale full] [--plot FILE.svg]
       bench/workflow/scaling.py measure PROGRAM [--rounds N] [--frames N]

simulate: the job graph of the paper's series as Snakemake itself prints it, with the time of each job from the measured
rates (workflow/jobs.py), on nodes of two cores under Slurm. Jobs start in the order in which they become ready, wherever
cores are free. Snakemake has at most as many jobs in flight as the profile says, and sees an end when it asks next.
measure: tracking, molecular dynamics and the field model on one and on two cores. Strong: the same work with one thread
and with two. Weak: one process of one thread alone, and two of them side by side. Times by the clock, medians of the rounds.
"""
import argparse
import heapq
import itertools
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "workflow"))

import plan as planned  # noqa: E402

CORES_A_NODE = 2
START = 5.0  # s until a job works: Slurm, and the Snakemake in it
SWEEP = 10.0  # s between two rounds of asking for the states of all jobs
CHECKS_A_SECOND = 5  # max-status-checks-per-second of the profile
IN_FLIGHT = 1000  # jobs of the profile
LOCAL_SECONDS = 30.0  # of critical and report, on the machine that runs Snakemake


class Job(NamedTuple):
    name: str
    rule: str
    seconds: float
    cores: int  # 0: on the machine that runs Snakemake
    needs: tuple  # indices of jobs


def parse_dry_run(text):
    """(rule, wildcards, inputs, outputs, threads) of each job that `snakemake --dry-run` prints."""
    found = []
    for rule, body in re.findall(r"(?m)^(?:local)?rule (\w+):\n((?:    .*\n)+)", text):
        lines = dict(re.findall(r"(?m)^    (\w+): (.*)$", body))
        files = [lines.get(kind, "").split(", ") if lines.get(kind) else [] for kind in ("input", "output")]
        wildcards = dict(word.split("=", 1) for word in lines["wildcards"].split(", ")) if "wildcards" in lines else {}
        found.append((rule, wildcards, *files, int(lines.get("threads", 1))))
    return found


def graph(scale, threads):
    """The jobs of the paper's series with so many threads where they help."""
    plan = planned.Plan(scale)
    with tempfile.TemporaryDirectory() as folder:
        output = subprocess.run(
            ["snakemake", "--dry-run", "--cores", str(CORES_A_NODE), "--snakefile", str(ROOT / "workflow/Snakefile"),
             "--directory", folder, "--config", f"scale={scale}", f"simulation_threads={threads}",
             f"track_threads={threads}"],
            capture_output=True, text=True, check=True, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
    found = [job for job in parse_dry_run(output.stdout + output.stderr) if job[0] != "all"]
    maker = {file: i for i, job in enumerate(found) for file in job[3]}
    jobs = []
    for rule, wildcards, inputs, _, used in found:
        costs = plan.job(rule, **wildcards) if rule not in ("critical", "report") else None
        jobs.append(Job(f"{rule} {' '.join(wildcards.values())}".strip(), rule,
                        costs.clock(used) if costs else LOCAL_SECONDS, used if costs else 0,
                        tuple(maker[file] for file in inputs if file in maker)))
    return jobs


def copies(jobs, count):
    """The graph so many times side by side: a series of more films."""
    return [job._replace(needs=tuple(need + copy * len(jobs) for need in job.needs))
            for copy in range(count) for job in jobs]


def critical_path(jobs):
    """Indices of the longest chain, without waiting."""
    end, before, order = {}, {}, []
    left = [len(job.needs) for job in jobs]
    after = [[] for _ in jobs]
    for i, job in enumerate(jobs):
        for need in job.needs:
            after[need].append(i)
    ready = [i for i, count in enumerate(left) if count == 0]
    while ready:
        i = ready.pop()
        order.append(i)
        before[i] = max(jobs[i].needs, key=lambda need: end[need], default=None)
        end[i] = jobs[i].seconds + (end[before[i]] if before[i] is not None else 0)
        for j in after[i]:
            left[j] -= 1
            if left[j] == 0:
                ready.append(j)
    if len(order) < len(jobs):
        raise ValueError("the graph has a circle")
    chain, i = [], max(end, key=end.get)
    while i is not None:
        chain.append(i)
        i = before[i]
    return chain[::-1]


def simulate(jobs, nodes, in_flight=IN_FLIGHT, start=START, sweep=SWEEP, checks=CHECKS_A_SECOND):
    """Seconds by the clock until the last job has ended and has been seen to have.

    Jobs of several cores are not spread over nodes. `start`, `sweep`: 0 for a scheduler that takes no time.
    """
    after = [[] for _ in jobs]
    left = [len(job.needs) for job in jobs]
    for i, job in enumerate(jobs):
        for need in job.needs:
            after[need].append(i)
    number = itertools.count()
    ready = [(0.0, next(number), i) for i, count in enumerate(left) if count == 0]
    heapq.heapify(ready)
    free = [{} for _ in range(CORES_A_NODE + 1)]  # nodes by the number of their free cores
    free[CORES_A_NODE] = dict.fromkeys(range(nodes))
    place = {}  # of a job
    events, running, now = [], 0, 0.0  # (time, order, job, it ends: True, or its end is seen: False)
    waiting = {cores: [] for cores in range(CORES_A_NODE + 1)}  # ready ones, by the cores they take; 0: local
    local_busy = 0
    while ready or events or any(waiting.values()):
        while ready and ready[0][0] <= now:
            _, order, i = heapq.heappop(ready)
            heapq.heappush(waiting[jobs[i].cores], (order, i))
        while True:
            candidates = []
            for cores, queue in waiting.items():
                fits = local_busy == 0 if cores == 0 else running < in_flight and any(free[f] for f in range(cores, len(free)))
                if queue and fits:
                    candidates.append((queue[0][0], cores))
            if not candidates:
                break
            _, cores = min(candidates)
            _, i = heapq.heappop(waiting[cores])
            if cores == 0:
                local_busy = 1
                heapq.heappush(events, (now + jobs[i].seconds, next(number), i, False))
                continue
            running += 1
            had = next(f for f in range(cores, len(free)) if free[f])  # the fullest node that has room
            place[i], _ = free[had].popitem()
            free[had - cores][place[i]] = None
            heapq.heappush(events, (now + start + jobs[i].seconds, next(number), i, True))
        now = min([event[0] for event in events[:1]] + [r[0] for r in ready[:1]])
        while events and events[0][0] <= now:
            _, _, i, ended = heapq.heappop(events)
            if ended:
                node = place.pop(i)
                had = next(f for f, some in enumerate(free) if node in some)
                del free[had][node]
                free[had + jobs[i].cores][node] = None
                seen = (sweep + running / checks) / 2 if sweep else 0.0
                heapq.heappush(events, (now + seen, next(number), i, False))
                continue
            if jobs[i].cores == 0:
                local_busy = 0
            else:
                running -= 1
            for j in after[i]:
                left[j] -= 1
                if left[j] == 0:
                    heapq.heappush(ready, (now, next(number), j))
    if any(left):
        raise ValueError("the graph has a circle")
    return now


def work(jobs):
    """Core seconds."""
    return sum(job.seconds * job.cores for job in jobs)


def bound(jobs, nodes, seconds):
    """What keeps it from being faster: the cores, or the longest chain, whichever would take longer alone."""
    chain = sum(jobs[i].seconds for i in critical_path(jobs))
    cores = work(jobs) / (nodes * CORES_A_NODE)
    return ("the cores" if cores > chain else "the longest chain"), max(cores, chain) / seconds


def hours(seconds):
    return f"{seconds / 3600:.2f} h" if seconds < 36000 else f"{seconds / 3600:.1f} h"


def show_simulation(scale, plot):
    counts = (1, 10, 100, 1000)
    graphs = {threads: graph(scale, threads) for threads in (1, 2)}
    one = graphs[1]
    print(f"{len(one)} jobs of the series at {scale}, {work(one) / 3600:.1f} h of one core.\n")
    print("| stage | jobs | hours of one core | longest job |\n| --- | --- | --- | --- |")
    rules = {}
    for job in one:
        rules.setdefault(job.rule, []).append(job.seconds)
    for rule, seconds in rules.items():
        print(f"| {rule} | {len(seconds)} | {sum(seconds) / 3600:.2f} | {max(seconds) / 60:.0f} min |")
    print("\nStrong: the same series.\n")
    print("| nodes of two cores | one thread a job | two where they help | bound (of the faster) | share of it | "
          "cores at work |\n| --- | --- | --- | --- | --- | --- |")
    strong = {threads: [simulate(jobs, nodes) for nodes in counts] for threads, jobs in graphs.items()}
    for k, nodes in enumerate(counts):
        best = min(strong, key=lambda threads: strong[threads][k])
        what, share = bound(graphs[best], nodes, strong[best][k])
        busy = work(one) / (nodes * CORES_A_NODE * strong[best][k])
        print(f"| {nodes} | {hours(strong[1][k])} | {hours(strong[2][k])} | {what} | {100 * share:.0f} % | "
              f"{100 * busy:.1f} % |")
    for threads, jobs in graphs.items():
        chain = critical_path(jobs)
        print(f"\nThe longest chain with {threads} thread{'s' if threads > 1 else ''} a job: "
              f"{hours(sum(jobs[i].seconds for i in chain))}: "
              + ", ".join(f"{jobs[i].name} {jobs[i].seconds / 60:.0f} min" for i in chain))
    print("\nWeak: a series as large for each node, one thread a job.\n")
    print("| nodes | jobs | time | against one node | with as many jobs in flight as there are cores |\n"
          "| --- | --- | --- | --- | --- |")
    weak = []
    for nodes in counts:
        jobs = copies(one, nodes)
        weak.append(simulate(jobs, nodes))
        free = simulate(jobs, nodes, in_flight=nodes * CORES_A_NODE)
        print(f"| {nodes} | {len(jobs)} | {hours(weak[-1])} | {weak[-1] / weak[0]:.2f} | {hours(free)} |")
    if plot:
        draw(plot, scale, graphs)


def draw(path, scale, graphs):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "scaling"
    import matplotlib.pyplot as plt

    counts = [1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 200, 300, 1000]
    figure, axes = plt.subplots(figsize=(6, 4))
    for threads, mark in ((1, "o-"), (2, "s-")):
        jobs = graphs[threads]
        axes.loglog(counts, [simulate(jobs, nodes) / 3600 for nodes in counts], mark, markersize=4,
                    label=f"{threads} thread{'s' if threads > 1 else ''} a job")
        chain = sum(jobs[i].seconds for i in critical_path(jobs)) / 3600
        axes.axhline(chain, linestyle=":", color="gray", linewidth=1)
        axes.annotate(f"longest chain, {threads} thread{'s' if threads > 1 else ''}", (1, chain), (0, 2),
                      textcoords="offset points", fontsize=8, color="gray")
    axes.loglog(counts, [work(graphs[1]) / 3600 / CORES_A_NODE / nodes for nodes in counts], "k--", linewidth=1,
                label="all cores busy")
    axes.set(xlabel="nodes of two cores", ylabel="hours by the clock", title=f"The paper's series ({scale}), simulated",
             ylim=(1, None))
    axes.legend()
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def clock(commands):
    """Seconds until the last of them has ended; they run side by side."""
    begin = time.perf_counter()
    children = [subprocess.Popen([str(word) for word in words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                for words in commands]
    for words, child in zip(commands, children, strict=True):
        _, said = child.communicate()
        if child.returncode != 0:
            raise RuntimeError(f"{' '.join(map(str, words))} ended with {child.returncode}: {said.decode()}")
    return time.perf_counter() - begin


def show_measurement(program, rounds, frames):
    program = pathlib.Path(program).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([program.parent / "make-layer-frames", folder / "film", "--frames", str(frames), "--size", "800"],
                       check=True, stdout=subprocess.DEVNULL)
        film = sorted((folder / "film").glob("*.tif"))
        samples = ROOT / "data-samples"
        work_of = {
            f"track, {frames} frames of 800 x 800 px": ["track", *film, "--sphere-diameter", "12"],
            "simulate md, 142,200 grains": ["simulate", "md", "-c", samples / "md-paper.toml", "--grains=142200",
                                            "--length-x=379.5", "--length-y=379.5", "--periods=1", "--discard=0"],
            "simulate field, 256 x 256": ["simulate", "field", "--nx=256", "--relax=100", "--record=900"],
        }
        load = os.getloadavg()[0]
        print(f"{os.cpu_count()} cores, load average {load:.1f} at the beginning; medians of {rounds} rounds\n")
        print("| work | one core | two threads | strong: gain | two at once, one core each | weak: efficiency |\n"
              "| --- | --- | --- | --- | --- | --- |")
        for what, words in work_of.items():
            def run(threads, copy):
                return [program, *words, "-o", folder / f"{copy}.h5", "--force", "--quiet", "--threads", str(threads)]
            turns = [(clock([run(1, "a")]), clock([run(2, "a")]), clock([run(1, "a"), run(1, "b")]))
                     for _ in range(rounds)]
            alone, strong, weak = (statistics.median(turn[k] for turn in turns) for k in range(3))
            gain = statistics.median(turn[0] / turn[1] for turn in turns)
            efficiency = statistics.median(turn[0] / turn[2] for turn in turns)
            print(f"| {what} | {alone:.2f} s | {strong:.2f} s | {gain:.2f} | {weak:.2f} s | {100 * efficiency:.0f} % |",
                  flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(dest="kind", required=True)
    kind = kinds.add_parser("simulate")
    kind.add_argument("--scale", default="full", choices=planned.SCALES)
    kind.add_argument("--plot", type=pathlib.Path)
    kind = kinds.add_parser("measure")
    kind.add_argument("program")
    kind.add_argument("--rounds", type=int, default=3)
    kind.add_argument("--frames", type=int, default=30)
    given = parser.parse_args()
    if given.kind == "simulate":
        show_simulation(given.scale, given.plot)
    else:
        show_measurement(given.program, given.rounds, given.frames)


if __name__ == "__main__":
    main()
