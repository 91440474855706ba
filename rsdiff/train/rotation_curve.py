# SPDX-License-Identifier: Apache-2.0
"""Camera rotation over one readout: random curves, and what they do to pixels.

A curve is three functions of the row's exposure time s in [-0.5, 0.5] (0 = middle row):
  a = f*yaw/H, b = f*pitch/H (displacement of the image centre in image heights), r = roll (rad),
for camera_row_from_reference = exp([w]x), w = (-b*H/f, a*H/f, r); zero at s = 0.
"""

from __future__ import annotations

import math

import numpy as np

BANDS = 24
SCALE = np.array([0.01, 0.01, 0.02], np.float32)  # network unit of a, b, r: about one sigma


def band_times(bands: int = BANDS) -> np.ndarray:
    """Exposure times of the band centres."""
    return (np.arange(bands) + 0.5) / bands - 0.5


class RotationCurve:
    """a, b, r sampled on a fine grid of times that reaches past the frame on both sides."""

    REACH = 0.8
    SAMPLES = 321

    def __init__(self, values: np.ndarray):
        """values: 3 x SAMPLES at times -REACH..REACH; shifted so that the middle row is zero."""
        self.values = values - values[:, values.shape[1] // 2, None]

    @staticmethod
    def times() -> np.ndarray:
        return np.linspace(-RotationCurve.REACH, RotationCurve.REACH, RotationCurve.SAMPLES)

    def at(self, times: np.ndarray) -> np.ndarray:
        """3 x n values at any times."""
        grid = self.times()
        return np.stack([np.interp(times, grid, v) for v in self.values])

    def bands(self, bands: int = BANDS) -> np.ndarray:
        """3 x bands, in network units."""
        return (self.at(band_times(bands)) / SCALE[:, None]).astype(np.float32)


def row_homographies(curve: np.ndarray, width: int, height: int, focal: float) -> np.ndarray:
    """n x 3 x 3 homographies K exp([w]x) K^-1 (row <- reference) of curve values 3 x n."""
    a, b, r = curve
    w = np.stack([-b * height / focal, a * height / focal, r], axis=1)
    angle = np.linalg.norm(w, axis=1)
    safe = np.maximum(angle, 1e-12)
    k = np.zeros((len(angle), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -w[:, 2], w[:, 1], -w[:, 0]
    k -= k.transpose(0, 2, 1)
    rotation = (
        np.eye(3)
        + (np.sin(angle) / safe)[:, None, None] * k
        + ((1 - np.cos(angle)) / safe**2)[:, None, None] * (k @ k)
    )
    camera = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1.0]])
    return camera @ rotation @ np.linalg.inv(camera)


