# SPDX-License-Identifier: Apache-2.0
"""What a run tells: a progress line, and a CSV table that a resumed run goes on with."""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import TextIO


class Progress:
    """One line that is rewritten on a terminal; elsewhere only reports are printed."""

    def __init__(self, stream: TextIO = sys.stdout):
        self.stream = stream
        self._width = 0

    def update(self, text: str) -> None:
        if self.stream.isatty():
            self.stream.write("\r" + text.ljust(self._width))
            self.stream.flush()
            self._width = len(text)

    def report(self, text: str) -> None:
        start = "\r" if self._width else ""
        self.stream.write(start + text.ljust(self._width) + "\n")
        self.stream.flush()
        self._width = 0


class CsvLog:
    """Rows of named figures, the step first; rows past the step that a run resumes from go."""

    def __init__(self, path: Path, first_step: int):
        self.path = path
        self._rows: list[dict[str, str]] = []
        if path.exists():
            with path.open(newline="") as file:
                rows = list(csv.DictReader(file))
            if rows and "step" not in rows[0]:
                raise SystemExit(f"{path}: no log of a training run; move it away")
            self._rows = [r for r in rows if int(r["step"]) <= first_step]
            self._write_all()

    def _write_all(self) -> None:
        part = self.path.with_suffix(".part")
        with part.open("w", newline="") as file:
            if self._rows:
                writer = csv.DictWriter(file, list(self._rows[0]))
                writer.writeheader()
                writer.writerows(self._rows)
        part.rename(self.path)

    def add(self, row: dict[str, float]) -> None:
        texts = {name: f"{value:.6g}" for name, value in row.items()}
        if self._rows and list(texts) != list(self._rows[0]):
            raise SystemExit(f"{self.path}: has other columns than this run; use another folder")
        self._rows.append(texts)
        if len(self._rows) == 1:
            self._write_all()
            return
        with self.path.open("a", newline="") as file:
            csv.DictWriter(file, list(texts)).writerow(texts)
