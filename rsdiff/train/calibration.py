# SPDX-License-Identifier: Apache-2.0
"""How far apart the samples of a compact network lie, against how far off they are.

Few steps of sampling draw the samples too close together. The scale that makes their spread honest
is measured on samples that the network did not learn from, and goes into the model file.
"""

from __future__ import annotations

import numpy as np
import torch

from checkpoint import TIMESTEPS
from compact_net import CompactNet, condition_tensor
from data_source import Batch
from diffusion import NoiseSchedule, ddim_sample
from rotation_curve import BANDS, SCALE

CENTRAL_SHARE = 0.8  # of the samples, in which the truth should lie that often
MIDDLE_BANDS = 4  # do not count: everything is zero there
PICTURES_AT_ONCE = 32


def centred(curves: torch.Tensor) -> torch.Tensor:
    """Zero at the middle row, between the two middle bands, by the program's own cubic."""
    m = BANDS // 2
    near, far = curves[..., m - 1 : m + 1], curves[..., [m - 2, m + 1]]
    return curves - (9 * near.sum(dim=-1) - far.sum(dim=-1)).unsqueeze(-1) / 16


@torch.no_grad()
def draw_samples(
    net: CompactNet, batch: Batch, samples: int, steps: int, clip_range: float, seed: int = 1
) -> torch.Tensor:
    """N x samples x 3 x BANDS curves in network units."""
    generator = torch.Generator().manual_seed(seed)
    schedule = NoiseSchedule.linear(TIMESTEPS)
    drawn = []
    for first in range(0, len(batch["aspect"]), PICTURES_AT_ONCE):
        part = {n: values[first : first + PICTURES_AT_ONCE] for n, values in batch.items()}
        condition = condition_tensor(part["planes"], part["rs_small"], part["aspect"], net.config)
        features = net.encode(condition).repeat_interleave(samples, dim=0)
        noise = torch.randn(len(features), 3, BANDS, 1, generator=generator)
        states = ddim_sample(
            lambda x, t: net.denoise(x, t, features, TIMESTEPS),
            noise, schedule, steps, clip_range=clip_range,
        )
        drawn.append(states.reshape(-1, samples, 3, BANDS))
    return centred(torch.cat(drawn))


def quantiles(samples: torch.Tensor, share: float) -> torch.Tensor:
    """At position share * (n + 1) of n ordered samples: what the truth's own samples would hold."""
    ordered = samples.sort(dim=1).values
    count = samples.shape[1]
    position = min(max(share * (count + 1) - 1, 0.0), count - 1.0)
    lower = min(int(position), count - 2)
    return ordered[:, lower].lerp(ordered[:, lower + 1], position - lower)


def spread_scale(samples: torch.Tensor, truth: torch.Tensor) -> tuple[float, np.ndarray]:
    """Factor on the samples' distance from their mean, and how often each axis is covered then.

    samples: N x n x 3 x BANDS, truth: N x 3 x BANDS, network units. Still frames do not count. The
    factor is such that the truth lies inside the central 80% of the samples 80% of the time.
    """
    moving = truth.flatten(1).abs().amax(dim=1) > 1e-4
    samples, truth = samples[moving], truth[moving]
    mean = samples.mean(dim=1)
    outer = (1 - CENTRAL_SHARE) / 2
    low, high = quantiles(samples, outer) - mean, quantiles(samples, 1 - outer) - mean
    miss = truth - mean
    needed = miss / torch.where(miss < 0, low.clamp(max=-1e-6), high.clamp(min=1e-6))
    edge = (BANDS - MIDDLE_BANDS) // 2
    needed = torch.cat([needed[..., :edge], needed[..., -edge:]], dim=-1)
    scale = float(np.quantile(needed.numpy(), CENTRAL_SHARE))
    return scale, (needed <= scale).float().mean(dim=(0, 2)).numpy()


def true_curves(batch: Batch) -> torch.Tensor:
    return batch["rotation"] / torch.as_tensor(SCALE)[:, None]
