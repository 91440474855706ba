# SPDX-License-Identifier: Apache-2.0
"""Noise schedules and DDIM sampling; knows no network.

Forward process: x_t = sqrt(abar_t) x0 + sqrt(1 - abar_t) noise, t = 0 .. T-1 (Ho et al. 2020).
Sampling: Song et al. 2021, eq. 12. Guidance: Ho and Salimans 2022, rescaled as in Lin et al. 2023.
Tables are made in double and used in float32, in the published order of operations, so that fields
agree with the published ones to the last bit when the network's outputs do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

OBJECTIVES = ("x0", "noise", "v")


@dataclass(frozen=True)
class NoiseSchedule:
    """betas: T doubles in (0, 1)."""

    betas: Tensor

    @staticmethod
    def linear(steps: int) -> NoiseSchedule:
        """1e-4 to 0.02 for T = 1000, scaled by 1000 / T for others."""
        scale = 1000.0 / steps
        betas = torch.linspace(scale * 1e-4, scale * 0.02, steps, dtype=torch.float64)
        return NoiseSchedule(betas.clamp(max=0.999))

    @staticmethod
    def cosine(steps: int, offset: float = 0.008) -> NoiseSchedule:
        """abar follows a squared cosine (Nichol and Dhariwal 2021, eq. 17)."""
        t = torch.linspace(0, steps, steps + 1, dtype=torch.float64) / steps
        abar = torch.cos((t + offset) / (1 + offset) * math.pi * 0.5) ** 2
        return NoiseSchedule((1 - abar[1:] / abar[:-1]).clamp(0, 0.999))

    @property
    def steps(self) -> int:
        return self.betas.numel()

    def tables(self, objective: str) -> dict[str, Tensor]:
        """All that follows from the betas, float32, by the names that published checkpoints use.

        `loss_weight` makes the squared error of every objective count as that of the noise.
        """
        abar = torch.cumprod(1 - self.betas, dim=0)
        previous = torch.cat((torch.ones(1, dtype=abar.dtype), abar[:-1]))
        variance = self.betas * (1 - previous) / (1 - abar)
        snr = abar / (1 - abar)
        weights = {"x0": snr, "noise": torch.ones_like(snr), "v": snr / (snr + 1)}
        tables = {
            "betas": self.betas,
            "alphas_cumprod": abar,
            "alphas_cumprod_prev": previous,
            "sqrt_alphas_cumprod": abar.sqrt(),
            "sqrt_one_minus_alphas_cumprod": (1 - abar).sqrt(),
            "log_one_minus_alphas_cumprod": (1 - abar).log(),
            "sqrt_recip_alphas_cumprod": (1 / abar).sqrt(),
            "sqrt_recipm1_alphas_cumprod": (1 / abar - 1).sqrt(),
            "posterior_variance": variance,
            "posterior_log_variance_clipped": variance.clamp(min=1e-20).log(),
            "posterior_mean_coef1": self.betas * previous.sqrt() / (1 - abar),
            "posterior_mean_coef2": (1 - previous) * (1 - self.betas).sqrt() / (1 - abar),
            "loss_weight": weights[objective],
        }
        return {name: values.float() for name, values in tables.items()}


def time_pairs(total: int, steps: int) -> list[tuple[int, int]]:
    """(from, to) of each DDIM step: `steps` + 1 integers from T-1 down to -1, the clean state."""
    times = torch.linspace(-1, total - 1, steps + 1).int().tolist()[::-1]
    return list(zip(times[:-1], times[1:]))


def guided(conditional: Tensor, unconditional: Tensor, scale: float, rescale: float) -> Tensor:
    """Classifier-free guidance; `rescale` in [0, 1] pulls each sample's standard deviation back."""
    out = unconditional + (conditional - unconditional) * scale
    if rescale == 0:
        return out
    dims = tuple(range(1, out.ndim))
    ratio = conditional.std(dim=dims, keepdim=True) / out.std(dim=dims, keepdim=True)
    return (out * ratio) * rescale + out * (1 - rescale)


def clean_state(
    objective: str, x: Tensor, output: Tensor, tables: dict[str, Tensor], t: int
) -> Tensor:
    """x0 from the network's output for x at time t."""
    if objective == "x0":
        return output
    if objective == "v":
        signal = tables["sqrt_alphas_cumprod"][t] * x
        return signal - tables["sqrt_one_minus_alphas_cumprod"][t] * output
    reciprocal = tables["sqrt_recip_alphas_cumprod"][t] * x
    return reciprocal - tables["sqrt_recipm1_alphas_cumprod"][t] * output


def ddim_sample(
    predict: Callable[[Tensor, Tensor], Tensor],
    x: Tensor,
    schedule: NoiseSchedule,
    steps: int,
    objective: str = "x0",
    eta: float = 0.0,
    clip_range: float = 1.0,
    generator: torch.Generator | None = None,
) -> Tensor:
    """The clean state reached from pure noise x (N x ...).

    `predict(x, time)` is the network's output (guidance included), `time` N integers. `eta` 0 is
    deterministic, 1 the ancestral sampler. `clip_range` bounds every estimate of x0.
    """
    tables = {name: values.to(x.device) for name, values in schedule.tables(objective).items()}
    abar = tables["alphas_cumprod"]
    for now, then in time_pairs(schedule.steps, steps):
        time = torch.full((x.shape[0],), now, device=x.device, dtype=torch.long)
        x0 = clean_state(objective, x, predict(x, time), tables, now).clamp(-clip_range, clip_range)
        if then < 0:
            return x0
        reciprocal = tables["sqrt_recip_alphas_cumprod"][now] * x
        noise = (reciprocal - x0) / tables["sqrt_recipm1_alphas_cumprod"][now]
        ratio = (1 - abar[now] / abar[then]) * (1 - abar[then]) / (1 - abar[now])
        sigma = eta * ratio.sqrt()
        x = x0 * abar[then].sqrt() + (1 - abar[then] - sigma**2).sqrt() * noise
        if eta > 0:
            x = x + sigma * torch.randn(x.shape, generator=generator).to(x)
    return x
