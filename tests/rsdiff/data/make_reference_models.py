# SPDX-License-Identifier: Apache-2.0
"""Writes models of the reference kind, by way of checkpoints, with answers to compare with.

  make_reference_models.py FOLDER
FOLDER/small: few channels, weights by chance of a fixed seed; answers.npz from PyTorch.
FOLDER/published: the published size, weights by formula; answers.npz is the development data's
golden.npz, not compressed. Left out when that is absent.
Exits 77, a skip, without PyTorch.
"""

from __future__ import annotations

import importlib.util
import shutil
import sys
from pathlib import Path

if importlib.util.find_spec("torch") is None or importlib.util.find_spec("numpy") is None:
    print("skipped: this Python has no torch or numpy")
    sys.exit(77)

import numpy as np
import torch

from convert_checkpoint import convert
from diffusion import NoiseSchedule
from reference_net import ReferenceDiffusion
from reference_weights import formula_state, golden_file

SMALL = {"width": 16, "multipliers": (1, 2), "field_size": 16}
BATCH = 3
TIME = 421


def write_model(state: dict[str, torch.Tensor], folder: Path) -> None:
    """As a published checkpoint, then converted."""
    checkpoint = folder / "checkpoint.pt"
    ema = {"initted": torch.tensor([True]), "step": torch.tensor([1])}
    ema |= {f"ema_model.{key}": value for key, value in state.items()}
    torch.save({"step": 1, "model": {}, "opt": {}, "ema": ema, "scaler": None}, checkpoint)
    print(convert(checkpoint, folder))
    checkpoint.unlink()


@torch.no_grad()
def write_small(folder: Path) -> None:
    torch.manual_seed(7)
    diffusion = ReferenceDiffusion(NoiseSchedule.linear(1000), **SMALL).eval()
    write_model(diffusion.state_dict(), folder)
    condition, x = torch.rand(1, 3, 16, 16) * 2 - 1, torch.randn(BATCH, 2, 16, 16)
    time = torch.full((BATCH,), TIME)
    features = diffusion.model.encode(condition)
    keep = torch.zeros(BATCH, dtype=torch.bool)
    answers = {
        "condition": condition,
        "x": x,
        "with_image": diffusion.model.denoise(x, time, features, keep),
        "without_image": diffusion.model.denoise(x, time, features, ~keep),
    }
    np.savez(folder / "answers.npz", **{name: value.numpy() for name, value in answers.items()})


def write_published(folder: Path, golden: Path) -> None:
    write_model(formula_state(ReferenceDiffusion(NoiseSchedule.linear(1000))), folder)
    with np.load(golden) as file:
        np.savez(folder / "answers.npz", **{name: file[name] for name in file.files})


def main() -> None:
    root = Path(sys.argv[1])
    shutil.rmtree(root, ignore_errors=True)
    (root / "small").mkdir(parents=True)
    write_small(root / "small")
    golden = golden_file()
    if golden is None:
        print("no golden.npz in the development data: only the small model was made")
        return
    (root / "published").mkdir()
    write_published(root / "published", golden)


if __name__ == "__main__":
    main()
