# SPDX-License-Identifier: Apache-2.0
"""Differentiable first-order field of a rotation curve, and errors told as displacements.

To first order the backward field of a curve (a, b, r) is
  u = a - r*y,  v = b + r*x,   all in image heights, (x, y) from the image centre;
exact fields come from `igf`. What it leaves out grows as (x / focal length)^2: a few percent at two
widths, which is what losses and monitors need, more at the edges of wide angles.
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


def warp(picture: torch.Tensor, field: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """The picture I(x + G(x)) and which of its pixels have a source, N x 1 x rows x columns.

    picture: N x C x rows x columns; field: N x 2 x rows x columns, in widths and heights.
    """
    rows, columns = picture.shape[2:]
    y, x = torch.meshgrid(
        (torch.arange(rows) + 0.5) * 2 / rows - 1,
        (torch.arange(columns) + 0.5) * 2 / columns - 1,
        indexing="ij",
    )
    grid = torch.stack([x, y], dim=-1).to(field) + 2 * field.permute(0, 2, 3, 1)
    warped = F.grid_sample(picture, grid, align_corners=False)
    return warped, (grid.abs() < 1).all(dim=-1)[:, None]


def curve_warp_field(curve: torch.Tensor, aspect: torch.Tensor, rows: int, columns: int):
    """The first-order field of a curve on a picture's pixels, in widths and heights."""
    field = first_order_field(curve, aspect, columns)
    field = F.interpolate(field, size=(rows, columns), mode="bilinear", align_corners=False)
    return torch.stack([field[:, 0] / aspect[:, None, None], field[:, 1]], dim=1)


def photometric_loss(rs: torch.Tensor, gs: torch.Tensor, field: torch.Tensor) -> torch.Tensor:
    """Mean absolute difference of the warped RS picture (values 0..1) and the GS picture."""
    warped, inside = warp(rs, field)
    return ((warped - gs).abs() * inside).mean()
