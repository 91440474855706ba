#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a model that the program runs out of a checkpoint of the reference network.

  convert_checkpoint.py RS_Real.pt -o FOLDER        then: rs-stabilize correct --model FOLDER ...
Reads the published checkpoints (a dict with `model` and `ema`), those of train.py, and bare state
dicts, as data: code in the file is refused, not run. The averaged weights are taken unless --raw
asks for the others. FOLDER gets model.json and network.pt (TorchScript).
"""

from __future__ import annotations

import argparse
import hashlib
import json
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from diffusion import OBJECTIVES, NoiseSchedule
from plain_load import load_plain
from reference_net import PATCH_ROWS, ReferenceDiffusion

AVERAGED_PREFIX = "ema_model."  # beside "online_model.", a second copy of the raw weights
NETWORK_PREFIX = "model."
TIMESTEPS = 1000
SAMPLING = {"steps": 8, "eta": 1, "clip_range": 1}  # as published
SCHEDULES = {"linear": NoiseSchedule.linear, "cosine": NoiseSchedule.cosine}


def tensors_of(values: Any, prefix: str = "") -> dict[str, Tensor]:
    """The tensors of a dict whose keys begin with `prefix`, which is cut off."""
    if not isinstance(values, dict):
        return {}
    return {
        key[len(prefix) :]: value
        for key, value in values.items()
        if isinstance(key, str) and key.startswith(prefix) and isinstance(value, Tensor)
    }


def select_weights(checkpoint: Any, raw: bool) -> tuple[dict[str, Tensor], str]:
    """The state dict of one set of weights, and what set it is."""
    if not isinstance(checkpoint, dict):
        raise ValueError("it holds no dict")
    if not isinstance(checkpoint.get("model"), dict):
        state, which = tensors_of(checkpoint), "bare"
    elif raw:
        state, which = tensors_of(checkpoint["model"]), "raw"
    else:
        average = checkpoint.get("ema")
        state, which = tensors_of(average, AVERAGED_PREFIX) or tensors_of(average), "averaged"
        if not state:
            raise ValueError("it has no averaged weights under `ema`; --raw takes the others")
    if state and not any(key.startswith(NETWORK_PREFIX) for key in state):
        state = {NETWORK_PREFIX + key: value for key, value in state.items()}
    return state, which


def recognise_schedule(state: dict[str, Tensor]) -> tuple[str, NoiseSchedule, str]:
    """Schedule and objective from the tables beside the weights; without tables, the published."""
    betas = state.get("betas")
    if betas is None:
        return "linear", NoiseSchedule.linear(TIMESTEPS), "x0"
    for name, make in SCHEDULES.items():
        schedule = make(betas.numel())
        if torch.allclose(schedule.betas.float(), betas.float(), rtol=1e-4):
            break
    else:
        raise ValueError("its noise schedule is neither linear nor cosine")
    weight = state.get("loss_weight", torch.zeros(1))
    fitting = [
        objective
        for objective in OBJECTIVES
        if weight.shape == betas.shape
        and torch.allclose(schedule.tables(objective)["loss_weight"], weight.float(), rtol=1e-3)
    ]
    return name, schedule, fitting[0] if fitting else "x0"


def shape_of_network(state: dict[str, Tensor]) -> dict[str, Any]:
    """Arguments of ReferenceUNet, from the sizes of the weights."""
    try:
        width = state["model.init_conv_1.weight"].shape[0]
        levels = [f"model.downs.{i}.3.weight" for i in range(16)]
        return {
            "width": width,
            "multipliers": [state[key].shape[0] // width for key in levels if key in state],
            "field_size": state["model.rs1.pe"].shape[-1] // PATCH_ROWS,
        }
    except (KeyError, IndexError) as error:
        raise ValueError(f"it is no reference network: no {error}") from None


def load_network(state: dict[str, Tensor]) -> tuple[ReferenceDiffusion, dict[str, Any]]:
    """The network with these weights, and the model file's account of it. All keys must fit."""
    shape = shape_of_network(state)
    name, schedule, objective = recognise_schedule(state)
    network = ReferenceDiffusion(schedule, objective, **shape)
    expected = network.state_dict()
    tables = {key: value for key, value in expected.items() if not key.startswith(NETWORK_PREFIX)}
    for key, value in expected.items():
        found = state.get(key, tables.get(key))
        if found is None or found.shape != value.shape:
            size = "missing" if found is None else f"of size {tuple(found.shape)}"
            raise ValueError(f"its {key} is {size}, not of size {tuple(value.shape)}")
        if not torch.isfinite(found).all():
            raise ValueError(f"its {key} holds numbers that are not finite")
    unknown = sorted(set(state) - set(expected))
    if unknown:
        raise ValueError(f"its {unknown[0]} is no part of the reference network")
    network.load_state_dict({**state, **tables})
    size = shape["field_size"]
    account = {
        "condition": {"kind": "rgb", "channels": 3, "rows": size, "columns": size},
        "motion": {"kind": "dense-field", "rows": size, "columns": size},
        "diffusion": {"steps": schedule.steps, "schedule": name, "objective": objective},
        "sampling": SAMPLING,
    }
    return network.eval(), account


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    sha = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            sha.update(block)
    return sha.hexdigest()


def write_model(network: ReferenceDiffusion, account: dict[str, Any], folder: Path) -> None:
    """network.pt and, last, model.json; each is written beside its name and renamed when whole."""
    folder.mkdir(parents=True, exist_ok=True)
    weights, description = folder / "network.pt", folder / "model.json"
    part = folder / "network.part"
    torch.jit.script(network.model).save(str(part))
    part.replace(weights)
    account["weights"] = {"network": {"file": weights.name, "sha256": digest(weights)}}
    part = folder / "model.part"
    part.write_text(json.dumps(account, indent=2) + "\n")
    part.replace(description)


def convert(checkpoint_path: Path, folder: Path, raw: bool = False) -> str:
    """Converts one file; the sentence says what was made."""
    checkpoint = load_plain(checkpoint_path)
    try:
        state, which = select_weights(checkpoint, raw)
        network, account = load_network(state)
        reference_row = checkpoint.get("reference_row", "first")
        if reference_row not in ("first", "middle"):
            raise ValueError("its reference_row is neither first nor middle")
    except ValueError as error:
        raise SystemExit(f"{checkpoint_path}: cannot be converted: {error}") from None
    head = {"format": "rs-stabilize model", "version": 1, "name": "reference", "backend": "torch"}
    account["motion"]["reference_row"] = reference_row
    account["training"] = {"source": checkpoint_path.name, "weights": which}
    if isinstance(checkpoint.get("step"), int):
        account["training"]["step"] = checkpoint["step"]
    write_model(network, {**head, **account}, folder)
    diffusion = account["diffusion"]
    return (
        f"{folder}: {which} weights, {diffusion['schedule']} schedule of {diffusion['steps']} steps, "
        f"objective {diffusion['objective']}, fields zero on the {reference_row} row"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--raw", action="store_true", help="the weights that were not averaged")
    arguments = parser.parse_args()
    print(convert(arguments.checkpoint, arguments.output, arguments.raw))


if __name__ == "__main__":
    main()
