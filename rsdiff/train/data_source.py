# SPDX-License-Identifier: Apache-2.0
"""Where samples come from (photographs, RS-Real), and how batches of them reach the trainer.

Batch k of a process depends on (seed, process, k) and nothing else, so that a resumed run goes on
with the batches it would have had, whatever the number of worker processes.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import torch
from torch.utils.data import DataLoader, Dataset

from gyro_logs import read_gyro_folder
from orientation_planes import LEVEL_BINS, UPRIGHT_BINS
from rotation_curve import CurveSampler
from rs_real import RsReal, rs_real_files
from samples import Sample, SampleSource
from synthesis import Synthesizer, load_photos, photo_files

Batch = dict[str, torch.Tensor]

HOLD_OUT = 20  # one photograph or file in this many is kept for evaluation


def add_source_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--photos", type=Path, help="folder of photographs, any sizes")
    parser.add_argument("--gyro", type=Path, help="folder of gyro logs, motions for photographs")
    parser.add_argument("--rs-real", type=Path, help="folder with RS-Real's .npz samples")


def _part(files: list[Path], held_out: bool) -> list[Path]:
    chosen = [f for i, f in enumerate(files) if (i % HOLD_OUT == HOLD_OUT - 1) == held_out]
    return chosen or files


def open_source(args: argparse.Namespace, kind: str, held_out: bool) -> SampleSource:
    """The source that the options name, without what is held out, or only that."""
    if (args.photos is None) == (args.rs_real is None):
        raise SystemExit("name one source of samples: --photos or --rs-real")
    if args.rs_real is not None:
        return RsReal(_part(rs_real_files(args.rs_real), held_out), kind)
    photos = load_photos(_part(photo_files(args.photos), held_out), kind == "reference")
    logs = read_gyro_folder(args.gyro) if args.gyro else []
    return Synthesizer(photos, CurveSampler(logs))


def structure_score(planes: np.ndarray) -> np.ndarray:
    """How much of the edges' energy lies close to upright or level, N values from planes' bytes."""
    energy = (planes.astype(np.float32) ** 2).sum(axis=(2, 3))
    upright, level = energy[:, :UPRIGHT_BINS], energy[:, UPRIGHT_BINS:]
    straight = upright[:, UPRIGHT_BINS // 2 - 4 : UPRIGHT_BINS // 2 + 4].sum(axis=1)
    flat = level[:, LEVEL_BINS // 2 - 2 : LEVEL_BINS // 2 + 2].sum(axis=1)
    return straight / (upright.sum(axis=1) + 1) + 0.5 * flat / (level.sum(axis=1) + 1)


class PreferStructure:
    """Of every two samples of a source the one with more structure, in this share of the pairs.

    It teaches more. What is chosen by its picture alone does not bias what a picture says of the
    motion.
    """

    def __init__(self, source: SampleSource, share: float):
        self.source, self.share = source, share
        self.reference_row = source.reference_row

    def batch(self, rng: np.random.Generator, count: int) -> Sample:
        pairs = self.source.batch(rng, 2 * count)
        score = structure_score(pairs["planes"])
        obeys = rng.random(count) < self.share
        first = (score[:count] > score[count:]) == obeys
        chosen = np.where(first, np.arange(count), np.arange(count, 2 * count))
        return {name: array[chosen] for name, array in pairs.items()}


def as_tensors(arrays: Sample) -> Batch:
    """Pictures stay bytes, all else becomes float32."""
    tensors = {name: torch.from_numpy(np.ascontiguousarray(a)) for name, a in arrays.items()}
    return {n: t if t.dtype == torch.uint8 else t.float() for n, t in tensors.items()}


class Batches(Dataset):
    """Item k is batch k."""

    def __init__(self, source: SampleSource, count: int, seed: int, process: int):
        self.source, self.count, self.seed, self.process = source, count, seed, process

    def __getitem__(self, step: int) -> Batch:
        rng = np.random.default_rng((self.seed, self.process, step))
        return as_tensors(self.source.batch(rng, self.count))


def _one_thread(_: int) -> None:
    cv2.setNumThreads(1)
    torch.set_num_threads(1)


def batches(data: Batches, first: int, end: int, workers: int) -> Iterator[Batch]:
    """Batches first .. end - 1 in order, made ahead by worker processes if there are any."""
    return iter(DataLoader(
        data, batch_size=None, sampler=range(first, end), num_workers=workers,
        worker_init_fn=_one_thread, pin_memory=torch.cuda.is_available(),
    ))


def mirrored(batch: Batch, which: torch.Tensor) -> Batch:
    """Mirrors the chosen samples left to right: slopes, yaw and roll change their sign."""
    def chosen(changed: torch.Tensor, plain: torch.Tensor) -> torch.Tensor:
        return torch.where(which.view(-1, *[1] * (plain.dim() - 1)), changed, plain)

    result = dict(batch)
    for name in ("rs", "gs", "rs_small", "gs_small"):
        if name in batch:
            result[name] = chosen(batch[name].flip(-1), batch[name])
    if "planes" in batch:
        planes = batch["planes"]
        parts = [planes[:, :UPRIGHT_BINS].flip(1), planes[:, UPRIGHT_BINS:].flip(1)]
        result["planes"] = chosen(torch.cat(parts, dim=1).flip(3), planes)
        sign = torch.tensor([-1.0, 1.0, -1.0], device=planes.device)[:, None]
        result["rotation"] = chosen(batch["rotation"] * sign, batch["rotation"])
    if "field" in batch:
        sign = torch.tensor([-1.0, 1.0], device=batch["field"].device)[:, None, None]
        result["field"] = chosen(batch["field"].flip(-1) * sign, batch["field"])
    return result