def gs_from_rs_map(
    curve: RotationCurve, width: int, height: int, focal: float, time_shift: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Where each RS pixel lies in the global-shutter picture (exact, one step): x, y maps."""
    times = (np.arange(height) + 0.5) / height - 0.5 + time_shift
    h = np.linalg.inv(row_homographies(curve.at(times), width, height, focal))
    h = h.astype(np.float32)
    y = np.arange(height, dtype=np.float32)
    x = np.arange(width, dtype=np.float32)
    along = h[:, :, 0]  # per px of x
    base = h[:, :, 1] * y[:, None] + h[:, :, 2]
    depth = 1.0 / (along[:, 2, None] * x + base[:, 2, None])
    return (
        (along[:, 0, None] * x + base[:, 0, None]) * depth,
        (along[:, 1, None] * x + base[:, 1, None]) * depth,
    )


def rs_from_gs(
    curve: RotationCurve, width: int, height: int, focal: float, points: np.ndarray
) -> np.ndarray:
    """Where the directions of global-shutter pixels were recorded, n x 2 -> n x 2 (x, y).

    The fixed point p = H(t(p.y)) x by Newton's method on the row: the map is nearly straight in it.
    Rows outside the frame count as exposed with the first or last one, as in `igf`.
    """
    rows = np.arange(height)
    table = row_homographies(curve.at((rows + 0.5) / height - 0.5), width, height, focal)
    x = np.column_stack([points, np.ones(len(points))])

    def seen_at(row: np.ndarray) -> np.ndarray:
        row = np.clip(row, 0.0, height - 1.0)
        lower = np.minimum(row.astype(int), height - 2)
        share = (row - lower)[:, None, None]
        h = table[lower] * (1 - share) + table[lower + 1] * share
        p = np.einsum("nij,nj->ni", h, x)
        return p[:, :2] / p[:, 2:]

    row = points[:, 1].astype(float)
    for _ in range(8):
        miss = seen_at(row)[:, 1] - row
        slope = (seen_at(row + 0.5)[:, 1] - seen_at(row - 0.5)[:, 1]) - 1.0
        row = row - miss / np.minimum(slope, -0.1)
    return seen_at(row)


class CurveSampler:
    """Draws random curves: steady, accelerating, oscillating, cut from gyro logs, mixed, still."""

    def __init__(self, gyro_logs: list[tuple[np.ndarray, np.ndarray]] | None = None):
        """gyro_logs: (times s, n x 3 rates rad/s in camera axes) each."""
        self.gyro_logs = gyro_logs or []

    def draw(self, rng: np.random.Generator) -> RotationCurve:
        t = RotationCurve.times()
        kind = rng.random()
        if kind < 0.12:
            return RotationCurve(np.zeros((3, t.size)))
        # RMS displacement aimed at, image heights: mostly 3 to 25 px of 600.
        size = min(0.017 * math.exp(0.6 * rng.normal()), 0.06)
        if self.gyro_logs and kind < 0.24:
            shape = self._from_log(rng, t)
        elif kind < 0.44:
            shape = self._axis(rng)[:, None] * t
        elif kind < 0.54:
            shape = self._unit(self._axis(rng)[:, None] * t)
            bend = self._unit(self._axis(rng)[:, None] * t**2)
            shape = shape + bend * rng.uniform(0, 1.5)
        elif kind < 0.76:
            shape = self._oscillation(rng, t)
        else:
            share = rng.uniform(0.2, 0.8)
            shape = (1 - share) * self._unit(self._axis(rng)[:, None] * t)
            shape = shape + share * self._unit(self._oscillation(rng, t))
        values = self._unit(shape) * size
        return RotationCurve(values)

    @staticmethod
    def _unit(shape: np.ndarray) -> np.ndarray:
        """Scaled to an RMS displacement of one inside the frame (roll acts at half a width)."""
        inside = np.abs(RotationCurve.times()) <= 0.5
        shape = shape - shape[:, shape.shape[1] // 2, None]
        rms = math.sqrt(float((shape[:, inside] ** 2).mean(axis=1) @ np.array([1, 1, 0.23])))
        return shape / max(rms, 1e-9)

    @staticmethod
    def _axis(rng: np.random.Generator) -> np.ndarray:
        """Random mix of yaw, pitch and roll in which each is often alone or strong."""
        axis = rng.normal(size=3) * np.exp(0.8 * rng.normal(size=3))
        if rng.random() < 0.3:
            keep = rng.integers(3)
            axis[np.arange(3) != keep] = 0.0
        return axis

    def _oscillation(self, rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
        axis = self._axis(rng)
        cycles = rng.uniform(0.4, 3.0, size=3)
        if rng.random() < 0.5:
            cycles[:] = cycles[0]
        phase = rng.uniform(0, 2 * math.pi, size=3)
        return axis[:, None] * np.sin(2 * math.pi * cycles[:, None] * t + phase[:, None])

    def _from_log(self, rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
        times, rates = self.gyro_logs[rng.integers(len(self.gyro_logs))]
        readout = rng.uniform(0.008, 0.06)  # s; longer than real ones, for more bending
        begin, end = times[0] + readout, times[-1] - readout
        middle = rng.uniform(begin, end)
        rate = np.stack([np.interp(middle + t * readout, times, r) for r in rates.T])
        angle = np.cumsum(rate, axis=1)
        return np.stack([angle[1], -angle[0], angle[2]])
