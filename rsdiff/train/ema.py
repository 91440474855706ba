# SPDX-License-Identifier: Apache-2.0
"""Running average of a network's weights and norm statistics."""

from __future__ import annotations

import torch


class Ema:
    """values <- decay * values + (1 - decay) * weights; the first steps forget faster."""

    def __init__(self, net: torch.nn.Module, decay: float):
        self.decay = decay
        self.values = {k: v.detach().clone() for k, v in net.state_dict().items()}
        self.step = 0

    @torch.no_grad()
    def update(self, net: torch.nn.Module) -> None:
        self.step += 1
        decay = min(self.decay, (1 + self.step) / (10 + self.step))
        for key, value in net.state_dict().items():
            if value.dtype.is_floating_point:
                self.values[key].lerp_(value, 1 - decay)
            else:
                self.values[key].copy_(value)

    def load(self, values: dict[str, torch.Tensor], step: int) -> None:
        for key, value in self.values.items():
            value.copy_(values[key])
        self.step = step
