#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a checkpoint of the compact network as a model that the program runs (ONNX and JSON).

  export_onnx.py RUN/checkpoint.pt -o ../models/compact
The EMA weights are taken, every BatchNorm is folded into its convolution, and attention is written
so that OpenCV's DNN module (4.6 and newer) computes it rightly: fixed batch sizes, separate
convolutions for query, key and value, one layout change per matrix. The result is compared with
PyTorch before it is kept.
"""

from __future__ import annotations

import argparse
import copy
import hashlib
import inspect
import io
import json
import time
from pathlib import Path

import cv2
import numpy as np
import torch
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

import orientation_planes as planes_module
from calibration import draw_samples, spread_scale, true_curves
from checkpoint import TIMESTEPS, load_averaged
from compact_net import (
    AXES,
    CONDITION_CHANNELS,
    TIME_CHANNELS,
    CompactNet,
    GridAttention,
)
from data_source import as_tensors
from rotation_curve import BANDS, SCALE
from sample_pool import SamplePool

BATCH_SIZES = (1, 8)
OPSET = 11  # the newest that OpenCV 4.6 reads without gaps
CLIP_RANGE = 12.0  # network units: the largest motions of training, not of life
SAMPLING_STEPS = 4
SPREAD_SAMPLES = 16  # per picture, to measure their spread
TOLERANCE = 1e-3  # largest difference from PyTorch, network units


class ExportAttention(nn.Module):
    """GridAttention at a fixed batch size; the score's scale is folded into the query."""

    def __init__(self, source: GridAttention, batch: int):
        super().__init__()
        self.batch = batch
        self.heads, self.depth = source.heads, source.depth
        self.rows, self.columns = source.rows, source.columns
        self.along_rows = source.along_rows
        joint = fuse_conv_bn_eval(source.query_key_value[0], source.query_key_value[1])
        width = self.heads * self.depth
        parts = []
        for weight, bias in zip(joint.weight.split(width), joint.bias.split(width)):
            part = nn.Conv2d(width, width, 1)
            part.weight, part.bias = nn.Parameter(weight.clone()), nn.Parameter(bias.clone())
            parts.append(part)
        parts[0].weight.data *= self.depth**-0.5
        parts[0].bias.data *= self.depth**-0.5
        self.query, self.key, self.value = parts
        self.out = fuse_conv_bn_eval(source.out[0], source.out[1])

    def _matrices(self, x: torch.Tensor, depth_first: bool) -> torch.Tensor:
        """Groups x tokens x depth, or with the last two exchanged."""
        if self.columns == 1:  # the tokens are the only side: a view, at most transposed
            x = x.reshape(self.batch * self.heads, self.depth, self.rows)
            return x if depth_first else x.transpose(1, 2)
        x = x.reshape(self.batch * self.heads, self.depth, self.rows, self.columns)
        group, token = (3, 2) if self.along_rows else (2, 3)
        order = (0, group, 1, token) if depth_first else (0, group, token, 1)
        groups, tokens = x.shape[group], x.shape[token]
        shape = (self.depth, tokens) if depth_first else (tokens, self.depth)
        return x.permute(*order).reshape(self.batch * self.heads * groups, *shape)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        query = self._matrices(self.query(x), False)
        key = self._matrices(self.key(x), True)
        value = self._matrices(self.value(x), False)
        mixed = torch.softmax(query @ key, dim=-1) @ value
        if self.columns == 1:
            mixed = mixed.transpose(1, 2)
        elif self.along_rows:
            mixed = mixed.reshape(-1, self.columns, self.rows, self.depth).permute(0, 3, 2, 1)
        else:
            mixed = mixed.reshape(-1, self.rows, self.columns, self.depth).permute(0, 3, 1, 2)
        mixed = mixed.reshape(self.batch, self.heads * self.depth, self.rows, self.columns)
        return x + self.out(mixed)


def _fold(module: nn.Module, batch: int) -> None:
    """Replaces, in place, attention by its exported form and (convolution, norm) by one layer."""
    for name, child in module.named_children():
        is_pair = isinstance(child, nn.Sequential) and len(child) == 2
        if isinstance(child, GridAttention):
            setattr(module, name, ExportAttention(child, batch))
        elif is_pair and isinstance(child[1], nn.BatchNorm2d):
            setattr(module, name, fuse_conv_bn_eval(child[0], child[1]))
        else:
            _fold(child, batch)


