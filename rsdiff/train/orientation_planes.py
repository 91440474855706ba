# SPDX-License-Identifier: Apache-2.0
"""The compact network's view of an image: how edges lean, cell by cell.

Rolling shutter shows in the direction of lines. A network that sees pixels must first learn to
measure directions to a fraction of a degree; here that part is computed: a double-angle structure
tensor at (nearly) full resolution, whose energy is sorted by slope into fine bins and pooled over
a grid of cells. `rsdiff/orientation_planes.cc` is the same definition in C++; a test compares them.
"""

from __future__ import annotations

import cv2
import numpy as np

GRID_ROWS = 24
GRID_COLUMNS = 16
UPRIGHT_BINS = 20  # slope dx/dy of edges nearer to the vertical
LEVEL_BINS = 12  # slope dy/dx of edges nearer to the horizontal
GRAY_PER_CELL = (2, 4)  # rows, columns of the small grey picture in one cell
PLANES = UPRIGHT_BINS + LEVEL_BINS
WORKING_AREA = 384 * 288  # px; the image is scaled to about this area, its aspect kept
FINE_SLOPE = 0.15  # bins are fine below this slope and grow beyond
LEAST_GRADIENT = 3.0  # grey levels per px: below it a direction is noise
STRONG_GRADIENT = 12.0  # contrast beyond which an edge counts no more
BYTE_SCALE = 32.0  # planes are kept as bytes: value * BYTE_SCALE


def working_size(width: int, height: int) -> tuple[int, int]:
    """Size (width, height) at which directions are measured."""
    scale = (WORKING_AREA / (width * height)) ** 0.5
    return max(GRID_COLUMNS * 4, round(width * scale)), max(GRID_ROWS * 2, round(height * scale))


def _soft_bins(slope: np.ndarray, bins: int) -> tuple[np.ndarray, np.ndarray]:
    """Lower bin and the share of the upper one, for slopes in [-1, 1]."""
    position = np.arcsinh(slope * (1.0 / FINE_SLOPE))
    position *= 0.5 * (bins - 1) / np.arcsinh(1.0 / FINE_SLOPE)
    position += 0.5 * (bins - 1)
    np.clip(position, 0.0, bins - 1.001, out=position)
    lower = position.astype(np.int32)
    return lower, position - lower


def orientation_planes(gray: np.ndarray) -> np.ndarray:
    """Bytes, PLANES x GRID_ROWS x GRID_COLUMNS, of a uint8 picture of working size."""
    height, width = gray.shape
    gx = cv2.Scharr(gray, cv2.CV_32F, 1, 0, scale=1.0 / 32.0)
    gy = cv2.Scharr(gray, cv2.CV_32F, 0, 1, scale=1.0 / 32.0)
    smooth = lambda m: cv2.GaussianBlur(m, (5, 5), 1.2)
    difference = smooth(gx * gx - gy * gy)
    product = smooth(gx * gy)
    product *= 2.0
    energy = cv2.magnitude(difference, product)
    # The outermost pixels see a mirrored border, where every edge looks upright or level.
    energy[:3] = energy[-3:] = 0.0
    energy[:, :3] = energy[:, -3:] = 0.0
    chosen = np.flatnonzero(energy > LEAST_GRADIENT**2)
    energy = energy.ravel()[chosen]
    difference = difference.ravel()[chosen]
    slope = -product.ravel()[chosen] / (energy + np.abs(difference))
    rows, columns = np.divmod(chosen, width)
    cell = (rows * GRID_ROWS // height) * GRID_COLUMNS + columns * GRID_COLUMNS // width
    weight = np.minimum(np.sqrt(energy), STRONG_GRADIENT)

    cells = GRID_ROWS * GRID_COLUMNS
    planes = np.zeros((PLANES, cells))
    for first, bins, mask in (
        (0, UPRIGHT_BINS, difference >= 0.0),
        (UPRIGHT_BINS, LEVEL_BINS, difference < 0.0),
    ):
        lower, share = _soft_bins(slope[mask], bins)
        index = lower * cells + cell[mask]
        w = weight[mask]
        total = np.bincount(index, w * (1.0 - share), bins * cells)
        total += np.bincount(index + cells, w * share, (bins + 1) * cells)[: bins * cells]
        planes[first : first + bins] = total.reshape(bins, cells)
    pixels_per_cell = width * height / cells
    planes = np.sqrt(planes / pixels_per_cell)
    return np.minimum(planes * (BYTE_SCALE * 2.0) + 0.5, 255.0).astype(np.uint8).reshape(
        PLANES, GRID_ROWS, GRID_COLUMNS
    )


def small_gray(gray: np.ndarray) -> np.ndarray:
    """The whole picture as bytes, 48 x 64 (rows x columns), by area."""
    size = (GRID_COLUMNS * GRAY_PER_CELL[1], GRID_ROWS * GRAY_PER_CELL[0])
    return cv2.resize(gray, size, interpolation=cv2.INTER_AREA)
