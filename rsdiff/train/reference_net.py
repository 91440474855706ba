# SPDX-License-Identifier: Apache-2.0
"""The published image-to-motion U-Net, such that its checkpoints load key by key.

A noisy motion field (N x 2 x H x W, network units) and the rolling-shutter image (N x 3 x H x W,
values in [-1, 1]) give the clean field. H and W are multiples of 8; the published size is 64 x 64.
Module and parameter names are those of the published checkpoints, which is why some are terse.

The order of float operations is the published one: with the weights of the golden test the network
amplifies rounding ten-thousandfold, and the same kernels then give the same bits. What depends on
the image only is computed once per image by `encode`; `denoise` is one step of a batch of samples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from diffusion import NoiseSchedule

GROUPS = 8
ATTENTION_HEADS = 4
ATTENTION_HEAD_WIDTH = 32
PATCH_HEADS = 2
PATCH_ROWS = 4


class RMSNorm(nn.Module):
    """Scales each pixel's channel vector to length sqrt(channels), then by a learned gain."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.g = nn.Parameter(torch.ones(1, channels, 1, 1))
        self.scale = math.sqrt(channels)

    def forward(self, x: Tensor) -> Tensor:
        return F.normalize(x, dim=1) * self.g * self.scale


def split_heads(x: Tensor, heads: int, head_width: int) -> list[Tensor]:
    """q, k and v (N x heads x head_width x pixels) of a 1x1 convolution's output."""
    size = [x.shape[0], heads, head_width, x.shape[2] * x.shape[3]]
    return [part.reshape(size) for part in x.chunk(3, dim=1)]


class LinearAttention(nn.Module):
    """Attention whose cost grows with the pixels, not with their square."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        hidden = ATTENTION_HEADS * ATTENTION_HEAD_WIDTH
        self.heads, self.head_width = ATTENTION_HEADS, ATTENTION_HEAD_WIDTH
        self.to_qkv = nn.Conv2d(channels, 3 * hidden, 1, bias=False)
        self.to_out = nn.Sequential(nn.Conv2d(hidden, channels, 1), RMSNorm(channels))

    def forward(self, x: Tensor) -> Tensor:
        q, k, v = split_heads(self.to_qkv(x), self.heads, self.head_width)
        q = q.softmax(dim=-2) * self.head_width**-0.5
        context = torch.einsum("bhdn,bhen->bhde", k.softmax(dim=-1), v)
        out = torch.einsum("bhde,bhdn->bhen", context, q)
        return self.to_out(out.reshape(x.shape[0], -1, x.shape[2], x.shape[3]))


class Attention(nn.Module):
    """Full attention over all pixels, for the smallest level."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        hidden = ATTENTION_HEADS * ATTENTION_HEAD_WIDTH
        self.heads, self.head_width = ATTENTION_HEADS, ATTENTION_HEAD_WIDTH
        self.to_qkv = nn.Conv2d(channels, 3 * hidden, 1, bias=False)
        self.to_out = nn.Conv2d(hidden, channels, 1)

    def forward(self, x: Tensor) -> Tensor:
        q, k, v = split_heads(self.to_qkv(x), self.heads, self.head_width)
        weights = torch.einsum("bhdi,bhdj->bhij", q * self.head_width**-0.5, k).softmax(dim=-1)
        out = torch.einsum("bhij,bhdj->bhid", weights, v)
        out = out.permute(0, 1, 3, 2).reshape(x.shape[0], -1, x.shape[2], x.shape[3])
        return self.to_out(out)


class PreNorm(nn.Module):
    """Normalises before the wrapped layer."""

    def __init__(self, channels: int, fn: nn.Module) -> None:
        super().__init__()
        self.fn = fn
        self.norm = RMSNorm(channels)

    def forward(self, x: Tensor) -> Tensor:
        return self.fn(self.norm(x))


class Residual(nn.Module):
    """Adds the wrapped layer's output to its input."""

    def __init__(self, fn: nn.Module) -> None:
        super().__init__()
        self.fn = fn

    def forward(self, x: Tensor) -> Tensor:
        return self.fn(x) + x


