#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Trains a network that tells the motion of a readout from one picture; README.md says how.

  train.py RUN --pool POOL --dev DEV
  train.py RUN --photos FOLDER --gyro FOLDER --workers 4
  torchrun --nproc_per_node=4 train.py RUN --rs-real FOLDER --net reference --precision fp16
RUN receives checkpoint.pt and log.csv; the same command goes on where it stopped.

Random numbers of step k follow from (--seed, process, k), so that going on after a stop gives the
weights that an unbroken run gives.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import cv2
import numpy as np
import torch

import checkpoint
from data_source import (
    Batch,
    Batches,
    PreferStructure,
    add_source_options,
    as_tensors,
    batches,
    open_source,
)
from devices import PRECISIONS, MixedPrecision, Place, place
from ema import Ema
from learners import Losses, make_learner
from losses import WEIGHTS, LossOptions
from run_log import CsvLog, Progress
from rs_real import fit_report, rs_real_files
from sample_pool import SamplePool
from samples import SampleSource

WARM_UP_STEPS = 300
CLOCK_STEPS = 10  # between looks at the clock and at the loss, which wait for the GPU
LAST_RATE = 0.02  # of the cosine, as a share of the highest
DEV_SEED = 2**31  # apart from all seeds of training
PATCH_ATTENTION = {"none": (False, False), "intra": (True, False), "both": (True, True)}
# What --net makes the default of other options; the reference's are as published.
DEFAULTS = {
    "compact": dict(steps=20_000, batch=128, lr=1e-3, lr_schedule="cosine", weight_decay=1e-3,
                    ema=0.999, draws=4, weight="clipped", photometric=False, large=1.0,
                    slope_share=0.1, largest_gradient=16.0),
    "reference": dict(steps=150_000, batch=64, lr=1e-4, lr_schedule="constant", weight_decay=0.0,
                      ema=0.995, draws=1, weight="snr", photometric=True, large=0.0,
                      slope_share=0.0, largest_gradient=1.0),
}


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], argument_default=argparse.SUPPRESS
    )
    parser.add_argument("run", type=Path, help="folder for the checkpoint and the log")
    data = parser.add_argument_group("data (one of --pool, --photos, --rs-real)")
    data.add_argument("--pool", type=Path, default=None, help="made by sample_pool.py")
    add_source_options(data)
    data.add_argument("--dev", type=Path, default=None,
                      help="pool to judge on; else a part of the source is held out")
    data.add_argument("--dev-samples", type=int, default=1000)
    data.add_argument("--prefer-structure", type=float, default=0.0, metavar="SHARE",
                      help="of two samples take the more structured one in this share of cases")
    data.add_argument("--workers", type=int, default=0, help="processes that make samples")
    what = parser.add_argument_group("what is trained")
    what.add_argument("--net", choices=list(DEFAULTS), default="compact")
    what.add_argument("--objective", choices=["diffusion", "regression", "image"],
                      default="diffusion", help="image: predicts the corrected picture itself")
    what.add_argument("--patch-attention", choices=list(PATCH_ATTENTION), default="both")
    what.add_argument("--config", type=json.loads, default={}, help="JSON of CompactConfig fields")
    loss = parser.add_argument_group("loss")
    loss.add_argument("--weight", choices=WEIGHTS)
    loss.add_argument("--photometric", action=argparse.BooleanOptionalAction)
    loss.add_argument("--drop-condition", type=float, default=0.1)
    loss.add_argument("--draws", type=int, help="noisy states per picture")
    loss.add_argument("--large", type=float, help="RMS network units from which motions count less")
    loss.add_argument("--still", type=float, default=1.0,
                      help="how much more pictures without motion count")
    loss.add_argument("--slope-share", type=float,
                      help="weight of a curve's slopes beside its values; 0: squared error only")
    pace = parser.add_argument_group("optimisation")
    pace.add_argument("--steps", type=int)
    pace.add_argument("--batch", type=int, help="samples a step, shared by all processes")
    pace.add_argument("--lr", type=float)
    pace.add_argument("--lr-schedule", choices=["cosine", "constant"])
    pace.add_argument("--weight-decay", type=float)
    pace.add_argument("--ema", type=float)
    pace.add_argument("--largest-gradient", type=float, help="norm to which gradients are cut")
    pace.add_argument("--precision", choices=list(PRECISIONS), default="fp32")
    pace.add_argument("--seed", type=int, default=1)
    pace.add_argument("--threads", type=int, default=1, help="of PyTorch, on a CPU")
    pace.add_argument("--report", type=int, default=500, help="steps between checkpoints")
    pace.add_argument("--minutes", type=float, default=0, help="stop after this time")
    return parser


