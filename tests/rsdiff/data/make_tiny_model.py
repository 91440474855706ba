#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes tiny_model/: a model of the compact kind whose answers have a closed form.

Run in this folder with Debian's python3-onnx: python3 make_tiny_model.py
  features[f, band] = mean over columns of sum_c E[f, c] * condition[c, band, column]
  prediction[o, band] = sum over the channels of [x, time, features] of D[o, channel] * value
  E[f, c] = sin(0.7 (f * C + c)) / C;  D[o, i] = sin(1 + 0.3 (o * I + i)) / 4
"""

import hashlib
import json
from pathlib import Path

import numpy as np
from onnx import TensorProto, checker, helper, numpy_helper

CHANNELS, ROWS, COLUMNS = 73, 24, 16
FEATURES, AXES, TIME = 2, 3, 4


def save(path: Path, nodes, inputs, outputs, weights) -> str:
    value = lambda name, shape: helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
    graph = helper.make_graph(
        nodes,
        path.stem,
        [value(*i) for i in inputs],
        [value(*o) for o in outputs],
        [numpy_helper.from_array(w.astype(np.float32), name) for name, w in weights.items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
    model.ir_version = 7
    checker.check_model(model)
    path.write_bytes(model.SerializeToString())
    return hashlib.sha256(path.read_bytes()).hexdigest()


def main() -> None:
    folder = Path("tiny_model")
    folder.mkdir(exist_ok=True)
    n = np.arange(FEATURES * CHANNELS)
    encode = (np.sin(0.7 * n) / CHANNELS).reshape(FEATURES, CHANNELS, 1, 1)
    encoder = save(
        folder / "encoder.onnx",
        [
            helper.make_node("Conv", ["condition", "E"], ["cells"], kernel_shape=[1, 1]),
            helper.make_node(
                "AveragePool", ["cells"], ["features"], kernel_shape=[1, COLUMNS], strides=[1, COLUMNS]
            ),
        ],
        [("condition", [1, CHANNELS, ROWS, COLUMNS])],
        [("features", [1, FEATURES, ROWS, 1])],
        {"E": encode},
    )
    inside = AXES + TIME + FEATURES
    n = np.arange(AXES * inside)
    denoise = (np.sin(1.0 + 0.3 * n) / 4).reshape(AXES, inside, 1, 1)
    denoisers = []
    for batch in (1, 4):
        name = f"denoiser_{batch}.onnx"
        digest = save(
            folder / name,
            [
                helper.make_node("Concat", ["x", "time", "features"], ["all"], axis=1),
                helper.make_node("Conv", ["all", "D"], ["prediction"], kernel_shape=[1, 1]),
            ],
            [
                ("x", [batch, AXES, ROWS, 1]),
                ("time", [batch, TIME, ROWS, 1]),
                ("features", [batch, FEATURES, ROWS, 1]),
            ],
            [("prediction", [batch, AXES, ROWS, 1])],
            {"D": denoise},
        )
        denoisers.append({"file": name, "sha256": digest, "batch": batch})
    model = {
        "format": "rs-stabilize model",
        "version": 1,
        "name": "tiny",
        "backend": "opencv-dnn",
        "condition": {
            "kind": "orientation-planes",
            "channels": CHANNELS,
            "rows": ROWS,
            "columns": COLUMNS,
        },
        "motion": {"kind": "rotation-curve", "bands": ROWS, "scale": [0.04, 0.05, 0.08]},
        "diffusion": {"steps": 1000, "schedule": "cosine", "objective": "x0"},
        "sampling": {
            "steps": 4,
            "eta": 0.5,
            "clip_range": 4,
            "guidance": 1.5,
            "guidance_rescale": 0.25,
            "spread_scale": 1.75,
        },
        "time_embedding": {"size": TIME},
        "weights": {
            "encoder": {"file": "encoder.onnx", "sha256": encoder},
            "denoiser": denoisers,
        },
    }
    (folder / "model.json").write_text(json.dumps(model, indent=2) + "\n")


if __name__ == "__main__":
    main()
