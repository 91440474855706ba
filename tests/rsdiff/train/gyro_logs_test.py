# SPDX-License-Identifier: Apache-2.0
"""Gyro logs as sources of motion, on payloads made here."""

import json
import struct
import tempfile
import unittest
from pathlib import Path

import numpy as np

from gyro_logs import read_gyro_folder, read_gyro_log
from rotation_curve import CurveSampler

SCALE = 100
COUNT = 400


def item(key: bytes, kind: bytes, size: int, body: bytes) -> bytes:
    head = key + (kind or b"\0") + struct.pack(">BH", size, len(body) // size)
    return head + body + b"\0" * (-len(body) % 4)


def payload(rates: np.ndarray) -> bytes:
    """One DEVC > STRM with the integers that a camera stores, channels z, x, y."""
    stored = np.round(rates * SCALE).astype(">i2")
    stream = item(b"STNM", b"c", 1, b"Gyroscope (z,x,y)")
    stream += item(b"SCAL", b"s", 2, struct.pack(">h", SCALE)) + item(
        b"GYRO", b"s", 6, stored.tobytes())
    return item(b"DEVC", b"", 1, item(b"STRM", b"", 1, stream))


def wave() -> np.ndarray:
    t = np.linspace(0, 1, COUNT, endpoint=False)
    return np.stack([np.sin(2 * np.pi * f * t) for f in (1, 2, 3)], axis=1)


class GyroLogs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_gpmf_payloads(self):
        path = self.folder / "log.raw"
        path.write_bytes(payload(wave()) + payload(wave()))
        times, rates = read_gyro_log(path)
        self.assertEqual(rates.shape, (2 * COUNT, 3))
        self.assertAlmostEqual(times[-1], 2.002)
        expected = np.tile(wave(), (2, 1))[:, [1, 0, 2]]
        np.testing.assert_allclose(rates, expected, atol=0.6 / SCALE)

    def test_csv(self):
        path = self.folder / "log.csv"
        table = np.column_stack([np.arange(COUNT) / 400, wave()])
        np.savetxt(path, table, delimiter=",", header="t_s,gx,gy,gz", comments="")
        times, rates = read_gyro_log(path)
        np.testing.assert_allclose(times, table[:, 0])
        np.testing.assert_allclose(rates, wave(), atol=1e-6)

    def test_a_folder_leaves_out_what_is_no_log(self):
        (self.folder / "a.raw").write_bytes(payload(wave()))
        (self.folder / "cut.raw").write_bytes(payload(wave())[:40])
        (self.folder / "still.csv").write_text("t,x,y,z\n" + "0,0,0,0\n" * 200)
        (self.folder / "other.csv").write_text("a,b\n1,2\n")
        (self.folder / "old.gyroflow").write_text(json.dumps({
            "raw_imu": np.column_stack([np.arange(COUNT) / 400, wave(), wave()]).tolist()
        }))
        (self.folder / "new.gyroflow").write_text("{}")
        (self.folder / "README").write_text("not looked at")
        logs = read_gyro_folder(self.folder)
        self.assertEqual([len(rates) for _, rates in logs], [COUNT, COUNT])
        curve = CurveSampler(logs).draw(np.random.default_rng(1))
        self.assertTrue(np.isfinite(curve.values).all())
