# SPDX-License-Identifier: Apache-2.0
"""What the networks learn from: one RS picture with its motion, at the size each network sees.

A sample is a dict of arrays; batches stack them. Two kinds:
  compact    planes (bytes), rs_small, gs_small (48 x 64 grey bytes), rotation (3 x BANDS: a curve
             in image heights and rad, see rotation_curve.py), aspect (width / height)
  reference  rs, gs (3 x 64 x 64 RGB bytes), field (2 x 64 x 64, network units), aspect
"""

from __future__ import annotations

from typing import Protocol

import cv2
import numpy as np

from orientation_planes import orientation_planes, small_gray

FIELD_SIDE = 64  # of the reference network's pictures and fields
# The arrays of a sample, by the network that learns from it.
KINDS = {
    "compact": ("planes", "rs_small", "gs_small", "rotation", "aspect"),
    "reference": ("rs", "gs", "field", "aspect"),
}

Sample = dict[str, np.ndarray]


class SampleSource(Protocol):
    reference_row: str  # "middle" or "first": where its motions are zero

    def batch(self, rng: np.random.Generator, count: int) -> Sample:
        """`count` samples drawn with `rng`, each array with a new first dimension."""


def compact_sample(rs: np.ndarray, gs: np.ndarray, rotation: np.ndarray) -> Sample:
    """rs, gs: grey pictures of working size."""
    return {
        "planes": orientation_planes(rs),
        "rs_small": small_gray(rs),
        "gs_small": small_gray(gs),
        "rotation": rotation.astype(np.float32),
        "aspect": np.float32(rs.shape[1] / rs.shape[0]),
    }


def _small_rgb(picture: np.ndarray) -> np.ndarray:
    small = cv2.resize(picture, (FIELD_SIDE, FIELD_SIDE), interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(small.transpose(2, 0, 1))


def reference_sample(rs: np.ndarray, gs: np.ndarray, field: np.ndarray) -> Sample:
    """rs, gs: RGB pictures; field: 2 x 64 x 64, displacement in px of these pictures."""
    height, width = rs.shape[:2]
    unit = np.array([width, height], np.float32) * ((FIELD_SIDE - 1) / FIELD_SIDE)
    return {
        "rs": _small_rgb(rs),
        "gs": _small_rgb(gs),
        "field": (field / unit[:, None, None]).astype(np.float32),
        "aspect": np.float32(width / height),
    }


def small_grid(width: int, height: int) -> np.ndarray:
    """4096 x 2 pixels (x, y) of a picture at which the 64 x 64 field is told, row by row."""
    x = (np.arange(FIELD_SIDE) + 0.5) * width / FIELD_SIDE - 0.5
    y = (np.arange(FIELD_SIDE) + 0.5) * height / FIELD_SIDE - 0.5
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def stacked(samples: list[Sample]) -> Sample:
    return {name: np.stack([s[name] for s in samples]) for name in samples[0]}