class ExportEncoder(nn.Module):
    """The encoder for one image, its first norm folded into the stem and the positions."""

    def __init__(self, net: CompactNet):
        super().__init__()
        source = copy.deepcopy(net.encoder)
        norm = source.stem_norm
        self.stem = fuse_conv_bn_eval(source.stem, norm)
        gain = norm.weight / (norm.running_var + norm.eps).sqrt()
        self.register_buffer("position", (source.position * gain[None, :, None, None]).detach())
        _fold(source, 1)
        self.fine, self.down, self.deep = source.fine, source.down, source.deep
        self.intra, self.gather, self.inter = source.intra, source.gather, source.inter

    def forward(self, condition: torch.Tensor) -> torch.Tensor:
        x = torch.relu(self.stem(condition) + self.position)
        x = self.deep(torch.relu(self.down(self.fine(x))))
        return self.inter(torch.relu(self.gather(self.intra(x))))


class ExportDenoiser(nn.Module):
    """The denoiser at a fixed batch size."""

    def __init__(self, net: CompactNet, batch: int):
        super().__init__()
        source = copy.deepcopy(net.denoiser)
        self.batch = batch
        _fold(source, batch)
        self.enter, self.blocks = source.enter, source.blocks
        self.slopes, self.direct = source.slopes, source.direct
        self.register_buffer("position", source.position.detach().repeat(batch, 1, 1, 1))
        self.register_buffer("integration", source.integration)

    def forward(self, x: torch.Tensor, time: torch.Tensor, features: torch.Tensor) -> torch.Tensor:
        noisy = torch.cat([x, time], dim=1)
        h = torch.relu(self.enter(torch.cat([noisy, features], dim=1)) + self.position)
        h = self.blocks(h)
        slopes = self.slopes(h).reshape(self.batch * AXES, BANDS)
        summed = (slopes @ self.integration).reshape(self.batch, AXES, BANDS, 1)
        return summed + self.direct(torch.cat([h, noisy], dim=1))


def blind_to_noise(net: CompactNet) -> CompactNet:
    """A network trained by regression, which saw zeros for the noisy state, for any state."""
    net = copy.deepcopy(net)
    width = net.config.denoiser_width
    with torch.no_grad():
        net.denoiser.enter[0].weight[:, :AXES] = 0.0
        net.denoiser.direct.weight[:, width : width + AXES] = 0.0
    return net


def denoiser_inputs(net: CompactNet, batch: int) -> dict[str, torch.Tensor]:
    width = net.config.feature_width
    return {
        "x": torch.randn(batch, AXES, BANDS, 1),
        "time": torch.randn(batch, TIME_CHANNELS, BANDS, 1),
        "features": torch.randn(1, width, BANDS, 1).repeat(batch, 1, 1, 1),
    }


def encoder_inputs() -> dict[str, torch.Tensor]:
    rows, columns = planes_module.GRID_ROWS, planes_module.GRID_COLUMNS
    return {"condition": torch.randn(1, CONDITION_CHANNELS, rows, columns)}


def onnx_bytes(module: nn.Module, inputs: dict[str, torch.Tensor], output: str) -> bytes:
    stream = io.BytesIO()
    # Newer exporters write operators that OpenCV 4.6 does not know.
    has_choice = "dynamo" in inspect.signature(torch.onnx.export).parameters
    options = {"dynamo": False} if has_choice else {}
    torch.onnx.export(
        module.eval(), tuple(inputs.values()), stream, opset_version=OPSET,
        input_names=list(inputs), output_names=[output], do_constant_folding=True, **options,
    )
    return stream.getvalue()


def run_onnx(net: cv2.dnn.Net, inputs: dict[str, torch.Tensor]) -> np.ndarray:
    for name, value in inputs.items():
        net.setInput(value.numpy(), name)
    return net.forward().copy()


def read_onnx(data: bytes) -> cv2.dnn.Net:
    net = cv2.dnn.readNetFromONNX(np.frombuffer(data, np.uint8))
    net.setPreferableBackend(cv2.dnn.DNN_BACKEND_OPENCV)
    return net


@torch.no_grad()
def largest_difference(
    data: bytes, module: nn.Module, inputs: list[dict[str, torch.Tensor]]
) -> float:
    """Between OpenCV's result and PyTorch's, for several inputs one after the other."""
    net = read_onnx(data)
    return max(
        float(np.abs(run_onnx(net, each) - module(*each.values()).numpy()).max()) for each in inputs
    )


def milliseconds(data: bytes, inputs: dict[str, torch.Tensor], threads: int, runs: int) -> float:
    """Time of the quickest of some runs by OpenCV: what else the machine does only adds to it."""
    cv2.setNumThreads(threads)
    net = read_onnx(data)
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        run_onnx(net, inputs)
        times.append(time.perf_counter() - begin)
    return 1000 * min(times)


