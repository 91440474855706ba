# SPDX-License-Identifier: Apache-2.0
"""Networks by name, and the files that training writes and everything else reads.

A checkpoint is a dict: `net` and `config` say which network, `objective` what it was trained for;
`model` and `ema` are its weights and their average; `step`, `optimizer`, `ema_step`, `scaler` are
what resuming needs; `reference_row` says where the fields it learned are zero. Random numbers
follow from (seed, step), see train.py.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from torch import nn

from compact_net import CompactConfig, CompactNet
from diffusion import NoiseSchedule
from image_net import ImageNet
from plain_load import load_plain
from reference_net import ReferenceDiffusion

TIMESTEPS = 1000

NETS = ("compact", "reference", "image")


def make_net(name: str, config: dict[str, Any]) -> nn.Module:
    if name == "compact":
        return CompactNet(CompactConfig(**config))
    if name == "image":
        return ImageNet(**config)
    return ReferenceDiffusion(NoiseSchedule.linear(TIMESTEPS), "x0", **config)


def config_of(net: nn.Module) -> dict[str, Any]:
    return asdict(net.config) if isinstance(net, CompactNet) else {}


def save(path: Path, state: dict[str, Any]) -> None:
    """Written beside and renamed, so that a run that is cut off keeps the last whole one."""
    part = path.with_suffix(".part")
    torch.save(state, part)
    part.rename(path)


def load(path: Path) -> dict[str, Any]:
    """Tensors on the CPU; pickled code in the file is not executed."""
    state = load_plain(path)
    state.setdefault("net", "compact")
    state.setdefault("objective", "diffusion")
    return state


def load_averaged(path: Path) -> tuple[nn.Module, dict[str, Any]]:
    """The network with its averaged weights, ready to run, and the whole checkpoint."""
    state = load(path)
    net = make_net(state["net"], state["config"])
    net.load_state_dict(state["ema"])
    return net.eval(), state
