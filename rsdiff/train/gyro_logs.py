# SPDX-License-Identifier: Apache-2.0
"""Real gyro logs as sources of motion curves: CSV, old Gyroflow JSON, raw GPMF payloads."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np


def _gpmf_items(data: bytes):
    """(key, type, element size, payload) of every leaf, nested containers entered."""
    at = 0
    while at + 8 <= len(data):
        key, kind, size, count = struct.unpack_from(">4sBBH", data, at)
        length = size * count
        body = data[at + 8 : at + 8 + length]
        at += 8 + (length + 3) // 4 * 4
        if kind == 0:
            yield from _gpmf_items(body)
        else:
            yield key, kind, size, body


def _read_gpmf(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The rate is nominal (about one payload a second): only the shape of motion matters here."""
    blocks, scale, payloads = [], 1.0, 0
    for key, _, _, body in _gpmf_items(path.read_bytes()):
        if key == b"SCAL" and len(body) in (2, 4):
            scale = float(int.from_bytes(body, "big"))
        elif key == b"GYRO":
            raw = np.frombuffer(body, ">i2")
            blocks.append(raw[: raw.size // 3 * 3].reshape(-1, 3) / scale)
            payloads += 1
    rates = np.concatenate(blocks)[:, [1, 0, 2]]
    return np.linspace(0.0, 1.001 * payloads, len(rates)), rates


def read_gyro_log(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times (s) and n x 3 rates (rad/s, in some right-handed order of axes), mean removed."""
    if path.suffix == ".csv":
        table = np.genfromtxt(path, delimiter=",", names=True)
        names = table.dtype.names
        times = table[names[0]]
        rates = np.stack([table[n] for n in names[1:4]], axis=1)
    elif path.suffix == ".gyroflow":
        raw = np.array(json.loads(path.read_text())["raw_imu"], float)
        times, rates = raw[:, 0], raw[:, 1:4]
    else:
        times, rates = _read_gpmf(path)
    return times, rates - rates.mean(axis=0)


def read_gyro_folder(folder: Path) -> list[tuple[np.ndarray, np.ndarray]]:
    """Every readable log of at least half a second in a folder."""
    logs = []
    for path in sorted(folder.iterdir()):
        if path.suffix not in (".csv", ".gyroflow", ".raw"):
            continue
        try:
            times, rates = read_gyro_log(path)
        except (KeyError, IndexError, ValueError):
            continue  # a table of something else
        if len(times) > 100 and rates.std() > 1e-3:
            logs.append((times, rates))
    return logs