def parse_options(words: list[str] | None = None) -> argparse.Namespace:
    given = make_parser().parse_args(words)
    options = argparse.Namespace(**{**DEFAULTS[given.net], **vars(given)})
    for name in ("photos", "gyro", "rs_real"):
        setattr(options, name, getattr(options, name, None))
    if options.objective == "image" and options.net != "compact":
        raise SystemExit("--objective image has a network of its own: leave --net out")
    if options.prefer_structure and options.net != "compact":
        raise SystemExit("--prefer-structure looks at what only the compact network sees")
    if options.pool is not None and options.dev is None:
        raise SystemExit("a pool needs --dev, another pool to judge on")
    if min(options.steps, options.batch, options.draws, options.report) < 1:
        raise SystemExit("--steps, --batch, --draws and --report are at least 1")
    return options


def learning_rate(step: int, options: argparse.Namespace) -> float:
    """Rises over the first steps, then stays, or falls along half a cosine."""
    rate = options.lr * min(1.0, (step + 1) / WARM_UP_STEPS)
    if options.lr_schedule == "cosine":
        falling = 0.5 * (1 + math.cos(math.pi * step / options.steps))
        rate *= LAST_RATE + (1 - LAST_RATE) * falling
    return rate


def seed_step(seed: int, process: int, step: int) -> None:
    word = np.random.SeedSequence((seed, process, step)).generate_state(1, np.uint64)[0]
    torch.manual_seed(int(word >> np.uint64(1)))


def new_net(options: argparse.Namespace) -> tuple[str, torch.nn.Module]:
    torch.manual_seed(options.seed)
    if options.objective == "image":
        return "image", checkpoint.make_net("image", {})
    if options.net == "reference":
        return "reference", checkpoint.make_net("reference", {})
    intra, inter = PATCH_ATTENTION[options.patch_attention]
    config = {"intra_patch": intra, "inter_patch": inter, **options.config}
    return "compact", checkpoint.make_net("compact", config)


def training_data(options: argparse.Namespace) -> SampleSource:
    if options.pool is not None:
        source: SampleSource = SamplePool(options.pool, options.net)
    else:
        source = open_source(options, options.net, False)
    share = options.prefer_structure
    return PreferStructure(source, share) if share else source


