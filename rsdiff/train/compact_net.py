# SPDX-License-Identifier: Apache-2.0
"""The compact network: an encoder that runs once per image, a denoiser that runs every step.

Encoder: orientation planes (and a small grey picture) on a grid of row bands x columns
  -> residual 3x3 convolutions -> intra-patch attention (between the columns of one band)
  -> one token per band -> inter-patch attention (between bands) -> features, C x bands.
Denoiser: (noisy curve 3 x bands, time, features) -> clean curve, by attention between bands.

Only convolutions, BatchNorm (folded at export), ReLU, plain matmul/softmax and reshape on fixed
shapes, so that OpenCV's DNN module runs it. All tokens are kept as N x C x bands x 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import nn

import orientation_planes as planes_module
from rotation_curve import BANDS

TIME_CHANNELS = 16
AXES = 3
GRAY_CHANNELS = planes_module.GRAY_PER_CELL[0] * planes_module.GRAY_PER_CELL[1]
CONDITION_CHANNELS = 2 * planes_module.PLANES + GRAY_CHANNELS + 1


@dataclass
class CompactConfig:
    """Sizes of the network, and what its ablations leave out."""

    width: int = 40  # channels at full grid
    deep_width: int = 64  # channels after the columns were halved
    feature_width: int = 96
    denoiser_width: int = 80
    fine_blocks: int = 1
    deep_blocks: int = 1
    inter_blocks: int = 2
    denoiser_blocks: int = 2
    heads: int = 4
    use_planes: bool = True
    use_gray: bool = True
    intra_patch: bool = True
    inter_patch: bool = True
    integrate: bool = True  # predict slopes per band and sum them up


def time_features(t: torch.Tensor, total: int) -> torch.Tensor:
    """N x TIME_CHANNELS: cosine and sine of t / total * pi/2 * 2^k."""
    octaves = 2.0 ** torch.arange(TIME_CHANNELS // 2, device=t.device) * (math.pi / 2)
    phase = (t.float() / total)[:, None] * octaves
    return torch.cat([phase.cos(), phase.sin()], dim=1)


def _conv(inside: int, outside: int, kernel=1, stride=1, padding=0) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(inside, outside, kernel, stride, padding, bias=False), nn.BatchNorm2d(outside)
    )


class ResidualBlock(nn.Module):
    """Two 3x3 convolutions around which the input passes."""

    def __init__(self, width: int):
        super().__init__()
        self.first = _conv(width, width, 3, 1, 1)
        self.second = _conv(width, width, 3, 1, 1)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return torch.relu(x + self.second(torch.relu(self.first(x))))


class GridAttention(nn.Module):
    """Self-attention along a side of a grid, residual: columns of a band, or bands of a column."""

    def __init__(self, width: int, heads: int, rows: int, columns: int, along_rows: bool):
        super().__init__()
        self.heads, self.rows, self.columns, self.along_rows = heads, rows, columns, along_rows
        self.depth = width // heads
        self.query_key_value = _conv(width, 3 * width)
        self.out = _conv(width, width)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        tokens = self.rows if self.along_rows else self.columns
        qkv = self.query_key_value(x)

        def tokens_of(part: torch.Tensor) -> torch.Tensor:
            """N x (heads depth) x rows x columns -> (N heads other side) x tokens x depth."""
            if self.columns == 1:
                return part.reshape(-1, self.depth, tokens).transpose(1, 2)
            part = part.reshape(-1, self.depth, self.rows, self.columns)
            order = (0, 3, 2, 1) if self.along_rows else (0, 2, 3, 1)
            return part.permute(*order).reshape(-1, tokens, self.depth)

        query, key, value = (tokens_of(p) for p in qkv.chunk(3, dim=1))
        weight = torch.softmax(query @ key.transpose(1, 2) * self.depth**-0.5, dim=-1)
        mixed = weight @ value
        width = self.heads * self.depth
        if self.columns == 1:
            mixed = mixed.transpose(1, 2).reshape(-1, width, tokens, 1)
        else:
            sides = (self.columns, self.rows) if self.along_rows else (self.rows, self.columns)
            shape = (-1, *sides, self.depth)
            order = (0, 3, 2, 1) if self.along_rows else (0, 3, 1, 2)
            mixed = mixed.reshape(*shape).permute(*order)
            mixed = mixed.reshape(-1, width, self.rows, self.columns)
        return x + self.out(mixed)


class Mixer(nn.Module):
    """Two layers over the channels that see `reach` neighbouring bands, residual."""

    def __init__(self, width: int, reach: int):
        super().__init__()
        self.inner = _conv(width, width, (reach, 1), 1, (reach // 2, 0))
        self.outer = _conv(width, width)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x + self.outer(torch.relu(self.inner(x)))


def band_mixers(count: int, width: int, config: CompactConfig) -> nn.Sequential:
    """Inter-patch attention between the bands, then their near neighbours, `count` times."""
    blocks: list[nn.Module] = []
    for _ in range(count):
        if config.inter_patch:
            blocks.append(GridAttention(width, config.heads, BANDS, 1, True))
        blocks.append(Mixer(width, 5 if config.inter_patch else 1))
    return nn.Sequential(*blocks)


class Encoder(nn.Module):
    """From a picture's condition to one vector of features per band."""

    def __init__(self, config: CompactConfig):
        super().__init__()
        self.config = config
        rows, columns = planes_module.GRID_ROWS, planes_module.GRID_COLUMNS
        halved = columns // 2
        self.stem = nn.Conv2d(CONDITION_CHANNELS, config.width, 1)
        self.position = nn.Parameter(torch.zeros(1, config.width, rows, columns))
        self.stem_norm = nn.BatchNorm2d(config.width)
        self.fine = nn.Sequential(*(ResidualBlock(config.width) for _ in range(config.fine_blocks)))
        self.down = _conv(config.width, config.deep_width, 3, (1, 2), 1)
        self.deep = nn.Sequential(
            *(ResidualBlock(config.deep_width) for _ in range(config.deep_blocks))
        )
        self.intra = (
            GridAttention(config.deep_width, config.heads, rows, halved, False)
            if config.intra_patch
            else nn.Identity()
        )
        self.gather = _conv(config.deep_width, config.feature_width, (1, halved))
        self.inter = band_mixers(config.inter_blocks, config.feature_width, config)

    def forward(self, condition: torch.Tensor) -> torch.Tensor:
        """N x CONDITION_CHANNELS x GRID_ROWS x GRID_COLUMNS -> N x feature_width x BANDS x 1."""
        x = torch.relu(self.stem_norm(self.stem(condition) + self.position))
        x = self.deep(torch.relu(self.down(self.fine(x))))
        return self.inter(torch.relu(self.gather(self.intra(x))))


