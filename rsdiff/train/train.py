#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Trains the compact network; see README.md beside it."""

from __future__ import annotations

import argparse
import csv
import json
import math
import time
from dataclasses import asdict
from pathlib import Path

import numpy as np
import torch

from compact_net import CompactConfig, CompactNet, condition_tensor
from motion_field import first_order_field, photometric_loss
from sample_pool import SamplePool

TIMESTEPS = 1000


def linear_alphas_cumprod() -> torch.Tensor:
    betas = torch.linspace(1e-4, 0.02, TIMESTEPS, dtype=torch.float64)
    return torch.cumprod(1.0 - betas, dim=0).float()


def flip(batch: dict[str, torch.Tensor], which: torch.Tensor) -> dict[str, torch.Tensor]:
    """Mirrors the chosen samples left to right: slopes, yaw and roll change their sign."""
    from orientation_planes import UPRIGHT_BINS

    planes = batch["planes"]
    mirrored = torch.cat(
        [planes[:, :UPRIGHT_BINS].flip(1), planes[:, UPRIGHT_BINS:].flip(1)], dim=1
    ).flip(3)
    choose = lambda a, b: torch.where(which.view(-1, *[1] * (a.dim() - 1)), a, b)
    sign = torch.tensor([-1.0, 1.0, -1.0])[:, None]
    return {
        "planes": choose(mirrored, planes),
        "rs_small": choose(batch["rs_small"].flip(2), batch["rs_small"]),
        "gs_small": choose(batch["gs_small"].flip(2), batch["gs_small"]),
        "curve": choose(batch["curve"] * sign, batch["curve"]),
        "aspect": batch["aspect"],
    }


def loss_weight(snr: torch.Tensor, kind: str) -> torch.Tensor:
    if kind == "snr":
        return snr
    if kind == "clipped":
        return snr.clamp(1.0, 5.0)
    return torch.ones_like(snr)


class Ema:
    def __init__(self, model: torch.nn.Module, decay: float):
        self.decay = decay
        self.values = {k: v.detach().clone() for k, v in model.state_dict().items()}
        self.step = 0

    def update(self, model: torch.nn.Module) -> None:
        self.step += 1
        decay = min(self.decay, (1 + self.step) / (10 + self.step))
        with torch.no_grad():
            for key, value in model.state_dict().items():
                if value.dtype.is_floating_point:
                    self.values[key].lerp_(value, 1 - decay)
                else:
                    self.values[key].copy_(value)


def epe_terms(curve, truth, aspect):
    """N x 2: RMS-free mean |u| and |v| error, in px of a 600 px high image."""
    error = first_order_field(curve - truth, aspect, 6) * 600
    return error.abs().mean(dim=(2, 3)), error.norm(dim=1).mean(dim=(1, 2))


