# SPDX-License-Identifier: Apache-2.0
"""Rolling-shutter pictures with known motion, made on the fly from photographs.

A global-shutter view is cut from a photograph at random, its rows are exposed along a random
rotation curve (I_RS(y) = I_GS(H_ref<-row y), exact in one step), and it is blurred, toned and made
noisy. The cut leaves a margin for the motion, so no border shows what was done.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from orientation_planes import working_size
from rotation_curve import CurveSampler, band_times, gs_from_rs_map, rs_from_gs
from samples import FIELD_SIDE, Sample, compact_sample, reference_sample, small_grid, stacked

PHOTO_SIDE = 480  # longest side at which photographs are kept: about 1:1 with the working size
ASPECTS = ((4, 3), (4, 3), (4, 3), (16, 9), (3, 2), (3, 4), (9, 16))
SUFFIXES = {".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"}
MARGIN_PX = 2.0


def photo_files(folder: Path) -> list[Path]:
    """All pictures of a folder and the folders below."""
    files = [p for p in sorted(folder.rglob("*")) if p.suffix.lower() in SUFFIXES]
    if not files:
        raise SystemExit(f"{folder}: no photographs ({', '.join(sorted(SUFFIXES))})")
    return files


def load_photos(files: list[Path], color: bool) -> list[np.ndarray]:
    """Grey or RGB uint8 pictures, longest side at most PHOTO_SIDE; unreadable ones left out."""
    photos = []
    for path in files:
        photo = cv2.imread(str(path), cv2.IMREAD_COLOR if color else cv2.IMREAD_GRAYSCALE)
        if photo is None:
            continue
        scale = PHOTO_SIDE / max(photo.shape[:2])
        if scale < 1.0:
            size = (round(photo.shape[1] * scale), round(photo.shape[0] * scale))
            photo = cv2.resize(photo, size, interpolation=cv2.INTER_AREA)
        photos.append(cv2.cvtColor(photo, cv2.COLOR_BGR2RGB) if color else photo)
    return photos


class Synthesizer:
    """A SampleSource. Photographs are grey for compact samples, RGB for reference ones."""

    reference_row = "middle"

    def __init__(self, photos: list[np.ndarray], curves: CurveSampler):
        self.photos = photos
        self.curves = curves

    def batch(self, rng: np.random.Generator, count: int) -> Sample:
        return stacked([self.draw(rng) for _ in range(count)])

    def draw(self, rng: np.random.Generator) -> Sample:
        cv2.setRNGSeed(int(rng.integers(2**31)))  # sensor noise comes from OpenCV's generator
        photo = self.photos[rng.integers(len(self.photos))]
        if rng.random() < 0.06:
            photo = np.rot90(photo)  # a sensor held sideways
        if rng.random() < 0.5:
            photo = photo[:, ::-1]
        photo = np.ascontiguousarray(photo)
        landscape = photo.shape[1] >= photo.shape[0]
        aspect = ASPECTS[rng.integers(len(ASPECTS))]
        if (aspect[0] > aspect[1]) != landscape and rng.random() < 0.8:
            aspect = aspect[::-1]
        width, height = working_size(*aspect)
        focal = width * np.exp(rng.uniform(np.log(0.5), np.log(2.0)))
        curve = self.curves.draw(rng)
        maps = [
            gs_from_rs_map(curve, width, height, focal, shift) for shift in exposure_shifts(rng)
        ]
        photo_from_gs = random_view(rng, photo.shape, maps, width, height)
        rs = expose(photo, photo_from_gs, maps)
        gs = cv2.warpAffine(
            photo, photo_from_gs, (width, height),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REFLECT_101,
        )
        tone = random_tone(rng, channels=1 if photo.ndim == 2 else 3)
        rs, gs = cv2.LUT(rs, tone), cv2.LUT(gs, tone)
        rs = spoil(rng, rs)
        if photo.ndim == 2:
            return compact_sample(rs, gs, curve.at(band_times()))
        points = small_grid(width, height)
        field = (rs_from_gs(curve, width, height, focal, points) - points).T
        return reference_sample(rs, gs, field.reshape(2, FIELD_SIDE, FIELD_SIDE))


def exposure_shifts(rng: np.random.Generator) -> np.ndarray:
    """Times within the exposure at which rows are taken, in readouts; one when there is no blur."""
    exposure = rng.uniform(0.1, 0.5) if rng.random() < 0.35 else 0.0
    return np.linspace(-0.5, 0.5, 4) * exposure if exposure else np.zeros(1)


def random_view(
    rng: np.random.Generator, photo_shape: tuple[int, ...], maps: list, width: int, height: int
) -> np.ndarray:
    """2x3 affine photo <- GS picture, with room for every displaced pixel and the picture itself.

    maps: where RS pixels lie in the GS picture, see gs_from_rs_map. Rows map to straight lines, so
    the rows' ends bound them.
    """
    edge_x = np.concatenate([x[:, [0, -1]].ravel() for x, _ in maps] + [[0, width - 1] * 2])
    edge_y = np.concatenate([y[:, [0, -1]].ravel() for _, y in maps] + [[0, 0, *[height - 1] * 2]])
    angle = np.radians(rng.normal() * (2.0 if rng.random() < 0.9 else 6.0))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = turn @ np.stack([edge_x, edge_y])
    low, high = corners.min(axis=1) - MARGIN_PX, corners.max(axis=1) + MARGIN_PX
    room = np.array([photo_shape[1] - 1, photo_shape[0] - 1], float)
    scale = (room / (high - low)).min() * (1.0 - 0.35 * rng.random() ** 1.5)
    free = room - scale * (high - low)
    offset = -scale * low + rng.random(2) * free
    return np.column_stack([scale * turn, offset]).astype(np.float32)


def photo_map(affine: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where points of the GS picture lie in the photograph."""
    return (
        affine[0, 0] * x + affine[0, 1] * y + affine[0, 2],
        affine[1, 0] * x + affine[1, 1] * y + affine[1, 2],
    )