class PatchAttention(nn.Module):
    """Attention inside patches of full rows: rows exposed close in time share a motion."""

    def __init__(self, channels: int, row_width: int) -> None:
        super().__init__()
        self.heads, self.rows = PATCH_HEADS, PATCH_ROWS
        # Published checkpoints carry it; the published network does not use it.
        self.pe = nn.Parameter(torch.zeros(1, 1, PATCH_ROWS * row_width))
        self.q = nn.Linear(channels, channels, bias=False)
        self.k = nn.Linear(channels, channels, bias=False)
        self.v = nn.Linear(channels, channels, bias=False)
        self.proj = nn.Linear(channels, channels, bias=False)

    def forward(self, x: Tensor) -> Tensor:
        n, channels, height, width = x.shape
        head_width = channels // self.heads
        pixels = x.permute(0, 2, 3, 1).reshape(-1, self.rows * width, channels)
        split = [pixels.shape[0], pixels.shape[1], self.heads, head_width]
        q = self.q(pixels).reshape(split).transpose(1, 2)
        k = self.k(pixels).reshape(split).transpose(1, 2)
        v = self.v(pixels).reshape(split).transpose(1, 2)
        weights = (q @ k.transpose(-2, -1) * head_width**-0.5).softmax(dim=-1)
        out = self.proj((weights @ v).transpose(1, 2).reshape(pixels.shape))
        return out.reshape(n, height, width, channels).permute(0, 3, 1, 2)


