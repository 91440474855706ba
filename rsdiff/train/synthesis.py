# SPDX-License-Identifier: Apache-2.0
"""Rolling-shutter pictures with known motion, made on the fly from photographs.

A global-shutter view is cut from a photograph at random, its rows are exposed along a random
rotation curve (I_RS(y) = I_GS(H_ref<-row y), exact in one step), and it is blurred, toned and made
noisy. The cut leaves a margin for the motion, so no border shows what was done.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from orientation_planes import orientation_planes, small_gray, working_size
from rotation_curve import CurveSampler, RotationCurve, gs_from_rs_map

PHOTO_SIDE = 480  # longest side at which photographs are kept: about 1:1 with the working size
ASPECTS = ((4, 3), (4, 3), (4, 3), (16, 9), (3, 2), (3, 4), (9, 16))


@dataclass
class Sample:
    planes: np.ndarray  # orientation planes of the RS picture, bytes
    rs_small: np.ndarray  # 48 x 64 bytes
    gs_small: np.ndarray
    curve: np.ndarray  # 3 x BANDS, network units
    aspect: float  # width / height


def load_photos(folder: Path) -> list[np.ndarray]:
    """Grey uint8 pictures, longest side at most PHOTO_SIDE."""
    photos = []
    for path in sorted(folder.iterdir()):
        gray = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        if gray is None:
            continue
        scale = PHOTO_SIDE / max(gray.shape)
        if scale < 1.0:
            size = (round(gray.shape[1] * scale), round(gray.shape[0] * scale))
            gray = cv2.resize(gray, size, interpolation=cv2.INTER_AREA)
        photos.append(gray)
    return photos


class Synthesizer:
    def __init__(self, photos: list[np.ndarray], curves: CurveSampler):
        self.photos = photos
        self.curves = curves

    def draw(self, rng: np.random.Generator) -> Sample:
        photo = self.photos[rng.integers(len(self.photos))]
        if rng.random() < 0.06:
            photo = np.rot90(photo)  # a sensor held sideways
        if rng.random() < 0.5:
            photo = photo[:, ::-1]
        landscape = photo.shape[1] >= photo.shape[0]
        aspect = ASPECTS[rng.integers(len(ASPECTS))]
        if (aspect[0] > aspect[1]) != landscape and rng.random() < 0.8:
            aspect = aspect[::-1]
        width, height = working_size(*aspect)
        focal = width * np.exp(rng.uniform(np.log(0.5), np.log(2.0)))
        curve = self.curves.draw(rng)
        picture_from_gs = self._view(rng, photo, curve, width, height, focal)
        rs = self._expose(rng, photo, picture_from_gs, curve, width, height, focal)
        gs = cv2.warpAffine(
            photo, picture_from_gs, (width, height),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REFLECT_101,
        )
        tone = self._tone(rng)
        rs, gs = cv2.LUT(rs, tone), cv2.LUT(gs, tone)
        rs = self._spoil(rng, rs)
        return Sample(
            orientation_planes(rs), small_gray(rs), small_gray(gs), curve.bands(), width / height
        )

    @staticmethod
    def _view(rng, photo, curve, width, height, focal) -> np.ndarray:
        """2x3 affine photo <- GS picture, with room for every displaced pixel."""
        rows = np.array([0, height // 4, height // 2, 3 * height // 4, height - 1])
        x_map, y_map = gs_from_rs_map(curve, width, height, focal)
        edge_x = np.concatenate([x_map[rows[[0, -1]]].ravel(), x_map[:, [0, -1]].ravel()])
        edge_y = np.concatenate([y_map[rows[[0, -1]]].ravel(), y_map[:, [0, -1]].ravel()])
        angle = np.radians(rng.normal() * (2.0 if rng.random() < 0.9 else 6.0))
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        corners = turn @ np.stack([edge_x, edge_y])
        low, high = corners.min(axis=1) - 2.0, corners.max(axis=1) + 2.0
        room = np.array([photo.shape[1] - 1, photo.shape[0] - 1], float)
        scale = (room / (high - low)).min() * (1.0 - 0.35 * rng.random() ** 1.5)
        free = room - scale * (high - low)
        offset = -scale * low + rng.random(2) * free
        return np.column_stack([scale * turn, offset]).astype(np.float32)

    @staticmethod
    def _expose(rng, photo, affine, curve, width, height, focal) -> np.ndarray:
        blur = rng.uniform(0.1, 0.5) if rng.random() < 0.35 else 0.0  # exposure / readout
        shifts = np.linspace(-0.5, 0.5, 4) * blur if blur else (0.0,)
        total = None
        for shift in shifts:
            x, y = gs_from_rs_map(curve, width, height, focal, shift)
            u = affine[0, 0] * x + affine[0, 1] * y + affine[0, 2]
            v = affine[1, 0] * x + affine[1, 1] * y + affine[1, 2]
            shot = cv2.remap(photo, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101)
            total = shot if total is None else cv2.add(total, shot, dtype=cv2.CV_16U)
        if len(shifts) > 1:
            return cv2.convertScaleAbs(total, alpha=1.0 / len(shifts))
        return total

    @staticmethod
    def _tone(rng) -> np.ndarray:
        levels = np.arange(256) / 255.0
        gamma = np.exp(0.3 * rng.normal())
        low, high = sorted(rng.uniform([0.0, 0.75], [0.15, 1.0]))
        return np.clip(255 * (low + (high - low) * levels**gamma), 0, 255).astype(np.uint8)

    @staticmethod
    def _spoil(rng, rs: np.ndarray) -> np.ndarray:
        if rng.random() < 0.2:
            rs = cv2.GaussianBlur(rs, (0, 0), rng.uniform(0.4, 1.2))
        if rng.random() < 0.6:
            noise = np.empty(rs.shape, np.int8)
            cv2.randn(noise, 0, rng.uniform(0.5, 6.0))
            rs = cv2.add(rs, noise, dtype=cv2.CV_8U)
        if rng.random() < 0.1:
            _, packed = cv2.imencode(".jpg", rs, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(60, 95))])
            rs = cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE)
        return rs
