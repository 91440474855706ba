# SPDX-License-Identifier: Apache-2.0
"""Figures that a training run reports on samples it does not learn from."""

from __future__ import annotations

import torch

from motion_field import warp

REPORT_HEIGHT_PX = 600
STILL_HEIGHTS = 1e-5  # a field below it is no motion


def psnr(picture: torch.Tensor, truth: torch.Tensor, valid: torch.Tensor) -> float:
    """Mean over the pictures, dB, values 0 to 1, over valid pixels only."""
    squares = ((picture - truth) ** 2).mean(dim=1, keepdim=True) * valid
    mean = squares.flatten(1).sum(dim=1) / valid.flatten(1).sum(dim=1).clamp(min=1)
    return float((-10 * torch.log10(mean.clamp(min=1e-10))).mean())


def field_errors(predicted: torch.Tensor, truth: torch.Tensor) -> dict[str, float]:
    """Fields N x 2 x rows x columns in image heights.

    u, v, epe: mean error over moving frames as a share of what doing nothing leaves;
    still_px: mean EPE on still frames, for pictures of REPORT_HEIGHT_PX rows.
    """
    moving = truth.flatten(1).abs().amax(dim=1) > STILL_HEIGHTS
    error = predicted - truth
    parts = error.abs().mean(dim=(2, 3))[moving].sum(dim=0)
    parts = parts / truth.abs().mean(dim=(2, 3))[moving].sum(dim=0)
    epe = error.norm(dim=1).mean(dim=(1, 2))
    before = truth.norm(dim=1).mean(dim=(1, 2))
    still = epe[~moving].mean() * REPORT_HEIGHT_PX if (~moving).any() else epe.new_zeros(())
    return {
        "u": float(parts[0]),
        "v": float(parts[1]),
        "epe": float(epe[moving].sum() / before[moving].sum()),
        "still_px": float(still),
    }


def picture_figures(
    rs: torch.Tensor, gs: torch.Tensor, predicted: torch.Tensor, truth: torch.Tensor
) -> dict[str, float]:
    """PSNR of the untouched picture and of `predicted`, where the true field has a source.

    truth: field in widths and heights. A predicted field is given as the picture it makes.
    """
    valid = warp(rs, truth)[1].float()
    return {"psnr_rs": psnr(rs, gs, valid), "psnr": psnr(predicted, gs, valid)}
