# SPDX-License-Identifier: Apache-2.0
"""Where training runs: a CPU, one GPU, or several processes that torchrun started."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from dataclasses import dataclass

import torch
import torch.distributed as distributed
from torch import nn
from torch.nn.parallel import DistributedDataParallel

PRECISIONS = {"fp32": torch.float32, "fp16": torch.float16, "bf16": torch.bfloat16}


@dataclass(frozen=True)
class Place:
    """One process of a run."""

    device: torch.device
    rank: int = 0
    world: int = 1

    @property
    def is_first(self) -> bool:
        return self.rank == 0

    def parallel(self, learner: nn.Module, some_unused: bool) -> nn.Module:
        """The learner as called for training; gradients are averaged over all processes."""
        if self.world == 1:
            return learner
        ids = [self.device.index] if self.device.type == "cuda" else None
        return DistributedDataParallel(learner, ids, find_unused_parameters=some_unused)

    def agree(self, flag: bool) -> bool:
        """The first process' answer, in all of them."""
        if self.world == 1:
            return flag
        answer = torch.tensor([int(flag)], device=self.device)
        distributed.broadcast(answer, 0)
        return bool(answer.item())


@contextlib.contextmanager
def place() -> Iterator[Place]:
    """Joins the processes of a torchrun launch, if this is one."""
    world = int(os.environ.get("WORLD_SIZE", "1"))
    cuda = torch.cuda.is_available()
    local = int(os.environ.get("LOCAL_RANK", "0"))
    device = torch.device("cuda", local) if cuda else torch.device("cpu")
    if cuda:
        torch.cuda.set_device(device)
    if world == 1:
        yield Place(device)
        return
    distributed.init_process_group("nccl" if cuda else "gloo")
    try:
        yield Place(device, distributed.get_rank(), world)
    finally:
        distributed.destroy_process_group()


class MixedPrecision:
    """Forward pass in a shorter number format; small fp16 gradients are kept from vanishing."""

    def __init__(self, precision: str, device: torch.device):
        if precision == "fp16" and device.type != "cuda":
            raise SystemExit("--precision fp16 needs a CUDA device; bf16 also runs on CPUs")
        self.dtype = PRECISIONS[precision]
        self.device = device
        scales = precision == "fp16"
        if hasattr(torch.amp, "GradScaler"):
            self.scaler = torch.amp.GradScaler(device.type, enabled=scales)
        else:  # torch before 2.3
            self.scaler = torch.cuda.amp.GradScaler(enabled=scales)

    def forward(self) -> contextlib.AbstractContextManager:
        """What the forward pass runs in."""
        enabled = self.dtype != torch.float32
        # The CPU's autocast of torch 1.13 refuses float32 even when it is off.
        dtype = self.dtype if enabled else torch.bfloat16
        return torch.autocast(self.device.type, dtype=dtype, enabled=enabled)

    def step(self, loss: torch.Tensor, optimizer: torch.optim.Optimizer, net: nn.Module,
             largest_gradient: float) -> None:
        optimizer.zero_grad(set_to_none=True)
        self.scaler.scale(loss).backward()
        self.scaler.unscale_(optimizer)
        nn.utils.clip_grad_norm_(net.parameters(), largest_gradient)
        self.scaler.step(optimizer)
        self.scaler.update()
