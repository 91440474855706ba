#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Keeps made samples on disk, so that a slow machine need not make each of them again.

A pool is a folder of shards; a shard is a folder of .npy arrays, readable as memory maps.
  sample_pool.py PHOTOS POOL --shards 20 --gyro FOLDER --first-photo 0 --last-photo 1070
Shard k is made from the seed (SEED, k): several processes may share the work (--begin).
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import cv2
import numpy as np

from gyro_logs import read_gyro_folder
from rotation_curve import BANDS, CurveSampler
from synthesis import Synthesizer, load_photos

SHARD_SAMPLES = 10_000
FIELDS = ("planes", "rs_small", "gs_small", "curve", "aspect")


def make_shard(synthesizer: Synthesizer, folder: Path, seed: tuple[int, int], count: int) -> None:
    rng = np.random.default_rng(seed)
    samples = [synthesizer.draw(rng) for _ in range(count)]
    part = folder.with_suffix(".part")
    part.mkdir(parents=True, exist_ok=True)
    for field in FIELDS:
        np.save(part / f"{field}.npy", np.stack([getattr(s, field) for s in samples]))
    part.rename(folder)


class SamplePool:
    """All shards of a folder as one table; shards that appear later are found by refresh()."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.shards: dict[str, dict[str, np.ndarray]] = {}
        self.refresh()

    def refresh(self) -> None:
        for path in sorted(self.folder.glob("shard-*")):
            if path.suffix != ".part" and path.name not in self.shards:
                self.shards[path.name] = {
                    f: np.load(path / f"{f}.npy", mmap_mode="r") for f in FIELDS
                }

    def __len__(self) -> int:
        return sum(len(s["curve"]) for s in self.shards.values())

    def batch(self, rng: np.random.Generator, count: int, blocks: int = 8) -> dict[str, np.ndarray]:
        """`count` samples: runs of neighbours (cheap to read) from `blocks` random places."""
        names = list(self.shards)
        run = count // blocks
        parts = []
        for _ in range(blocks):
            shard = self.shards[names[rng.integers(len(names))]]
            first = rng.integers(len(shard["curve"]) - run + 1)
            parts.append({f: shard[f][first : first + run] for f in FIELDS})
        return {f: np.concatenate([p[f] for p in parts]) for f in FIELDS}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("photos", type=Path)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--gyro", type=Path, help="folder of gyro logs")
    parser.add_argument("--begin", type=int, default=0, help="first shard")
    parser.add_argument("--shards", type=int, default=1)
    parser.add_argument("--samples", type=int, default=SHARD_SAMPLES, help="in one shard")
    parser.add_argument("--first-photo", type=int, default=0)
    parser.add_argument("--last-photo", type=int, default=None)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    cv2.setNumThreads(1)
    photos = load_photos(args.photos)[args.first_photo : args.last_photo]
    synthesizer = Synthesizer(photos, CurveSampler(read_gyro_folder(args.gyro) if args.gyro else []))
    args.pool.mkdir(parents=True, exist_ok=True)
    for shard in range(args.begin, args.begin + args.shards):
        folder = args.pool / f"shard-{shard:04d}"
        if folder.exists():
            continue
        start = time.monotonic()
        make_shard(synthesizer, folder, (args.seed, shard), args.samples)
        print(f"{folder}: {args.samples / (time.monotonic() - start):.0f} samples/s", flush=True)


if __name__ == "__main__":
    main()
