#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Keeps made samples on disk, so that a slow machine need not make each of them again.

A pool is a folder of shards; a shard is a folder of .npy arrays, readable as memory maps.
  sample_pool.py POOL --photos FOLDER --gyro FOLDER --shards 20
Shard k is made from the seed (SEED, k): several processes may share the work (--begin).
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import cv2
import numpy as np

from data_source import add_source_options, open_source
from samples import KINDS, Sample, SampleSource

SHARD_SAMPLES = 10_000
REFERENCE_ROW = "reference_row"  # file of a shard that names it
REFRESH_BATCHES = 500  # after so many, look whether shards were added


def make_shard(source: SampleSource, folder: Path, seed: tuple[int, int], count: int) -> None:
    arrays = source.batch(np.random.default_rng(seed), count)
    part = folder.with_suffix(".part")
    part.mkdir(parents=True, exist_ok=True)
    for name, array in arrays.items():
        np.save(part / f"{name}.npy", array)
    (part / REFERENCE_ROW).write_text(source.reference_row)
    part.rename(folder)


class SamplePool:
    """All shards of a folder as one SampleSource; shards that appear later are found."""

    def __init__(self, folder: Path, kind: str):
        self.folder = folder
        self.names = KINDS[kind]
        self.shards: dict[str, Sample] = {}
        self._batches = 0
        self.refresh()
        if not self.shards:
            raise SystemExit(f"{folder}: no shards; sample_pool.py makes them")
        rows = {(folder / name / REFERENCE_ROW).read_text() for name in self.shards}
        if len(rows) > 1:
            raise SystemExit(f"{folder}: shards of two kinds, zero on the middle and on the first row")
        (self.reference_row,) = rows

    def refresh(self) -> None:
        for path in sorted(self.folder.glob("shard-*")):
            if path.suffix != ".part" and path.name not in self.shards:
                files = {n: path / f"{n}.npy" for n in self.names}
                needed = [*files.values(), path / REFERENCE_ROW]
                missing = [file.name for file in needed if not file.exists()]
                if missing:
                    raise SystemExit(f"{path}: has no {missing[0]}; was it made for this network?")
                self.shards[path.name] = {n: np.load(f, mmap_mode="r") for n, f in files.items()}

    def __len__(self) -> int:
        return sum(len(s["aspect"]) for s in self.shards.values())

    def head(self, count: int) -> Sample:
        """The first samples of the first shard."""
        first = self.shards[min(self.shards)]
        return {name: np.array(array[:count]) for name, array in first.items()}

    def batch(self, rng: np.random.Generator, count: int, blocks: int = 8) -> Sample:
        """`count` samples: runs of neighbours (cheap to read) from `blocks` random places."""
        self._batches += 1
        if self._batches % REFRESH_BATCHES == 0:
            self.refresh()
        names = sorted(self.shards)
        parts = []
        for block in range(min(blocks, count)):
            run = count // blocks + (block < count % blocks)
            shard = self.shards[names[rng.integers(len(names))]]
            first = rng.integers(len(shard["aspect"]) - run + 1)
            parts.append({name: array[first : first + run] for name, array in shard.items()})
        return {name: np.concatenate([p[name] for p in parts]) for name in self.names}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pool", type=Path)
    add_source_options(parser)
    parser.add_argument("--net", choices=list(KINDS), default="compact", help="what they are for")
    parser.add_argument("--begin", type=int, default=0, help="first shard")
    parser.add_argument("--shards", type=int, default=1)
    parser.add_argument("--samples", type=int, default=SHARD_SAMPLES, help="in one shard")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--held-out", action="store_true", help="from what training leaves out")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    source = open_source(args, args.net, args.held_out)
    args.pool.mkdir(parents=True, exist_ok=True)
    for shard in range(args.begin, args.begin + args.shards):
        folder = args.pool / f"shard-{shard:04d}"
        if folder.exists():
            continue
        start = time.monotonic()
        make_shard(source, folder, (args.seed, shard), args.samples)
        print(f"{folder}: {args.samples / (time.monotonic() - start):.0f} samples/s", flush=True)


if __name__ == "__main__":
    main()
