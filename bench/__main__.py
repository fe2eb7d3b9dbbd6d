"""Print the table of ratios. Exit code 1 only with `--check`, where a ratio is above its limit."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from bench import (
    attaching,
    binding,
    cluster,
    commands,
    copying,
    drawing,
    editing,
    growth,
    many,
    memory,
    opening,
    pairs,
    process,
    single,
    texts,
    typing,
    viewing,
    worlds,
)
from bench.row import table
from bench.scratch import in_scratch_folder


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench", description="Ratios to peers, of one run.")
    parser.add_argument("--json", type=Path, metavar="OUT", help="also write the rows to this file")
    parser.add_argument("--check", action="store_true", help="exit with 1 where a ratio is above its limit")
    arguments = parser.parse_args()
    out = arguments.json and arguments.json.absolute()
    benches = (
        attaching,
        pairs,
        copying,
        texts,
        binding,
        editing,
        drawing,
        process,
        single,
        opening,
        many,
        cluster,
        worlds,
        growth,
        commands,
        memory,
        viewing,
        typing,
    )
    with in_scratch_folder():
        rows = [row for each in benches for row in each.rows()]
    sys.stdout.write(table(rows) + "\n")
    if out is not None:
        out.write_text(json.dumps([{**asdict(row), "ok": row.ok} for row in rows], indent=2) + "\n")
    return 1 if arguments.check and any(row.ok is False for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