@torch.no_grad()
def export(net: CompactNet) -> dict[str, bytes]:
    """File name -> bytes of each ONNX file, compared with the network."""
    files = {"encoder.onnx": onnx_bytes(ExportEncoder(net), encoder_inputs(), "features")}
    inputs = [encoder_inputs() for _ in range(3)]
    differences = {"encoder.onnx": largest_difference(files["encoder.onnx"], net.encoder, inputs)}
    for batch in BATCH_SIZES:
        name = f"denoiser_{batch}.onnx"
        inputs = [denoiser_inputs(net, batch) for _ in range(3)]
        files[name] = onnx_bytes(ExportDenoiser(net, batch), inputs[0], "prediction")
        differences[name] = largest_difference(files[name], net.denoiser, inputs)
    for name, difference in differences.items():
        if not difference <= TOLERANCE:
            raise SystemExit(f"{name}: OpenCV differs from PyTorch by {difference:.2g}")
    return files


def model_description(files: dict[str, bytes], sampling: dict, training: dict) -> dict:
    """The model file; rsdiff/model_file.h says what each key means."""

    def weights(name: str) -> dict:
        return {"file": name, "sha256": hashlib.sha256(files[name]).hexdigest()}

    return {
        "format": "rs-stabilize model",
        "version": 1,
        "name": "compact",
        "backend": "opencv-dnn",
        "condition": {
            "kind": "orientation-planes",
            "channels": CONDITION_CHANNELS,
            "rows": planes_module.GRID_ROWS,
            "columns": planes_module.GRID_COLUMNS,
        },
        "motion": {
            "kind": "rotation-curve",
            "bands": BANDS,
            "scale": [round(float(s), 6) for s in SCALE],
        },
        "diffusion": {"steps": TIMESTEPS, "schedule": "linear", "objective": "x0"},
        "sampling": {"eta": 0, "clip_range": CLIP_RANGE, **sampling},
        "time_embedding": {"size": TIME_CHANNELS},
        "weights": {
            "encoder": weights("encoder.onnx"),
            "denoiser": [{**weights(f"denoiser_{b}.onnx"), "batch": b} for b in BATCH_SIZES],
        },
        "training": training,
    }


def measured_spread(net: CompactNet, pool: Path, pictures: int) -> float:
    """See calibration.py; tells what it found."""
    batch = as_tensors(SamplePool(pool, "compact").head(pictures))
    samples = draw_samples(net, batch, SPREAD_SAMPLES, SAMPLING_STEPS, CLIP_RANGE)
    scale, covered = spread_scale(samples, true_curves(batch))
    axes = ", ".join(f"{name} {share:.2f}" for name, share in zip("abr", covered))
    print(f"spread scale {scale:.3f}: the truth lies in the central 80% at {axes}")
    return scale


def write_model(folder: Path, files: dict[str, bytes], sampling: dict, training: dict) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (folder / name).write_bytes(data)
    description = model_description(files, sampling, training)
    (folder / "model.json").write_text(json.dumps(description, indent=2) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the model")
    parser.add_argument("--regression", action="store_true",
                        help="it was trained by regression (checkpoints of train.py say so)")
    parser.add_argument("--calibrate", type=Path, metavar="POOL",
                        help="measure the samples' spread on a pool that was not trained on")
    parser.add_argument("--pictures", type=int, default=1000, help="of that pool")
    parser.add_argument("--time", type=int, default=0, metavar="RUNS", help="time OpenCV as well")
    args = parser.parse_args()
    torch.manual_seed(1)
    net, state = load_averaged(args.checkpoint)
    if state["net"] != "compact":
        raise SystemExit(f"{args.checkpoint}: is of the {state['net']} network, not compact")
    regression = args.regression or state["objective"] == "regression"
    files = export(blind_to_noise(net) if regression else net)
    training = {
        "step": state["step"],
        "objective": "regression" if regression else state["objective"],
        "config": state["config"],
    }
    sampling: dict[str, float] = {"steps": 1 if regression else SAMPLING_STEPS}
    if args.calibrate is not None and not regression:
        scale = measured_spread(net, args.calibrate, args.pictures)
        sampling["spread_scale"] = round(scale, 3)
    write_model(args.output, files, sampling, training)
    print(f"{args.output}: {sum(map(len, files.values())) / 1e6:.2f} MB")
    for name, data in files.items() if args.time else ():
        batch = int(name.split("_")[1][:-5]) if "_" in name else 0
        inputs = denoiser_inputs(net, batch) if batch else encoder_inputs()
        for threads in (1, 2):
            spent = milliseconds(data, inputs, threads, args.time)
            print(f"{name}: {spent:.2f} ms with {threads} thread(s)")


if __name__ == "__main__":
    main()