def integration_matrix() -> torch.Tensor:
    """BANDS x BANDS: slopes per readout in the bands -> curve at their centres, 0 in the middle."""
    total = torch.tril(torch.ones(BANDS, BANDS), -1) + 0.5 * torch.eye(BANDS)
    total = total - 0.5 * (total[BANDS // 2 - 1] + total[BANDS // 2])
    return total * (4.0 / BANDS)


class Denoiser(nn.Module):
    """Tells how fast the camera turned in each band (which is what leaning lines show) and sums."""

    def __init__(self, config: CompactConfig):
        super().__init__()
        width = config.denoiser_width
        self.enter = _conv(AXES + TIME_CHANNELS + config.feature_width, width)
        self.position = nn.Parameter(torch.zeros(1, width, BANDS, 1))
        self.blocks = band_mixers(config.denoiser_blocks, width, config)
        self.slopes = nn.Conv2d(width, AXES, 1)
        self.direct = nn.Conv2d(width + AXES + TIME_CHANNELS, AXES, 1)
        nn.init.zeros_(self.direct.weight)
        matrix = integration_matrix() if config.integrate else torch.eye(BANDS)
        self.register_buffer("integration", matrix.T.contiguous())

    def forward(self, x: torch.Tensor, time: torch.Tensor, features: torch.Tensor) -> torch.Tensor:
        """x: N x 3 x BANDS x 1; time: N x TIME_CHANNELS x BANDS x 1; features from the encoder."""
        noisy = torch.cat([x, time], dim=1)
        h = torch.relu(self.enter(torch.cat([noisy, features], dim=1)) + self.position)
        h = self.blocks(h)
        summed = (self.slopes(h).reshape(-1, AXES, BANDS) @ self.integration).unsqueeze(-1)
        return summed + self.direct(torch.cat([h, noisy], dim=1))


class CompactNet(nn.Module):
    """Both halves; the key names of its state dict are those of the shipped checkpoints."""

    def __init__(self, config: CompactConfig | None = None):
        super().__init__()
        self.config = config or CompactConfig()
        self.encoder = Encoder(self.config)
        self.denoiser = Denoiser(self.config)

    def encode(self, condition: torch.Tensor) -> torch.Tensor:
        """As Encoder."""
        return self.encoder(condition)

    def denoise(
        self, x: torch.Tensor, t: torch.Tensor, features: torch.Tensor, total: int
    ) -> torch.Tensor:
        """As Denoiser, for times t (N integers) of `total`."""
        time = time_features(t, total)[:, :, None, None].expand(-1, -1, BANDS, 1)
        return self.denoiser(x, time, features)


def condition_tensor(
    planes: torch.Tensor, gray: torch.Tensor, aspect: torch.Tensor, config: CompactConfig
) -> torch.Tensor:
    """Bytes of a batch -> N x channels x rows x columns: planes, grey cells, x in image heights."""
    rows, columns = planes_module.GRID_ROWS, planes_module.GRID_COLUMNS
    cell_rows, cell_columns = planes_module.GRAY_PER_CELL
    gray = gray.float()
    mean = gray.mean(dim=(1, 2), keepdim=True)
    deviation = gray.std(dim=(1, 2), keepdim=True, unbiased=False)
    gray = (gray - mean) / (deviation + 8.0)
    cells = gray.reshape(-1, rows, cell_rows, columns, cell_columns).permute(0, 2, 4, 1, 3)
    cells = cells.reshape(-1, cell_rows * cell_columns, rows, columns)
    across = (torch.arange(columns, device=aspect.device) + 0.5) / columns - 0.5
    across = (aspect[:, None, None, None] * across).expand(-1, 1, rows, columns)
    energy = planes.float() / planes_module.BYTE_SCALE
    squared = energy**2
    floor = 0.05 * squared.sum(dim=1, keepdim=True).mean(dim=(2, 3), keepdim=True) + 1e-3
    upright, level = squared.split([planes_module.UPRIGHT_BINS, planes_module.LEVEL_BINS], dim=1)
    shares = torch.cat([f / (f.sum(dim=1, keepdim=True) + floor) for f in (upright, level)], dim=1)
    channels = [energy, shares.sqrt()]
    if not config.use_planes:
        channels = [torch.zeros_like(c) for c in channels]
    if not config.use_gray:
        cells = torch.zeros_like(cells)
    return torch.cat([*channels, cells, across], dim=1)
