# SPDX-License-Identifier: Apache-2.0
"""RS-Real's layout, on samples made here."""

import tempfile
import unittest
from pathlib import Path

import numpy as np

from rotation_curve import BANDS, RotationCurve, band_times, row_homographies
from rs_real import (
    RsReal,
    correct,
    fit_curve,
    fit_report,
    fit_residuals,
    read_pair,
    rs_real_files,
)

WIDTH, HEIGHT, FOCAL = 320, 240, 400.0
# Second-order terms of the rotations, and what a value per band leaves of a bent curve.
RESIDUAL_PX = 0.25
CURVE_TOLERANCE = 2e-4  # image heights and rad


def curve() -> RotationCurve:
    t = RotationCurve.times()
    return RotationCurve(np.stack([0.02 * t, 0.008 * np.sin(4 * t), 0.015 * t]))


def published_field() -> np.ndarray:
    """One step of the fixed point, each row's homography relative to the FIRST band's."""
    rows = np.arange(HEIGHT)
    h = row_homographies(curve().at((rows + 0.5) / HEIGHT - 0.5), WIDTH, HEIGHT, FOCAL)
    h = h @ np.linalg.inv(h[0])
    x, y = np.meshgrid(np.arange(WIDTH), rows)
    p = np.einsum("rij,rcj->rci", h, np.dstack([x, y, np.ones_like(x)]).astype(float))
    return np.stack([p[..., 0] / p[..., 2] - x, p[..., 1] / p[..., 2] - y]).astype(np.float32)


def write_sample(path: Path) -> None:
    rng = np.random.default_rng(1)
    rs = np.repeat(np.repeat(rng.integers(0, 255, (24, 32, 3)), 10, 0), 10, 1).astype(np.uint8)
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez(path, condition=rs, gs=rs[:, ::-1].copy(), out_flow=published_field())


class Fit(unittest.TestCase):
    def test_finds_the_curve_and_says_what_is_left(self):
        fitted = fit_curve(published_field())
        truth = curve().at(band_times())
        self.assertGreater(np.abs(truth).max(axis=1).min(), 8 * CURVE_TOLERANCE)
        np.testing.assert_allclose(fitted.values, truth, atol=CURVE_TOLERANCE)
        self.assertLess(fitted.residual_px, RESIDUAL_PX)
        self.assertAlmostEqual(fitted.perspective, (HEIGHT / FOCAL) ** 2, delta=0.1)

    def test_a_field_that_no_rotation_makes_leaves_a_residual(self):
        field = published_field()
        field[0] += np.where(np.arange(WIDTH) < WIDTH // 2, 3.0, -3.0)  # parallax
        self.assertGreater(fit_curve(field).residual_px, 2.0)

    def test_correcting_keeps_the_middle_row(self):
        rs = np.random.default_rng(2).integers(0, 255, (HEIGHT, WIDTH)).astype(np.uint8)
        corrected = correct(rs, fit_curve(published_field()))
        middle = slice(HEIGHT // 2 - 1, HEIGHT // 2 + 1)
        self.assertLess(np.abs(corrected[middle].astype(int) - rs[middle]).mean(), 20)
        self.assertGreater(np.abs(corrected[:40, 40:-40].astype(int) - rs[:40, 40:-40]).mean(), 40)


class Reader(unittest.TestCase):
    def test_reads_the_published_layout(self):
        with tempfile.TemporaryDirectory() as name:
            write_sample(Path(name) / "RS_Real" / "train" / "a" / "0001.npz")
            files = rs_real_files(Path(name))
            self.assertEqual(len(files), 1)
            sample = RsReal(files, "compact").draw(np.random.default_rng(1))
            self.assertEqual(sample["rotation"].shape, (3, BANDS))
            np.testing.assert_allclose(
                sample["rotation"], curve().at(band_times()), atol=CURVE_TOLERANCE
            )
            published = RsReal(files, "reference")
            self.assertEqual(published.reference_row, "first")
            self.assertEqual(RsReal(files, "compact").reference_row, "middle")
            small = published.draw(np.random.default_rng(1))
            rs, gs, field = read_pair(files[0])
            # Network units are 63rds of the small picture's px; zero on the first row.
            row, column = 40, 20
            where = np.s_[:, int((row + 0.5) / 64 * HEIGHT), int((column + 0.5) / 64 * WIDTH)]
            expected = field[where] * 64 / np.array([WIDTH, HEIGHT]) / 63
            np.testing.assert_allclose(small["field"][:, row, column], expected, atol=2e-4)
            self.assertLess(np.abs(small["field"][:, 0]).max() * 63, 0.1)
            np.testing.assert_array_equal(small["rs"], small["gs"][:, :, ::-1])
            sizes, residuals = fit_residuals(files)
            self.assertGreater(sizes[0], 10 * residuals[0])
            self.assertIn("1 files", fit_report(files))

    def test_says_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "0001.npz"
            with self.assertRaisesRegex(SystemExit, "no .npz"):
                rs_real_files(Path(name))
            np.savez(path, condition=np.zeros((4, 4, 3), np.uint8))
            with self.assertRaisesRegex(SystemExit, "'gs'"):
                read_pair(path)
            picture = np.zeros((4, 4, 3), np.uint8)
            np.savez(path, condition=picture, gs=picture, out_flow=np.zeros((2, 5, 4)))
            with self.assertRaisesRegex(SystemExit, "do not fit"):
                read_pair(path)
