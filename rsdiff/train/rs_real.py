#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""RS-Real in its published layout as a source of samples.

Every **/*.npz below the folder has `condition` (the RS picture, H x W x 3 RGB bytes), `gs` (the
same, corrected) and `out_flow` (2 x H x W, backward displacement in px, zero on the FIRST row).
  rs_real.py FOLDER    tells how well rotation curves describe its fields
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from orientation_planes import working_size
from rotation_curve import BANDS
from samples import FIELD_SIDE, Sample, compact_sample, reference_sample, stacked

FIT_COLUMN_STEP = 8  # of the field; neighbouring columns say the same
FIT_ROUNDS = 4
LARGEST_PERSPECTIVE = 4.0  # a focal length of half an image height


@dataclass
class FittedCurve:
    values: np.ndarray  # 3 x BANDS: a, b (image heights), r (rad); zero at the middle row
    perspective: float  # (image height / focal length)^2, from 0
    residual_px: float  # RMS of what it leaves of the field


def _design(x: np.ndarray, y: np.ndarray, perspective: float) -> np.ndarray:
    """(u, v) per unit of (a, b, r) at n places in image heights, 2n x 3: small rotations' field."""
    q = perspective
    u = np.stack([1 + q * x * x, q * x * y, -y], axis=1)
    v = np.stack([q * x * y, 1 + q * y * y, x], axis=1)
    return np.concatenate([u, v])


def fit_curve(field: np.ndarray) -> FittedCurve:
    """The rotation curve that a field of 2 x H x W px shows, by least squares in each band.

    The perspective is the picture's, found in turn with the curve. Told from the middle row.
    """
    _, height, width = field.shape
    if height < 2 * BANDS:
        raise SystemExit(f"a field of {height} rows is too small for {BANDS} bands")
    columns = np.arange(FIT_COLUMN_STEP // 2, width, FIT_COLUMN_STEP)
    bands = []
    for k in range(BANDS):
        rows = np.arange(-(-k * height // BANDS), -(-(k + 1) * height // BANDS))
        x, y = np.meshgrid((columns + 0.5 - width / 2) / height, (rows + 0.5) / height - 0.5)
        seen = field[:, rows][:, :, columns].reshape(-1).astype(float) / height
        bands.append((x.ravel(), y.ravel(), seen))
    perspective = 0.0
    for _ in range(FIT_ROUNDS):
        curve, step, size, squares = [], 0.0, 1e-12, 0.0
        for x, y, seen in bands:
            basis, triangle = np.linalg.qr(_design(x, y, perspective))
            curve.append(np.linalg.solve(triangle, basis.T @ seen))
            left = seen - basis @ (basis.T @ seen)
            # How the field would change with the perspective, the curve following (Gauss-Newton).
            slope = (_design(x, y, 1.0) - _design(x, y, 0.0)) @ curve[-1]
            slope -= basis @ (basis.T @ slope)
            step, size = step + left @ slope, size + slope @ slope
            squares += left @ left
        perspective = min(max(perspective + step / size, 0.0), LARGEST_PERSPECTIVE)
    curve = np.array(curve)
    places = sum(len(x) for x, _, _ in bands)
    residual_px = height * float(np.sqrt(squares / places))
    middle = curve[BANDS // 2 - 1 : BANDS // 2 + 1].mean(axis=0)
    return FittedCurve((curve - middle).T, perspective, residual_px)


def correct(rs: np.ndarray, fitted: FittedCurve) -> np.ndarray:
    """The RS picture warped by the field of a curve, as RS-Real's corrected pictures were made.

    Those are told from the first row; this one is from the middle row, as the curve.
    """
    height, width = rs.shape[:2]
    rows = np.arange(height)
    position = (rows + 0.5) / height * BANDS - 0.5
    curve = np.stack([np.interp(position, np.arange(BANDS), c) for c in fitted.values], axis=1)
    x, y = np.meshgrid((np.arange(width) + 0.5 - width / 2) / height, (rows + 0.5) / height - 0.5)
    design = _design(x.ravel(), y.ravel(), fitted.perspective).reshape(2, height, width, 3)
    moved = height * np.einsum("crwi,ri->crw", design, curve)
    map_x, map_y = np.arange(width) + moved[0], rows[:, None] + moved[1]
    return cv2.remap(
        rs, map_x.astype(np.float32), map_y.astype(np.float32), cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
    )


def read_pair(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """RS picture, GS picture, field of one file, checked."""
    with np.load(path, allow_pickle=False) as file:
        missing = [name for name in ("condition", "gs", "out_flow") if name not in file]
        if missing:
            raise SystemExit(f"{path}: no array {missing[0]!r}, so it is no RS-Real sample")
        rs, gs, field = file["condition"], file["gs"], file["out_flow"]
    is_picture = rs.ndim == 3 and rs.shape[2] == 3 and rs.dtype == np.uint8
    if not is_picture or gs.shape != rs.shape or field.shape != (2, *rs.shape[:2]):
        raise SystemExit(f"{path}: arrays of {rs.shape}, {gs.shape} and {field.shape} do not fit")
    return rs, gs, field


class RsReal:
    """A SampleSource over a list of files."""

    def __init__(self, files: list[Path], kind: str):
        self.files = files
        self.kind = kind
        self.reference_row = "first" if kind == "reference" else "middle"

    def batch(self, rng: np.random.Generator, count: int) -> Sample:
        return stacked([self.draw(rng) for _ in range(count)])

    def draw(self, rng: np.random.Generator) -> Sample:
        rs, gs, field = read_pair(self.files[rng.integers(len(self.files))])
        if self.kind == "reference":
            small = [cv2.resize(c, (FIELD_SIDE,) * 2, interpolation=cv2.INTER_AREA) for c in field]
            return reference_sample(rs, gs, np.stack(small))
        fitted = fit_curve(field)
        size = working_size(rs.shape[1], rs.shape[0])
        gray = cv2.resize(cv2.cvtColor(rs, cv2.COLOR_RGB2GRAY), size, interpolation=cv2.INTER_AREA)
        return compact_sample(gray, correct(gray, fitted), fitted.values)


def rs_real_files(folder: Path) -> list[Path]:
    files = sorted(folder.rglob("*.npz"))
    if not files:
        raise SystemExit(f"{folder}: no .npz below it")
    return files


def fit_residuals(files: list[Path]) -> tuple[np.ndarray, np.ndarray]:
    """RMS px of each field, and of what its curve leaves of it."""
    sizes, residuals = [], []
    for path in files:
        field = read_pair(path)[2].astype(float)
        sizes.append(np.sqrt((field**2).sum(axis=0).mean()))
        residuals.append(fit_curve(field).residual_px)
    return np.array(sizes), np.array(residuals)


def fit_report(files: list[Path], look_at: int = 50) -> str:
    """How well curves describe the fields, from some files evenly spread."""
    sizes, residuals = fit_residuals(files[:: max(1, len(files) // look_at)])
    return (
        f"RS-Real: {len(files)} files; fields of {sizes.mean():.2f} px RMS, of which rotation "
        f"curves leave {residuals.mean():.3f} px (worst {residuals.max():.3f})"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--files", type=int, default=200, help="look at about this many")
    args = parser.parse_args()
    print(fit_report(rs_real_files(args.folder), args.files))


if __name__ == "__main__":
    main()
