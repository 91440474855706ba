# SPDX-License-Identifier: Apache-2.0
"""What is trained: a network with its losses and the figures it is judged by.

A learner is called with a batch and gives its losses (so that DistributedDataParallel sees one
forward pass); `figures` judges it. `net` is what checkpoints keep.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import nn

from checkpoint import TIMESTEPS
from compact_net import CompactNet, condition_tensor
from data_source import Batch, mirrored
from diffusion import NoiseSchedule
from image_net import ImageNet
from losses import LossOptions, balanced, curve_loss, size_weight, state_loss, time_weight
from metrics import field_errors, picture_figures
from motion_field import curve_warp_field, first_order_field, photometric_loss, warp
from reference_net import ReferenceDiffusion
from rotation_curve import SCALE

LATE_TIMES = 50  # the last times, nearly pure noise: where sampling starts
FIGURE_COLUMNS = 6  # of the fields that figures compare
EVALUATION_BATCH = 128

Losses = dict[str, torch.Tensor]


def _coin(batch: Batch) -> torch.Tensor:
    return torch.rand(len(batch["aspect"]), device=batch["aspect"].device) < 0.5


class MotionLearner(nn.Module):
    """Diffusion over the motion with the clean motion as its target, or plain regression."""

    net: nn.Module

    def __init__(self, options: LossOptions):
        super().__init__()
        self.options = options
        alphas = NoiseSchedule.linear(TIMESTEPS).tables("x0")["alphas_cumprod"]
        self.register_buffer("alphas", alphas, persistent=False)
        self.register_buffer("weights", time_weight(alphas, options.weight), persistent=False)

    def truth(self, batch: Batch) -> torch.Tensor:
        raise NotImplementedError

    def encode(self, batch: Batch) -> list[torch.Tensor]:
        raise NotImplementedError

    def denoise(self, noisy: torch.Tensor, t: torch.Tensor, context: list[torch.Tensor],
                seen: torch.Tensor) -> torch.Tensor:
        """`seen`: N booleans, whether the picture may be looked at."""
        raise NotImplementedError

    def compare(self, out: torch.Tensor, truth: torch.Tensor, weight: torch.Tensor) -> torch.Tensor:
        """The loss of predicted motions, as one number."""
        return state_loss(out, truth, weight)

    def photometric(self, motion: torch.Tensor, batch: Batch) -> torch.Tensor:
        raise NotImplementedError

    def heights(self, motion: torch.Tensor, batch: Batch) -> torch.Tensor:
        """Motion as a field in image heights."""
        raise NotImplementedError

    def pictures(self, motion: torch.Tensor, truth: torch.Tensor, batch: Batch) -> dict[str, float]:
        """PSNR before and after."""
        raise NotImplementedError

    def forward(self, batch: Batch) -> Losses:
        batch = mirrored(batch, _coin(batch))
        truth, context = self.truth(batch), self.encode(batch)
        losses = self._regress(truth, context) if self.options.regression else self._diffuse(
            truth, context)
        clean = losses.pop("clean")
        losses["total"] = losses["motion"]
        if self.options.photometric:
            losses["photometric"] = self.photometric(clean, batch)
            losses["total"] = balanced(losses["motion"], losses["photometric"])
        return losses

    def _regress(self, truth: torch.Tensor, context: list[torch.Tensor]) -> Losses:
        clean = self._from_nothing(torch.zeros_like(truth), context)
        weight = size_weight(truth, self.options.large, self.options.still)
        return {"motion": self.compare(clean, truth, weight), "clean": clean}

    def _diffuse(self, truth: torch.Tensor, context: list[torch.Tensor]) -> Losses:
        """With several draws per picture the first one is late in time and sees the picture."""
        count, draws, device = len(truth), self.options.draws, truth.device
        t = torch.randint(0, TIMESTEPS, (count * draws,), device=device)
        seen = torch.rand(count * draws, device=device) >= self.options.drop_condition
        if draws > 1:
            t[:count] = torch.randint(TIMESTEPS - LATE_TIMES, TIMESTEPS, (count,), device=device)
            seen[:count] = True
        truth = truth.repeat(draws, 1, 1, 1)
        alpha = self.alphas[t][:, None, None, None]
        noisy = alpha.sqrt() * truth + (1 - alpha).sqrt() * torch.randn_like(truth)
        context = [c.repeat(draws, 1, 1, 1) for c in context]
        clean = self.denoise(noisy, t, context, seen).float()
        weight = self.weights[t] * size_weight(truth, self.options.large, self.options.still)
        return {"motion": self.compare(clean, truth, weight), "clean": clean[:count]}

    def _from_nothing(self, start: torch.Tensor, context: list[torch.Tensor]) -> torch.Tensor:
        t = torch.full((len(start),), TIMESTEPS - 1, device=start.device)
        seen = torch.ones_like(t, dtype=torch.bool)
        return self.denoise(start, t, context, seen).float()

    @torch.no_grad()
    def figures(self, batch: Batch) -> dict[str, float]:
        """Of one prediction from pure noise (or nothing, when it regresses)."""
        truth = self.truth(batch)
        noise = torch.randn(truth.shape, generator=torch.Generator().manual_seed(1))
        start = torch.zeros_like(truth) if self.options.regression else noise.to(truth.device)
        parts = []
        for first in range(0, len(truth), EVALUATION_BATCH):
            part = slice(first, first + EVALUATION_BATCH)
            context = self.encode({name: values[part] for name, values in batch.items()})
            parts.append(self._from_nothing(start[part], context))
        motion = torch.cat(parts)
        return {
            **field_errors(self.heights(motion, batch), self.heights(truth, batch)),
            "mse": float(((motion - truth) ** 2).mean()),
            **self.pictures(motion, truth, batch),
        }


class CompactLearner(MotionLearner):
    def __init__(self, net: CompactNet, options: LossOptions):
        super().__init__(options)
        self.net = net

    def truth(self, batch: Batch) -> torch.Tensor:
        return _curve_state(batch)

    def encode(self, batch: Batch) -> list[torch.Tensor]:
        condition = condition_tensor(
            batch["planes"], batch["rs_small"], batch["aspect"], self.net.config
        )
        return [self.net.encode(condition)]

    def denoise(self, noisy: torch.Tensor, t: torch.Tensor, context: list[torch.Tensor],
                seen: torch.Tensor) -> torch.Tensor:
        return self.net.denoise(noisy, t, context[0] * seen[:, None, None, None], TIMESTEPS)

    def compare(self, out: torch.Tensor, truth: torch.Tensor, weight: torch.Tensor) -> torch.Tensor:
        if self.options.slope_share == 0.0:
            return super().compare(out, truth, weight)
        return curve_loss(out, truth, weight, self.options.slope_share)

    def photometric(self, motion: torch.Tensor, batch: Batch) -> torch.Tensor:
        return photometric_loss(*_small_pictures(batch), _curve_field(motion, batch))

    def heights(self, motion: torch.Tensor, batch: Batch) -> torch.Tensor:
        return first_order_field(motion.squeeze(-1), batch["aspect"], FIGURE_COLUMNS)

    def pictures(self, motion: torch.Tensor, truth: torch.Tensor, batch: Batch) -> dict[str, float]:
        rs, gs = _small_pictures(batch)
        warped, _ = warp(rs, _curve_field(motion, batch))
        return picture_figures(rs, gs, warped, _curve_field(truth, batch))


def _curve_state(batch: Batch) -> torch.Tensor:
    """The true curve in network units, N x 3 x BANDS x 1."""
    scale = torch.as_tensor(SCALE, device=batch["rotation"].device)
    return (batch["rotation"] / scale[:, None]).unsqueeze(-1)


def _small_pictures(batch: Batch) -> tuple[torch.Tensor, torch.Tensor]:
    return batch["rs_small"].float()[:, None] / 255, batch["gs_small"].float()[:, None] / 255


def _curve_field(motion: torch.Tensor, batch: Batch) -> torch.Tensor:
    rows, columns = batch["rs_small"].shape[1:]
    return curve_warp_field(motion.squeeze(-1), batch["aspect"], rows, columns)


class ReferenceLearner(MotionLearner):
    """The published network and its losses."""

    def __init__(self, net: ReferenceDiffusion, options: LossOptions):
        super().__init__(options)
        self.net = net

    def truth(self, batch: Batch) -> torch.Tensor:
        return batch["field"]

    def encode(self, batch: Batch) -> list[torch.Tensor]:
        return self.net.model.encode(batch["rs"].float() / 127.5 - 1.0)

    def denoise(self, noisy: torch.Tensor, t: torch.Tensor, context: list[torch.Tensor],
                seen: torch.Tensor) -> torch.Tensor:
        return self.net.model.denoise(noisy, t, context, ~seen)

    @staticmethod
    def _sides(motion: torch.Tensor) -> torch.Tensor:
        """Network units to widths and heights."""
        rows, columns = motion.shape[2:]
        factor = motion.new_tensor([(columns - 1) / columns, (rows - 1) / rows])
        return motion * factor[:, None, None]

    def photometric(self, motion: torch.Tensor, batch: Batch) -> torch.Tensor:
        rs, gs = batch["rs"].float() / 255, batch["gs"].float() / 255
        return photometric_loss(rs, gs, self._sides(motion))

    def heights(self, motion: torch.Tensor, batch: Batch) -> torch.Tensor:
        sides = self._sides(motion)
        return torch.stack([sides[:, 0] * batch["aspect"][:, None, None], sides[:, 1]], dim=1)

    def pictures(self, motion: torch.Tensor, truth: torch.Tensor, batch: Batch) -> dict[str, float]:
        rs, gs = batch["rs"].float() / 255, batch["gs"].float() / 255
        warped, _ = warp(rs, self._sides(motion))
        return picture_figures(rs, gs, warped, self._sides(truth))


class ImageLearner(nn.Module):
    """Image to image on the small grey pictures, judged on the same pixels as the others."""

    def __init__(self, net: ImageNet):
        super().__init__()
        self.net = net

    def forward(self, batch: Batch) -> Losses:
        batch = mirrored(batch, _coin(batch))
        rs, gs = _small_pictures(batch)
        loss = ((self.net(rs).float() - gs) ** 2).mean()
        return {"picture": loss, "total": loss}

    @torch.no_grad()
    def figures(self, batch: Batch) -> dict[str, float]:
        rs, gs = _small_pictures(batch)
        predicted = torch.cat([self.net(part).float() for part in rs.split(EVALUATION_BATCH)])
        return picture_figures(rs, gs, predicted, _curve_field(_curve_state(batch), batch))


def make_learner(net: nn.Module, options: LossOptions) -> Any:
    """The learner for a network."""
    if isinstance(net, CompactNet):
        return CompactLearner(net, options)
    return ImageLearner(net) if isinstance(net, ImageNet) else ReferenceLearner(net, options)
