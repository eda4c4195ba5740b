#!/usr/bin/env python3
"""Drives one value of a valid scene after the other to the ends of its range and beyond, through plan and fast.

    tests/fuzz/ends_of_ranges.py TOUCHSTONE [--every N] [--offset K] [SCENE ...]

TOUCHSTONE is a touchstone or touchstone-fast that prints the table of keys (`--scene-reference`). Each run must end with
exit status 0 and numbers that are finite, or null with a reason; or with exit status 2 and messages that give file and
line, or --set, and what was expected; within 10 seconds and 1 GiB. With --every N only each N-th run is made, from the
K-th on.
"""
import argparse
import csv
import json
import math
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

SECONDS_MAX, BYTES_MAX = 10.0, 1 << 30
root = pathlib.Path(__file__).resolve().parents[2]


def keys_of(program):
    """Key and text of its range, of every key that takes numbers or words."""
    table = subprocess.run([program, "--scene-reference"], capture_output=True, text=True, check=True).stdout
    for line in table.splitlines():
        found = re.match(r"\| `([^`]+)` \| ([^|]+) \|", line)
        if found:
            yield found[1], found[2].strip()


def ends(text):
    """Numbers at, just inside, just outside and far from the ends of "a number in (0, 1e+13] Pa"."""
    found = re.search(r"[\[(]([-+.e\d]+), ([-+.e\d]+)[\])]", text)
    values = [0.0, -0.0, 1e-300, -1e-300, 5e-324, 1e300, -1e300, math.nan, math.inf]
    if found:
        low, high = float(found[1]), float(found[2])
        values += [low, high, math.nextafter(low, high), math.nextafter(high, low), math.nextafter(low, -math.inf),
                   math.nextafter(high, math.inf), 0.5 * (low + high)]
        if low >= 0.0:
            values.append(math.sqrt(max(low, 1e-12 * high) * high))
    return values


def toml(value):
    return repr(value) if math.isfinite(value) else str(value)


def settings(key, text):
    """TOML values to try for a key."""
    words = re.findall(r'"([^"]+)"', text)
    if words:
        return [f'"{word}"' for word in words] + ['""', '"none"', "1", "true", '"' + "x" * 5000 + '"']
    whole = "whole number" in text
    numbers = [toml(int(v)) if whole and math.isfinite(v) and abs(v) < 1e18 else toml(v) for v in ends(text)]
    numbers = list(dict.fromkeys(numbers))
    if text.startswith("three numbers"):
        return [f"[{n}, {n}, {n}]" for n in numbers] + [f"[0.01, 0.01, {n}]" for n in numbers] + ["[]", "[1.0]"]
    if text.startswith("four numbers"):
        return [f"[{n}, 0.0, 0.0, 0.0]" for n in numbers] + [f"[{n}, {n}, {n}, {n}]" for n in numbers]
    if "list" in text or "pairs" in text:
        return [f"[{n}]" for n in numbers] + [f"[[{n}, {n}]]" for n in numbers] + ["[]"]
    return numbers + ['"text"', "[]", "true"]


def numbers_are_fit(folder):
    """A fault in the numbers of a result folder, or nothing."""
    summary = json.loads((folder / "summary.json").read_text())
    reasons = summary.pop("reasons", {})
    summary.pop("units")
    for name, value in summary.items():
        if value is None and name not in reasons:
            return f"{name} is null without a reason"
        if isinstance(value, float) and not math.isfinite(value):
            return f"{name} = {value}"
    with open(folder / "curve.csv", newline="") as stream:
        rows = list(csv.reader(stream))
    for row in rows[1:]:
        for name, value in zip(rows[0], row):
            if not math.isfinite(float(value)):
                return f"{name} = {value} in curve.csv"
    return ""


def finding(program, verb, scene, setting, folder):
    """Runs the program. @returns the fault, or nothing"""
    command = [program, verb, scene, "--set", setting] + (["--quiet", "--out", folder] if verb == "fast" else [])
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (4 * BYTES_MAX, 4 * BYTES_MAX))  # noqa: E731
    begin = time.monotonic()
    run = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                           errors="backslashreplace", preexec_fn=limit)
    try:
        said, _ = run.communicate(timeout=3 * SECONDS_MAX)
    except subprocess.TimeoutExpired:
        run.kill()
        run.communicate()
        return f"no end within {3 * SECONDS_MAX:g} s"
    seconds = time.monotonic() - begin
    # The maximum of all runs so far, so the first one above the limit is reported.
    largest = 1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    if largest > BYTES_MAX and largest > finding.largest:
        finding.largest = largest
        return f"{largest / 2**20:.0f} MiB"
    if run.returncode == 0:
        if seconds > SECONDS_MAX:
            return f"{seconds:.1f} s"
        return numbers_are_fit(folder) if verb == "fast" else ""
    if run.returncode != 2:
        return f"exit status {run.returncode}: {said[-400:]}"
    for line in said.splitlines():
        if line.startswith("warning: "):
            continue
        told = any(words in line for words in ("expected", "did you mean", "only applies with"))
        if not told or not re.match(r"(--set|[^:]+(:\d+){0,2}): ", line):
            return "a message without its place or what was expected: " + line[:400]
    return "" if said else "exit status 2 without a word"


finding.largest = 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--offset", type=int, default=0)
    parser.add_argument("scenes", nargs="*", default=["ball-on-cube-press", "ball-on-cube-slide", "compass-two-pins",
                                                      "ellipsoid-pvc-inside", "mallet-tail-on-cube", "pin-on-cylinder",
                                                      "sphere-on-sphere-body"])
    given = parser.parse_args()
    runs = [(verb, root / "meshes/scenes" / f"{scene}.toml", f"{key}={value}")
            for scene in given.scenes for key, text in keys_of(given.program) for value in settings(key, text)
            for verb in ("plan", "fast")]
    runs = runs[given.offset::given.every]
    found = accepted = 0
    with tempfile.TemporaryDirectory() as holder:
        for number, (verb, scene, setting) in enumerate(runs):
            folder = pathlib.Path(holder) / f"{number}"
            what = finding(given.program.resolve(), verb, scene, setting, folder)
            accepted += folder.exists()
            if what:
                found += 1
                print(f"{verb} {scene.name} --set '{setting[:200]}'\n  {what}", flush=True)
            subprocess.run(["rm", "-rf", folder], check=True)
            if sys.stderr.isatty():
                print(f"\r{number + 1} of {len(runs)}", end="", file=sys.stderr)
    print(f"{len(runs)} runs, {accepted} with results, {found} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