def expose(photo: np.ndarray, affine: np.ndarray, maps: list) -> np.ndarray:
    """The RS picture; with several maps, their mean is the motion blur."""
    shots = [cv2.remap(photo, *photo_map(affine, x, y), cv2.INTER_LINEAR,
                       borderMode=cv2.BORDER_REFLECT_101) for x, y in maps]
    if len(shots) == 1:
        return shots[0]
    total = shots[0].astype(np.uint16)
    for shot in shots[1:]:
        total = cv2.add(total, shot, dtype=cv2.CV_16U)
    return cv2.convertScaleAbs(total, alpha=1.0 / len(shots))


def random_tone(rng: np.random.Generator, channels: int) -> np.ndarray:
    """Look-up table 1 x 256 x channels: exposure, contrast, gamma, for colour white balance too."""
    levels = np.arange(256) / 255.0
    gamma = np.exp(0.3 * rng.normal())
    low, high = sorted(rng.uniform([0.0, 0.75], [0.15, 1.0]))
    balance = np.ones(1) if channels == 1 else rng.uniform(0.85, 1.0, channels)
    tone = (low + (high - low) * levels[:, None] ** gamma) * balance
    return np.clip(255 * tone, 0, 255).astype(np.uint8)[None]


def spoil(rng: np.random.Generator, rs: np.ndarray) -> np.ndarray:
    """Soft focus, sensor noise, compression; each on some pictures."""
    if rng.random() < 0.2:
        rs = cv2.GaussianBlur(rs, (0, 0), rng.uniform(0.4, 1.2))
    if rng.random() < 0.6:
        noise = np.empty((rs.shape[0], rs.size // rs.shape[0]), np.int8)
        cv2.randn(noise, 0, rng.uniform(0.5, 6.0))
        rs = cv2.add(rs, noise.reshape(rs.shape), dtype=cv2.CV_8U)
    if rng.random() < 0.1:
        quality = [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(60, 95))]
        _, packed = cv2.imencode(".jpg", rs, quality)
        rs = cv2.imdecode(packed, cv2.IMREAD_UNCHANGED)
    return rs
