#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes training_field.csv: where the training code says that a stated curve moves pixels.

Run in this folder with Debian's python3-opencv: python3 make_training_field.py
training_field_test.cc makes the same curve and asks `igf`; train/field_test.py makes it again.
Columns: pixel x, y; where that pixel of the RS picture lies in the GS picture (x, y); where that
pixel of the GS picture was recorded in the RS picture (x, y).
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[3] / "rsdiff" / "train"))
from rotation_curve import RotationCurve, gs_from_rs_map, rs_from_gs  # noqa: E402

WIDTH, HEIGHT, FOCAL = 400, 300, 320.0
FILE = Path(__file__).parent / "training_field.csv"


def stated_curve() -> RotationCurve:
    """Up to 10 px of yaw and pitch and 0.05 rad of roll, every axis with its own bends."""
    t = RotationCurve.times()
    return RotationCurve(np.stack([
        0.03 * np.sin(5.0 * t), 0.025 * np.sin(3.0 * t + 0.4), 0.08 * t - 0.06 * t**2
    ]))


def table() -> np.ndarray:
    x, y = (m.ravel() for m in np.meshgrid(np.arange(0, WIDTH, 57), np.arange(0, HEIGHT, 23)))
    gs_x, gs_y = gs_from_rs_map(stated_curve(), WIDTH, HEIGHT, FOCAL)
    points = np.column_stack([x, y]).astype(float)
    rs = rs_from_gs(stated_curve(), WIDTH, HEIGHT, FOCAL, points)
    return np.column_stack([points, gs_x[y, x], gs_y[y, x], rs])


if __name__ == "__main__":
    np.savetxt(FILE, table(), "%.5f", ",", header="x,y,gs_x,gs_y,rs_x,rs_y", comments="")
