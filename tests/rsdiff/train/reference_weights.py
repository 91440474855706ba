# SPDX-License-Identifier: Apache-2.0
"""Weights by formula, so that stored answers need no stored weights.

For a parameter `key` with n values in row-major order, c = (sum of the key's ASCII codes mod 1000)
/ 1000 * 2 pi and i = 0 .. n-1, in double, then float32:
  `weight` of two or more dimensions: sin(0.7 i + 0.0001 i (i mod 7) + c) * 1.5 / sqrt(fan-in)
  `weight` of one dimension, or `g`:  1 + 0.1 sin(0.7 i + c)
  all else:                           0.05 sin(0.7 i + c)
and 0.08 times that for the last convolution. They make the network amplify rounding about
ten-thousandfold, so answers repeat only on the kernels that made them: see
cmake/RsstabReferenceTests.cmake.
"""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import torch


def golden_file() -> Path | None:
    """Inputs and the published implementation's outputs; part of the optional development data."""
    beside = Path(__file__).resolve().parents[4] / "shared" / "data"
    file = Path(os.environ.get("RSSTAB_DATA", beside)) / "reference_net" / "golden.npz"
    return file if file.exists() else None


def formula_weight(key: str, shape: tuple[int, ...]) -> np.ndarray:
    i = np.arange(math.prod(shape), dtype=np.float64)
    c = (sum(key.encode("ascii")) % 1000) / 1000 * 2 * math.pi
    kind = key.rsplit(".", 1)[-1]
    if kind == "weight" and len(shape) >= 2:
        values = np.sin(0.7 * i + 0.0001 * i * (i % 7) + c)
        values *= 1.5 / math.sqrt(math.prod(shape[1:]))
    elif kind in ("weight", "g"):
        values = 1 + 0.1 * np.sin(0.7 * i + c)
    else:
        values = 0.05 * np.sin(0.7 * i + c)
    if key.startswith("model.final_conv"):
        values *= 0.08
    return values.astype(np.float32).reshape(shape)


def formula_state(network: torch.nn.Module) -> dict[str, torch.Tensor]:
    """The state dict of a ReferenceDiffusion with every parameter by formula, tables as they are."""
    parameters = dict(network.named_parameters())
    return {
        key: torch.from_numpy(formula_weight(key, tuple(value.shape))) if key in parameters else value
        for key, value in network.state_dict().items()
    }
