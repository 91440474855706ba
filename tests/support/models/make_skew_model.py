#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes skew/: a model of the compact kind that answers every picture with the same motion.

Run in this folder with Debian's python3-onnx: python3 make_skew_model.py
  features[:, band] = the curve below, in network units, whatever the condition holds
  prediction = features, whatever the noisy state and the time step are
tests/support/skew_model.h states the same curve for C++.
"""

import hashlib
import json
from pathlib import Path

import numpy as np
from onnx import TensorProto, checker, helper, numpy_helper

CHANNELS, BANDS, COLUMNS = 3, 24, 16
AXES, TIME = 3, 4
SCALE = (0.04, 0.04, 0.08)
# (a, b, r) per unit of the place c = (band + 0.5) / BANDS - 0.5 in the picture's height.
PER_HEIGHT = (-0.06, 0.02, 0.05)


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
    folder = Path("skew")
    folder.mkdir(exist_ok=True)
    place = (np.arange(BANDS) + 0.5) / BANDS - 0.5
    curve = np.outer(np.array(PER_HEIGHT) / np.array(SCALE), place)
    encoder = save(
        folder / "encoder.onnx",
        [
            helper.make_node("Conv", ["condition", "nothing"], ["cells"], kernel_shape=[1, 1]),
            helper.make_node(
                "AveragePool", ["cells"], ["bands"], kernel_shape=[1, COLUMNS], strides=[1, COLUMNS]
            ),
            helper.make_node("Add", ["bands", "curve"], ["features"]),
        ],
        [("condition", [1, CHANNELS, BANDS, COLUMNS])],
        [("features", [1, AXES, BANDS, 1])],
        {"nothing": np.zeros((AXES, CHANNELS, 1, 1)), "curve": curve[None, :, :, None]},
    )
    inside = AXES + TIME + AXES
    choose = np.zeros((AXES, inside, 1, 1))
    for axis in range(AXES):
        choose[axis, AXES + TIME + axis] = 1.0
    denoisers = []
    for batch in (1, 8):
        name = f"denoiser_{batch}.onnx"
        digest = save(
            folder / name,
            [
                helper.make_node("Concat", ["x", "time", "features"], ["all"], axis=1),
                helper.make_node("Conv", ["all", "choose"], ["prediction"], kernel_shape=[1, 1]),
            ],
            [
                ("x", [batch, AXES, BANDS, 1]),
                ("time", [batch, TIME, BANDS, 1]),
                ("features", [batch, AXES, BANDS, 1]),
            ],
            [("prediction", [batch, AXES, BANDS, 1])],
            {"choose": choose},
        )
        denoisers.append({"file": name, "sha256": digest, "batch": batch})
    model = {
        "format": "rs-stabilize model",
        "version": 1,
        "name": "skew",
        "backend": "opencv-dnn",
        "condition": {"kind": "rgb", "channels": CHANNELS, "rows": BANDS, "columns": COLUMNS},
        "motion": {"kind": "rotation-curve", "bands": BANDS, "scale": SCALE},
        "diffusion": {"steps": 1000, "schedule": "linear", "objective": "x0"},
        "sampling": {"steps": 2, "eta": 0, "guidance": 1},
        "time_embedding": {"size": TIME},
        "weights": {
            "encoder": {"file": "encoder.onnx", "sha256": encoder},
            "denoiser": denoisers,
        },
    }
    (folder / "model.json").write_text(json.dumps(model, indent=2) + "\n")


if __name__ == "__main__":
    main()