@torch.no_grad()
def evaluate(model, batch, config, alphas, regression: bool) -> dict[str, float]:
    model.eval()
    condition = condition_tensor(batch["planes"], batch["rs_small"], batch["aspect"], config)
    features = torch.cat([model.encode(c) for c in condition.split(256)])
    generator = torch.Generator().manual_seed(1)
    truth = batch["curve"]
    t = torch.full((len(truth),), TIMESTEPS - 1)
    noise = torch.zeros(truth.shape) if regression else torch.randn(truth.shape, generator=generator)
    out = model.denoise(noise[..., None], t, features, TIMESTEPS)[..., 0]
    moving = truth.abs().amax(dim=(1, 2)) > 1e-4
    (uv, epe), (uv0, epe0) = epe_terms(out, truth, batch["aspect"]), epe_terms(
        truth * 0, truth, batch["aspect"]
    )
    return {
        "u": float(uv[moving, 0].sum() / uv0[moving, 0].sum()),
        "v": float(uv[moving, 1].sum() / uv0[moving, 1].sum()),
        "epe": float(epe[moving].sum() / epe0[moving].sum()),
        "still_px": float(epe[~moving].mean()),
        "mse": float(((out - truth) ** 2).mean()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pool", type=Path)
    parser.add_argument("run", type=Path, help="folder for checkpoints and the log")
    parser.add_argument("--dev", type=Path, required=True)
    parser.add_argument("--steps", type=int, default=20000)
    parser.add_argument("--batch", type=int, default=128)
    parser.add_argument("--lr", type=float, default=1e-3)
    parser.add_argument("--weight-decay", type=float, default=1e-3)
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--weight", default="clipped", choices=["snr", "clipped", "none"])
    parser.add_argument("--photometric", action="store_true")
    parser.add_argument("--regression", action="store_true")
    parser.add_argument("--drop-condition", type=float, default=0.1)
    parser.add_argument("--config", default="{}", help="JSON of CompactConfig overrides")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--report", type=int, default=500)
    parser.add_argument("--minutes", type=float, default=0)
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    torch.manual_seed(args.seed)
    rng = np.random.default_rng(args.seed)
    config = CompactConfig(**json.loads(args.config))
    model = CompactNet(config)
    optimizer = torch.optim.AdamW(model.parameters(), lr=args.lr, weight_decay=args.weight_decay)
    ema = Ema(model, 0.999)
    alphas = linear_alphas_cumprod()
    pool = SamplePool(args.pool)
    dev = {k: torch.from_numpy(np.ascontiguousarray(v)) for k, v in
           SamplePool(args.dev).shards["shard-0000"].items()}
    dev = {k: v[:2000].float() if k in ("curve", "aspect") else v[:2000] for k, v in dev.items()}
    args.run.mkdir(parents=True, exist_ok=True)
    first, checkpoint = 0, args.run / "checkpoint.pt"
    if checkpoint.exists():
        state = torch.load(checkpoint)
        model.load_state_dict(state["model"])
        optimizer.load_state_dict(state["optimizer"])
        ema.values, ema.step, first = state["ema"], state["ema_step"], state["step"]
    shadow = CompactNet(config)
    print(f"{sum(p.numel() for p in model.parameters()) / 1e6:.2f} M parameters", flush=True)
    log = open(args.run / "log.csv", "a")
    start, running = time.monotonic(), None
    for step in range(first, args.steps):
        progress = step / args.steps
        rate = args.lr * min(1.0, (step + 1) / 300) * (0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * progress)))
        for group in optimizer.param_groups:
            group["lr"] = rate
        if step % 500 == 0:
            pool.refresh()
        batch = {k: torch.from_numpy(v) for k, v in pool.batch(rng, args.batch).items()}
        batch["aspect"] = batch["aspect"].float()
        batch = flip(batch, torch.rand(args.batch) < 0.5)
        model.train()
        condition = condition_tensor(batch["planes"], batch["rs_small"], batch["aspect"], config)
        features = model.encode(condition)
        truth = batch["curve"]
        if args.regression:
            t = torch.full((args.batch,), TIMESTEPS - 1)
            out = model.denoise(torch.zeros_like(truth)[..., None], t, features, TIMESTEPS)[..., 0]
            loss = ((out - truth) ** 2).mean()
        else:
            n = args.draws
            truth_n = truth.repeat(n, 1, 1)
            keep = (torch.rand(args.batch) >= args.drop_condition).float()[:, None, None, None]
            keep = torch.cat([torch.ones_like(keep)] + [keep] * (n - 1))
            t = torch.randint(0, TIMESTEPS, (args.batch * n,))
            t[: args.batch] = torch.randint(TIMESTEPS - 50, TIMESTEPS, (args.batch,))
            alpha = alphas[t][:, None, None]
            noisy = alpha.sqrt() * truth_n + (1 - alpha).sqrt() * torch.randn_like(truth_n)
            out = model.denoise(noisy[..., None], t, features.repeat(n, 1, 1, 1) * keep, TIMESTEPS)[..., 0]
            weight = loss_weight(alphas[t] / (1 - alphas[t]), args.weight)
            loss = (((out - truth_n) ** 2).mean(dim=(1, 2)) * weight).mean()
        total = loss
        if args.photometric:
            photo = photometric_loss(out[: args.batch], batch["aspect"], batch["rs_small"], batch["gs_small"]).mean()
            total = loss + photo * (loss.detach() / photo.detach().clamp(min=1e-6))
        optimizer.zero_grad(set_to_none=True)
        total.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        ema.update(model)
        running = float(loss) if running is None else 0.99 * running + 0.01 * float(loss)
        last = step + 1 == args.steps or (args.minutes and time.monotonic() - start > 60 * args.minutes)
        if (step + 1) % args.report == 0 or last:
            shadow.load_state_dict(ema.values)
            result = evaluate(shadow, dev, config, alphas, args.regression)
            rate = (step + 1 - first) * args.batch / (time.monotonic() - start)
            row = [step + 1, (step + 1) * args.batch, round(running, 5)] + [round(v, 4) for v in result.values()]
            csv.writer(log).writerow(row)
            log.flush()
            print(row, f"{rate:.0f}/s pool {len(pool)}", flush=True)
            torch.save({"model": model.state_dict(), "optimizer": optimizer.state_dict(), "ema": ema.values,
                        "ema_step": ema.step, "step": step + 1, "config": asdict(config)}, checkpoint.with_suffix(".tmp"))
            checkpoint.with_suffix(".tmp").rename(checkpoint)
        if last:
            break


if __name__ == "__main__":
    main()
