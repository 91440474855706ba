# SPDX-License-Identifier: Apache-2.0
"""Differentiable first-order field of a rotation curve, and errors told as displacements.

To first order the backward field of a curve (a, b, r) is
  u = a - r*y,  v = b + r*x,   all in image heights, (x, y) from the image centre;
exact fields come from `igf`. Good to a few percent, which is what losses and monitors need.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F

from rotation_curve import SCALE


def first_order_field(curve: torch.Tensor, aspect: torch.Tensor, columns: int) -> torch.Tensor:
    """curve N x 3 x bands (network units) -> N x 2 x bands x columns, in image heights."""
    bands = curve.shape[2]
    a, b, r = (curve * torch.as_tensor(SCALE, device=curve.device)[:, None]).unbind(dim=1)
    y = (torch.arange(bands, device=curve.device) + 0.5) / bands - 0.5
    x = (torch.arange(columns, device=curve.device) + 0.5) / columns - 0.5
    x = aspect[:, None, None] * x
    u = (a - r * y)[:, :, None].expand(-1, -1, columns)
    v = b[:, :, None] + r[:, :, None] * x
    return torch.stack([u, v], dim=1)


def photometric_loss(curve, aspect, rs_small, gs_small) -> torch.Tensor:
    """Mean absolute difference of the warped RS picture and the GS picture, N values."""
    rows, columns = rs_small.shape[1:]
    field = first_order_field(curve, aspect, columns)
    field = F.interpolate(field, size=(rows, columns), mode="bilinear", align_corners=False)
    y, x = torch.meshgrid(
        (torch.arange(rows) + 0.5) * 2 / rows - 1, (torch.arange(columns) + 0.5) * 2 / columns - 1,
        indexing="ij",
    )
    grid_x = x.to(field) + field[:, 0] * 2 / aspect[:, None, None]
    grid_y = y.to(field) + field[:, 1] * 2
    source = rs_small[:, None].float() / 255
    warped = F.grid_sample(source, torch.stack([grid_x, grid_y], dim=-1), align_corners=False)
    inside = ((grid_x.abs() < 1) & (grid_y.abs() < 1)).float()
    difference = (warped[:, 0] - gs_small.float() / 255).abs() * inside
    return difference.mean(dim=(1, 2))
