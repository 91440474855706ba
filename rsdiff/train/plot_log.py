#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws learning curves from the log.csv of one or more runs.

  plot_log.py RUN [RUN...] -o curve.png --columns u v epe
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


def read_log(run: Path) -> dict[str, list[float]]:
    """Column name -> values, of a run's folder or its log."""
    path = run / "log.csv" if run.is_dir() else run
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows or "samples" not in rows[0]:
        raise SystemExit(f"{path}: no log of a training run")
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def draw(runs: list[Path], columns: list[str], output: Path) -> None:
    figure, axes = pyplot.subplots(
        1, len(columns), figsize=(4.2 * len(columns), 3.2), squeeze=False, constrained_layout=True
    )
    for run in runs:
        log = read_log(run)
        name = run.name if run.is_dir() else run.parent.name
        for axis, column in zip(axes[0], columns):
            if column in log:
                axis.plot([n / 1e6 for n in log["samples"]], log[column], label=name, linewidth=1.2)
    for axis, column in zip(axes[0], columns):
        axis.set_xlabel("samples, millions")
        axis.set_title(column)
        axis.grid(alpha=0.3)
    if len(runs) > 1:
        axes[0][0].legend(fontsize="small")
    figure.savefig(output, dpi=120)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", type=Path, nargs="+", help="folders of runs, or their log.csv")
    parser.add_argument("-o", "--output", type=Path, required=True, help="picture to write")
    parser.add_argument("--columns", nargs="+", default=["total", "u", "v", "epe"])
    args = parser.parse_args()
    draw(args.runs, args.columns, args.output)


if __name__ == "__main__":
    main()
