# SPDX-License-Identifier: Apache-2.0
"""Curves, fields and warps: signs, units, and the numbers that igf is compared with."""

import sys
import unittest
from pathlib import Path

import numpy as np
import torch

sys.path.insert(0, str(Path(__file__).parents[1] / "data"))
import make_training_field
from metrics import field_errors, psnr
from motion_field import curve_warp_field, first_order_field, warp
from rotation_curve import BANDS, SCALE, RotationCurve, band_times, gs_from_rs_map, rs_from_gs

# Perspective adds (x / f)^2 of the field at its edge: a sixteenth, here of some px.
FIRST_ORDER_PX = 0.5


class ExactField(unittest.TestCase):
    def test_stored_numbers_are_still_made(self):
        stored = np.loadtxt(make_training_field.FILE, delimiter=",", skiprows=1)
        np.testing.assert_allclose(make_training_field.table(), stored, atol=2e-5)

    def test_both_directions_are_inverse(self):
        curve, size = make_training_field.stated_curve(), (400, 300)
        points = np.array([[200.0, 150.0], [120.0, 60.0], [310.0, 250.0]])
        rs = rs_from_gs(curve, *size, 320.0, points)
        x, y = gs_from_rs_map(curve, *size, 320.0)
        for (px, py), gs in zip(rs, points):
            left, top = int(px), int(py)
            fx, fy = px - left, py - top
            square = np.stack([x, y])[:, top : top + 2, left : left + 2]
            back = square @ [1 - fx, fx] @ [1 - fy, fy]
            np.testing.assert_allclose(back, gs, atol=2e-3)  # bilinear between whole pixels

    def test_middle_row_stays(self):
        curve = make_training_field.stated_curve()
        row = np.array([[x, 149.5] for x in range(0, 400, 50)])
        np.testing.assert_allclose(rs_from_gs(curve, 400, 300, 320.0, row), row, atol=1e-3)

    def test_yaw_to_the_right_grows_down_the_rows(self):
        """a > 0 below the middle: what a GS pixel shows was recorded further right there."""
        t = RotationCurve.times()
        curve = RotationCurve(np.stack([0.04 * t, 0 * t, 0 * t]))
        points = np.array([[200.0, 20.0], [200.0, 280.0]])
        moved = rs_from_gs(curve, 400, 300, 320.0, points) - points
        self.assertLess(moved[0, 0], -4.0)
        self.assertGreater(moved[1, 0], 4.0)


class FirstOrderField(unittest.TestCase):
    def test_is_close_to_the_exact_one(self):
        curve = make_training_field.stated_curve()
        values = 0.4 * curve.at(band_times())
        curve = RotationCurve(0.4 * curve.values)
        units = torch.from_numpy((values / SCALE[:, None]).astype(np.float32))[None]
        field = first_order_field(units, torch.tensor([400 / 300]), 6)[0].numpy() * 300
        x = (np.arange(6) + 0.5) / 6 * 400 - 0.5
        y = (np.arange(BANDS) + 0.5) / BANDS * 300 - 0.5
        points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        exact = (rs_from_gs(curve, 400, 300, 800.0, points) - points).T.reshape(2, BANDS, 6)
        self.assertGreater(np.abs(exact).max(), 4.0)
        self.assertLess(np.abs(field - exact).max(), FIRST_ORDER_PX)

    def test_a_warp_takes_from_where_the_field_points(self):
        picture = torch.arange(64.0).repeat(1, 1, 48, 1)
        units = torch.zeros(1, 3, BANDS)
        aspect = torch.tensor([64 / 48])
        units[:, 0] = 2 / 48 / SCALE[0]  # two of 48 rows' px to the right
        warped, inside = warp(picture, curve_warp_field(units, aspect, 48, 64))
        torch.testing.assert_close(warped[..., :60], picture[..., 2:62], atol=1e-3, rtol=0)
        self.assertFalse(inside[..., -2:].any())
        self.assertTrue(inside[..., :61].all())


class Figures(unittest.TestCase):
    def test_doing_nothing_leaves_everything(self):
        truth = torch.randn(5, 2, 8, 6)
        truth[4] = 0.0  # a still frame
        figures = field_errors(torch.zeros_like(truth), truth)
        for name in ("u", "v", "epe"):
            self.assertAlmostEqual(figures[name], 1.0, places=5)
        self.assertEqual(figures["still_px"], 0.0)
        self.assertAlmostEqual(field_errors(truth, truth)["epe"], 0.0)

    def test_still_frames_are_told_in_px_of_600_rows(self):
        predicted = torch.zeros(1, 2, 4, 4)
        predicted[:, 1] = 1 / 600
        self.assertAlmostEqual(
            field_errors(predicted, torch.zeros_like(predicted))["still_px"], 1.0, places=5
        )

    def test_psnr_leaves_invalid_pixels_out(self):
        truth, valid = torch.zeros(1, 1, 4, 4), torch.ones(1, 1, 4, 4)
        valid[..., 0] = 0
        picture = torch.full_like(truth, 0.1)
        picture[..., 0] = 1.0
        self.assertAlmostEqual(psnr(picture, truth, valid), 20.0, places=4)
