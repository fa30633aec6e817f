#!/usr/bin/env python3
"""Runs the commands that the pages show: every line in a code block that begins with `miebrdf `.

Usage: run_commands.py PROGRAM [--long] [--times] [PAGE...]

The commands of one page run in order in a folder of their own, in which docs/ and tools/ of the
sources are to be found; a `\\` at the end of a line continues it. A comment before a block says
what is not run, and why:

    <!-- not run: needs files of the reader's own -->
    <!-- long: about 40 s -->            runs only with --long
    <!-- exit 4: not converged -->       ends with this exit code
"""

import argparse
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

import pages

# Limits of processor time: a busy machine is no reason to fail.
LIMIT_S, LONG_LIMIT_S = 60, 1200
MARK = re.compile(r"<!-- (not run|long|exit (\d+)): (.+) -->")


class Command:
    def __init__(self, number, text, mark):
        self.number, self.text = number, text
        self.skip = mark is not None and mark.group(1) == "not run"
        self.long = mark is not None and mark.group(1) == "long"
        self.exit_code = int(mark.group(2)) if mark is not None and mark.group(2) else 0


def blocks_of(page):
    """Lists of (number, line) of code, each with the mark before it."""
    mark, block, kind = None, [], None
    for number, line, fence in pages.lines_of(page):
        is_code = fence in ("sh", "bash", "") if fence is not None else line.startswith("    ")
        now = ("fence" if fence is not None else "indented") if is_code else None
        if block and (now != kind or number != block[-1][0] + 1):
            yield mark, block
            mark, block = None, []
        kind = now
        if is_code:
            block.append((number, line))
        elif fence is None and MARK.fullmatch(line.strip()):
            mark = MARK.fullmatch(line.strip())
        elif line.strip() and fence is None:
            mark = None
    if block:
        yield mark, block


def commands_of(page):
    for mark, block in blocks_of(page):
        lines = iter(block)
        for number, line in lines:
            text = line.strip()
            if not text.startswith("miebrdf "):
                continue
            while text.endswith("\\"):
                text = text[:-1] + next(lines)[1].strip()
            yield Command(number, text, mark)


def run_page(page, commands, program, times):
    """Messages about what went wrong."""
    problems = []
    with tempfile.TemporaryDirectory() as folder:
        for name in ("docs", "tools", "tests", "materials"):
            os.symlink(pages.ROOT / name, pathlib.Path(folder) / name)
        environment = dict(os.environ, HOME=folder, XDG_CACHE_HOME=folder, XDG_DATA_HOME=folder,
                           XDG_CONFIG_HOME=folder,
                           PATH=f"{pathlib.Path(program).resolve().parent}:{os.environ['PATH']}")
        environment.pop("MIEBRDF_DATABASE", None)
        for command in commands:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            limit = LONG_LIMIT_S if command.long else LIMIT_S
            done = subprocess.run(["bash", "-o", "pipefail", "-c",
                                   f"ulimit -t {limit}; {command.text}"],
                                  cwd=folder, env=environment, capture_output=True, text=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            if times:
                print(f"{after.ru_utime - before.ru_utime:7.2f} s  {page}:{command.number}: "
                      f"{command.text[:90]}", flush=True)
            if after.ru_utime - before.ru_utime >= limit:
                problems.append(f"{page}:{command.number}: longer than {limit} s of processor "
                                f"time: {command.text}; mark it as long")
            elif done.returncode != command.exit_code:
                problems.append(f"{page}:{command.number}: exit code {done.returncode}: "
                                f"{command.text}\n    {done.stderr.strip()[-400:]}")
    return problems


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--times", action="store_true")
    parser.add_argument("--render", action="store_true", help="the program has `render`")
    parser.add_argument("pages", nargs="*")
    arguments = parser.parse_intermixed_args()
    count = skipped = 0
    problems = []
    for page in pages.pages():
        name = str(page.relative_to(pages.ROOT))
        if arguments.pages and name not in arguments.pages:
            continue
        commands = list(commands_of(page))
        if not arguments.render:
            for command in commands:
                command.skip |= "miebrdf render --" in command.text and "--help" not in command.text
        wanted = [c for c in commands if not c.skip and (arguments.long or not c.long)]
        count += len(wanted)
        skipped += len(commands) - len(wanted)
        problems += run_page(name, wanted, arguments.program, arguments.times)
    print("\n".join(problems))
    print(f"{count} commands run, {skipped} marked as not run here, {len(problems)} problems")
    if count < 20 and not arguments.pages:
        sys.exit("far too few commands: are the pages where they should be?")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
