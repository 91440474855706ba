# SPDX-License-Identifier: Apache-2.0
"""Image to image, the published ablation: predicts the corrected picture itself, small and grey."""

from __future__ import annotations

import torch
from torch import nn

from compact_net import ResidualBlock


class ImageNet(nn.Module):
    """A small residual encoder and decoder; about as many weights as the compact network."""

    def __init__(self, width: int = 32, deep_width: int = 64):
        super().__init__()
        self.enter = nn.Conv2d(1, width, 3, padding=1)
        self.fine = ResidualBlock(width)
        self.down = nn.Conv2d(width, deep_width, 4, stride=2, padding=1)
        self.deep = nn.Sequential(*(ResidualBlock(deep_width) for _ in range(3)))
        self.up = nn.ConvTranspose2d(deep_width, width, 4, stride=2, padding=1)
        self.leave = nn.Sequential(ResidualBlock(width), nn.Conv2d(width, 1, 3, padding=1))

    def forward(self, rs: torch.Tensor) -> torch.Tensor:
        """N x 1 x 48 x 64, values 0 to 1, to the same."""
        fine = self.fine(torch.relu(self.enter(rs - 0.5)))
        deep = self.deep(torch.relu(self.down(fine)))
        return rs + self.leave(torch.relu(self.up(deep)) + fine)