def training_batches(options: argparse.Namespace, place: Place) -> Batches:
    """This process' share of each batch."""
    count = max(1, options.batch // place.world)
    return Batches(training_data(options), count, options.seed, place.rank)


def dev_data(options: argparse.Namespace, device: torch.device) -> Batch:
    if options.dev is not None:
        arrays = SamplePool(options.dev, options.net).head(options.dev_samples)
    else:
        rng = np.random.default_rng(DEV_SEED)
        arrays = open_source(options, options.net, True).batch(rng, options.dev_samples)
    return {name: tensor.to(device) for name, tensor in as_tensors(arrays).items()}


class Trainer:
    """The state of a run in one process."""

    def __init__(self, options: argparse.Namespace, place: Place):
        self.options, self.place = options, place
        self.net_name, net = new_net(options)
        self.net = net.to(place.device)
        loss = LossOptions(
            weight=options.weight, photometric=options.photometric,
            drop_condition=options.drop_condition, large=options.large, still=options.still,
            draws=options.draws, regression=options.objective == "regression",
            slope_share=options.slope_share,
        )
        self.learner = make_learner(self.net, loss).to(place.device)
        self.optimizer = torch.optim.AdamW(
            self.net.parameters(), lr=options.lr, weight_decay=options.weight_decay
        )
        self.precision = MixedPrecision(options.precision, place.device)
        self.ema = Ema(self.net, options.ema)
        self.step = 0
        self.reference_row = "middle"
        self.path = options.run / "checkpoint.pt"
        if self.path.exists():
            self._resume()

    def _resume(self) -> None:
        state = checkpoint.load(self.path)
        if (state["net"], state["config"]) != (self.net_name, checkpoint.config_of(self.net)):
            raise SystemExit(f"{self.path}: is of another network than the options name")
        if state["objective"] != self.options.objective:
            raise SystemExit(f"{self.path}: was trained for {state['objective']}")
        self.net.load_state_dict(state["model"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.ema.load(state["ema"], state["ema_step"])
        if "scaler" in state:
            self.precision.scaler.load_state_dict(state["scaler"])
        self.step = state["step"]

    def save(self) -> None:
        checkpoint.save(self.path, {
            "net": self.net_name,
            "config": checkpoint.config_of(self.net),
            "objective": self.options.objective,
            "reference_row": self.reference_row,
            "model": self.net.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "ema": self.ema.values,
            "ema_step": self.ema.step,
            "scaler": self.precision.scaler.state_dict(),
            "step": self.step,
        })

    def figures(self, dev: Batch) -> dict[str, float]:
        """Of the averaged weights."""
        own = {key: value.clone() for key, value in self.net.state_dict().items()}
        self.net.load_state_dict(self.ema.values)
        self.learner.eval()
        figures = self.learner.figures(dev)
        self.learner.train()
        self.net.load_state_dict(own)
        return figures

    def train(self, progress: Progress) -> None:
        options, place = self.options, self.place
        log = CsvLog(options.run / "log.csv", self.step) if place.is_first else None
        dev = dev_data(options, place.device) if place.is_first else {}
        size = sum(p.numel() for p in self.net.parameters()) / 1e6
        if place.is_first:
            progress.report(f"{self.net_name}: {size:.2f} M parameters, from step {self.step}")
            if options.rs_real is not None and options.net == "compact":
                progress.report(fit_report(rs_real_files(options.rs_real)))
        data = training_batches(options, place)
        self.reference_row = data.source.reference_row
        parallel = place.parallel(self.learner, some_unused=self.net_name == "reference")
        self.learner.train()
        first, begin = self.step, time.monotonic()
        running: Losses = {}
        for batch in batches(data, first, options.steps, options.workers):
            for name, loss in self._advance(parallel, batch).items():
                running[name] = loss.lerp(running.get(name, loss), 0.99)
            spent = time.monotonic() - begin
            rate = (self.step - first) * data.count * place.world / spent
            is_late = options.minutes and self.step % CLOCK_STEPS == 0
            is_late = is_late and place.agree(spent > 60 * options.minutes)
            last = is_late or self.step == options.steps
            if place.is_first and self.step % CLOCK_STEPS == 0:
                left = (options.steps - self.step) * spent / (self.step - first) / 60
                progress.update(f"step {self.step}/{options.steps}  loss {running['total']:.4f}  "
                                f"{rate:.0f} samples/s  {left:.0f} min left")
            if place.is_first and (last or self.step % options.report == 0):
                row = {"step": self.step, "samples": self.step * options.batch,
                       "minutes": spent / 60, **{n: float(v) for n, v in running.items()},
                       **self.figures(dev)}
                log.add(row)
                self.save()
                told = "  ".join(f"{name} {value:.4g}" for name, value in row.items())
                progress.report(f"{told}  {rate:.0f} samples/s")
            if last:
                break

    def _advance(self, parallel: torch.nn.Module, batch: Batch) -> Losses:
        """One step of the optimizer."""
        for group in self.optimizer.param_groups:
            group["lr"] = learning_rate(self.step, self.options)
        seed_step(self.options.seed, self.place.rank, self.step)
        batch = {n: t.to(self.place.device, non_blocking=True) for n, t in batch.items()}
        with self.precision.forward():
            losses = parallel(batch)
        self.precision.step(losses["total"], self.optimizer, self.net,
                            self.options.largest_gradient)
        self.ema.update(self.net)
        self.step += 1
        return {name: value.detach() for name, value in losses.items()}


def main() -> None:
    options = parse_options()
    torch.set_num_threads(options.threads)
    cv2.setNumThreads(1)
    options.run.mkdir(parents=True, exist_ok=True)
    with place() as here:
        Trainer(options, here).train(Progress())


if __name__ == "__main__":
    main()