class Block(nn.Module):
    """3x3 convolution, GroupNorm, optional scale and shift, SiLU."""

    def __init__(self, channels_in: int, channels_out: int) -> None:
        super().__init__()
        self.proj = nn.Conv2d(channels_in, channels_out, 3, padding=1)
        self.norm = nn.GroupNorm(GROUPS, channels_out)

    def forward(self, x: Tensor) -> Tensor:
        return F.silu(self.norm(self.proj(x)))

    def modulated(self, x: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
        return F.silu(self.norm(self.proj(x)) * (scale + 1) + shift)


class ResidualBlock(nn.Module):
    """Fuses field and image features, then two convolutions modulated by time and class."""

    def __init__(self, channels_in: int, channels_out: int, embedding: int) -> None:
        super().__init__()
        self.mlp = nn.Sequential(nn.SiLU(), nn.Linear(embedding, 2 * channels_out))
        self.block1 = Block(channels_in, channels_out)
        self.block2 = Block(channels_out, channels_out)
        self.block3 = Block(2 * channels_in, channels_in)
        self.res_conv = (
            nn.Identity() if channels_in == channels_out else nn.Conv2d(channels_in, channels_out, 1)
        )

    def forward(self, x: Tensor, image: Tensor, embedding: Tensor) -> Tensor:
        x = self.block3(torch.cat((x, image), dim=1))
        scale, shift = self.mlp(embedding)[:, :, None, None].chunk(2, dim=1)
        h = self.block2(self.block1.modulated(x, scale, shift))
        return h + self.res_conv(x)


class SinusoidalEmbedding(nn.Module):
    """Time step (N, floating) to N x width: sines, then cosines, of falling frequencies."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.half = width // 2

    def forward(self, time: Tensor) -> Tensor:
        exponent = torch.arange(self.half, device=time.device, dtype=time.dtype)
        frequencies = torch.exp(exponent * (-math.log(10000.0) / (self.half - 1)))
        angles = time[:, None] * frequencies[None, :]
        return torch.cat((angles.sin(), angles.cos()), dim=-1)


class ReferenceUNet(nn.Module):
    """The published denoiser. `forward` is one call; samplers use `encode` and `denoise`."""

    def __init__(
        self, width: int = 64, multipliers: Sequence[int] = (1, 2, 4, 8), field_size: int = 64
    ) -> None:
        """Defaults are the published ones; `field_size` matters to the unused `pe` only."""
        super().__init__()
        embedding = 4 * width
        both = 2 * embedding
        # The order of registration is that of the published state dict.
        self.null_classes_emb = nn.Parameter(torch.randn(width))
        self.init_conv = nn.Conv2d(2, 3, 7, padding=3)
        self.init_conv_1 = nn.Conv2d(3, width, 7, padding=3)
        self.time_mlp = nn.Sequential(
            SinusoidalEmbedding(width),
            nn.Linear(width, embedding),
            nn.GELU(),
            nn.Linear(embedding, embedding),
        )
        self.classes_emb = nn.Embedding(1, width)
        self.classes_mlp = nn.Sequential(
            nn.Linear(width, embedding), nn.GELU(), nn.Linear(embedding, embedding)
        )
        self.rs1 = PatchAttention(width, field_size)
        self.rs2 = PatchAttention(width, field_size)

        widths = [width] + [width * m for m in multipliers]
        levels = list(zip(widths[:-1], widths[1:]))
        self.downs = nn.ModuleList()
        self.ups = nn.ModuleList()
        for level, (narrow, wide) in enumerate(levels):
            last = level == len(levels) - 1
            self.downs.append(
                nn.ModuleList(
                    [
                        ResidualBlock(narrow, narrow, both),
                        ResidualBlock(narrow, narrow, both),
                        Residual(PreNorm(narrow, LinearAttention(narrow))),
                        nn.Conv2d(narrow, wide, 3, padding=1)
                        if last
                        else nn.Conv2d(narrow, wide, 4, stride=2, padding=1),
                    ]
                )
            )
        for level, (narrow, wide) in enumerate(reversed(levels)):
            last = level == len(levels) - 1
            conv = nn.Conv2d(wide, narrow, 3, padding=1)
            self.ups.append(
                nn.ModuleList(
                    [
                        ResidualBlock(wide + narrow, wide, both),
                        ResidualBlock(wide + narrow, wide, both),
                        Residual(PreNorm(wide, LinearAttention(wide))),
                        conv if last else nn.Sequential(nn.Upsample(scale_factor=2.0), conv),
                    ]
                )
            )
        widest = widths[-1]
        self.mid_block1 = ResidualBlock(widest, widest, both)
        self.mid_attn = Residual(PreNorm(widest, Attention(widest)))
        self.mid_block2 = ResidualBlock(widest, widest, both)
        self.final_res_block = ResidualBlock(2 * width, width, both)
        self.final_conv = nn.Conv2d(width, 2, 1)

    @torch.jit.export
    def encode(self, image: Tensor) -> list[Tensor]:
        """The image's features at every level of the way down, the middle, the way up, the end."""
        y = self.init_conv_1(image)
        first = y
        features: list[Tensor] = []
        skips: list[Tensor] = []
        for level in self.downs:
            features.append(y)
            skips.append(y)
            y = level[3](y)
        features.append(y)
        for level in self.ups:
            features.append(torch.cat((y, skips.pop()), dim=1))
            y = level[3](y)
        features.append(torch.cat((y, first), dim=1))
        return features

    @torch.jit.export
    def denoise(self, x: Tensor, time: Tensor, features: list[Tensor], drop: Tensor) -> Tensor:
        """Network output for the noisy field x (N x 2 x H x W) at time steps `time` (N).

        `features` come from `encode`, of N images or of one that all samples share. Where `drop`
        (N, bool) is set the class is replaced by the null class: what the published guidance calls
        dropping the condition. The image stays.
        """
        n = x.shape[0]
        features = [f.expand(n, -1, -1, -1) for f in features]
        classes = torch.where(drop[:, None], self.null_classes_emb, self.classes_emb.weight)
        embedding = torch.cat((self.time_mlp(time.to(x.dtype)), self.classes_mlp(classes)), dim=-1)
        x = self.init_conv_1(self.init_conv(x))
        first = x
        skips: list[Tensor] = []
        used = 0
        for level in self.downs:
            x = level[0](x, features[used], embedding)
            skips.append(x)
            x = level[2](level[1](x, features[used], embedding))
            skips.append(x)
            x = level[3](x)
            used += 1
        x = self.mid_attn(self.mid_block1(x, features[used], embedding))
        x = self.mid_block2(x, features[used], embedding)
        for level in self.ups:
            used += 1
            x = level[0](torch.cat((x, skips.pop()), dim=1), features[used], embedding)
            x = level[1](torch.cat((x, skips.pop()), dim=1), features[used], embedding)
            x = level[3](level[2](x))
        x = self.final_res_block(torch.cat((x, first), dim=1), features[-1], embedding)
        return self.final_conv(x + self.across_patches(x))

    def across_patches(self, x: Tensor) -> Tensor:
        """Attention inside patches, then inside patches shifted by half of one."""
        half = self.rs2.rows // 2
        x = self.rs1(x)
        inner = self.rs2(x[:, :, half:-half])
        return torch.cat((x[:, :, :half], inner, x[:, :, -half:]), dim=2)

    def forward(self, x: Tensor, time: Tensor, image: Tensor, drop: Tensor) -> Tensor:
        return self.denoise(x, time, self.encode(image), drop)


class ReferenceDiffusion(nn.Module):
    """The network with the schedule's tables, as a published checkpoint stores them."""

    def __init__(self, schedule: NoiseSchedule, objective: str = "x0", **network: Any) -> None:
        """`network`: what ReferenceUNet takes."""
        super().__init__()
        for name, values in schedule.tables(objective).items():
            self.register_buffer(name, values)
        self.model = ReferenceUNet(**network)


def field_to_pixels(field: Tensor) -> Tensor:
    """Network units to displacement in px at the field's own size: times (W-1) and (H-1)."""
    height, width = field.shape[-2:]
    return field * field.new_tensor([width - 1.0, height - 1.0])[:, None, None]
