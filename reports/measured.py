"""Common functions of the scripts that write measured tables into a page of reports/."""
import argparse
import json
import pathlib
import sys

root = pathlib.Path(__file__).resolve().parents[1]


def scene_names():
    return sorted(path.stem for path in (root / "meshes/scenes").glob("*.toml"))


def arguments(text, kind, names, out, page, presets=(), **folders):
    """The command line: names of one kind, all of them without any; what follows -- in `passed_on`.

    page: where the tables stand, below reports/. presets: what --preset chooses from, all without any. folders: further options
    with a folder, and where it lies unless told.
    """
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--touchstone", type=pathlib.Path, default=root / "build/release/touchstone")
    parser.add_argument("--store", type=pathlib.Path, default=root / "out/reference-store")
    parser.add_argument("--out", type=pathlib.Path, default=root / out)
    for option, default in folders.items():
        parser.add_argument(f"--{option}", type=pathlib.Path, default=root / default)
    if presets:
        parser.add_argument("--preset", action="append", choices=presets)
    parser.add_argument("--page", type=pathlib.Path, default=root / "reports" / page, help=argparse.SUPPRESS)
    parser.add_argument("--only-read", action="store_true")
    parser.add_argument("names", nargs="*", metavar=kind.upper())
    own, passed_on = sys.argv[1:], []
    if "--" in own:
        at = own.index("--")
        own, passed_on = own[:at], own[at + 1:]
    given = parser.parse_args(own)
    for name in given.names:
        if name not in names:
            parser.error(f"no {kind} {name}; there are {', '.join(names)}")
    if not given.only_read and not given.touchstone.exists():
        sys.exit(f"{given.touchstone} is missing; build it with ./check or name another with --touchstone")
    given.names = given.names or list(names)
    given.passed_on = passed_on
    return given


def read_summary(file):
    """A summary.json as one table; for a number that is null the reason is given."""
    summary = json.loads(file.read_text())
    return summary | summary.pop("reasons", {})


def write_between_marks(page, what, text):
    """Puts the text where the page says <!-- what --> ... <!-- end of what -->."""
    begin, end = f"<!-- {what} -->\n", f"<!-- end of {what} -->\n"
    before, began, rest = page.read_text().partition(begin)
    _, ended, after = rest.partition(end)
    if not began or not ended:
        sys.exit(f"{page}: has no lines {begin.strip()} and {end.strip()}")
    page.write_text(before + begin + text + end + after)
