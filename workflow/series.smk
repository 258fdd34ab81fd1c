# Track, analyse, compare, critical: for each film of a table.
#
#   scripts/run-series table.csv         (see there; --slurm: on a cluster)
#
# workflow/series.py reads the table, workflow/jobs.py says what jobs take. Tracking goes on from its checkpoint when it was
# cut off.

import os
import shlex
import sys

sys.path.insert(0, workflow.basedir)
import series

ROOT = os.path.dirname(workflow.basedir)
PROGRAM = shlex.quote(os.path.join(ROOT, config.get("program", "build/release/grainfield")))
RUNS = {run.name: run for run in series.read_table(config["table"])}
TRACK_THREADS = int(config.get("track_threads", 2))
CRITICAL = ["critical.h5"] if series.has_critical_point(list(RUNS.values())) else []


def run(wildcards):
    return RUNS[wildcards.name]


def words(options):
    return " ".join(shlex.quote(option) for option in options)


wildcard_constraints:
    name="|".join(sorted(map(re.escape, RUNS), key=len, reverse=True)),


localrules:
    all,
    critical,
    report,


rule all:
    input:
        "report.html",


rule track:
    input:
        lambda w: run(w).files,
    output:
        "tracks/{name}.h5",
    params:
        options=lambda w: words(run(w).track),
    log:
        "logs/track-{name}.json",
    benchmark:
        "times/track-{name}.tsv"
    threads: TRACK_THREADS
    retries: 2
    resources:
        mem_mb=lambda w, attempt: run(w).track_job().mem_mb(attempt),
        runtime=lambda w, threads, attempt: run(w).track_job().minutes(threads, attempt),
    shell:
        "{PROGRAM} track {input:q} {params.options} -o {output} "
        "$([ ! -e {output}.checkpoint ] || echo --resume) --force --threads {threads} --json > {log}"


rule analyze:
    input:
        "tracks/{name}.h5",
    output:
        "results/{name}.h5",
    params:
        options=lambda w: words(run(w).analyze_options()),
    log:
        "logs/analyze-{name}.json",
    benchmark:
        "times/analyze-{name}.tsv"
    retries: 2
    # Short jobs: a cluster takes some of them at a time.
    group:
        "analyze"
    resources:
        mem_mb=lambda w, attempt: run(w).analyze_job().mem_mb(attempt),
        runtime=lambda w, threads, attempt: run(w).analyze_job().minutes(threads, attempt),
    shell:
        "{PROGRAM} analyze {input} {params.options} -o {output} --force --threads {threads} --json > {log}"


# Where no run has an S0/S1 (exit code 3) the log says so, and the report is made without it.
rule critical:
    input:
        expand("results/{name}.h5", name=RUNS),
    output:
        "critical.h5",
    params:
        values=",".join(run.gamma for run in RUNS.values()),
    log:
        json="logs/critical.json",
        why="logs/critical.txt",
    shell:
        "{PROGRAM} critical {input} --values {params.values} --parameter Γ -o {output} --force --json > {log.json} "
        "2> {log.why} || {{ code=$?; [ $code -eq 3 ] && : > {output}; }}"


rule report:
    input:
        results=expand("results/{name}.h5", name=RUNS),
        critical=CRITICAL,
    output:
        page="report.html",
        figures=directory("report_files"),
    log:
        "logs/compare.json",
    shell:
        "{PROGRAM} compare {input.results} $(for file in {input.critical}; do [ ! -s $file ] || echo $file; done) "
        "-o {output.page} --force --json > {log}"
