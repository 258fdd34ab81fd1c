"""Runs the commands of a page of the manual, in their order, and compares what they print.

    pages_test.py PAGE FOLDER_OF_PROGRAMS

Blocks marked sh are run by bash in an empty folder, with $SAMPLES the sample files. Each line of a block marked text must
be in the output of the block before it, whatever its numbers are. A comment "in the test: s/OLD/NEW/" before a block
shortens a long run.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def blocks(page):
    """Triples of language, text and substitutions, as (OLD, NEW)."""
    shorter = []
    for match in re.finditer(r"^<!-- in the test: s/(.+)/(.+)/ -->$|^```(\w+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        old, new, language, text = match.groups()
        if old is not None:
            shorter.append((old, new))
        else:
            yield language, text, shorter
            shorter = []


def shape(line):
    """The line without what may differ: numbers, and how a power of ten is set."""
    line = re.sub(r"[-−]?\d[\d,]*(\.\d+)?(e[-+]?\d+)?", "#", line)
    line = re.sub(r"\(# ± #\) × #[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|# ± #", "#", line)
    return re.sub(r"# × #[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+", "#", line).strip()


def main(page, programs):
    text = pathlib.Path(page).read_text()
    environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}", "SAMPLES": str(ROOT / "data-samples")}
    output, commands = "", 0
    with tempfile.TemporaryDirectory() as folder:
        for language, block, shorter in blocks(text):
            if language == "text":
                printed = {shape(line) for line in output.splitlines()}
                for line in filter(str.strip, block.splitlines()):
                    if shape(line) not in printed:
                        sys.exit(f"{page}: this line is not printed:\n{line}\nbut:\n{output}")
            elif language == "sh":
                for old, new in shorter:
                    if old not in block:
                        sys.exit(f"{page}: '{old}', which the test shortens, is not in\n{block}")
                    block = block.replace(old, new)
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, env=environment,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                output, commands = done.stdout, commands + 1
                if done.returncode != 0:
                    sys.exit(f"{page}: exit code {done.returncode} of\n{block}\n{output}")
    if commands == 0:
        sys.exit(f"{page}: no command was run")


if __name__ == "__main__":
    main(*sys.argv[1:])
