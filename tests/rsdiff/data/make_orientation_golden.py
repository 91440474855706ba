#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes orientation_golden.bin: what the training code makes of a procedural picture.

Run in this folder with Debian's python3-opencv and python3-torch: python3 make_orientation_golden.py
Contents: every 19th number of the condition tensor (float32, little-endian) of a 392 x 282 picture;
orientation_planes_test.cc paints the same one.
"""

import sys
from pathlib import Path

import numpy as np
import torch

sys.path.insert(0, str(Path(__file__).parents[3] / "rsdiff" / "train"))
from compact_net import CompactConfig, condition_tensor  # noqa: E402
from orientation_planes import orientation_planes, small_gray  # noqa: E402

STRIDE = 19


def picture(width: int, height: int) -> np.ndarray:
    """Squares, a triangle wave and a flat part, in whole numbers: the same on every machine."""
    y, x = np.mgrid[0:height, 0:width]
    board = ((3 * x + y) // 47 + (2 * y - x) // 31) % 2 * 120
    wave = np.abs((5 * x + 7 * y) % 96 - 48)
    dither = (x * 7919 + y * 104729 + x * y) % 11
    return np.where(x + y < 120, 90, board + wave + dither + 20).astype(np.uint8)


def main() -> None:
    gray = picture(392, 282)
    condition = condition_tensor(
        torch.from_numpy(orientation_planes(gray))[None],
        torch.from_numpy(small_gray(gray))[None],
        torch.tensor([392 / 282]),
        CompactConfig(),
    )
    content = condition.numpy().ravel()[::STRIDE].astype("<f4").tobytes()
    (Path(__file__).parent / "orientation_golden.bin").write_bytes(content)


if __name__ == "__main__":
    main()
