# SPDX-License-Identifier: Apache-2.0
"""Samples made from photographs: the motion is the stated one, and nothing gives it away."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import cv2
import numpy as np
import torch

import sample_pool
import synthesis
from data_source import Batches, PreferStructure, as_tensors, mirrored, structure_score
from orientation_planes import orientation_planes, working_size
from rotation_curve import BANDS, CurveSampler
from samples import KINDS

# A byte of the planes is 1/32; cells are not mirror images where 16 do not divide the width.
MIRROR_MEAN_BYTES = 1.0


def painted(width: int, height: int, color: bool = False) -> np.ndarray:
    """Rows of windows with some noise: structure everywhere."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[0:height, 0:width]
    windows = ((x // 24) % 2) * ((y // 18) % 2) * 110 + 70 + (x + 2 * y) % 37
    picture = np.clip(windows + rng.normal(0, 4, windows.shape), 0, 255).astype(np.uint8)
    return np.dstack([picture, picture // 2, 255 - picture]) if color else picture


def synthesizer(color: bool = False) -> synthesis.Synthesizer:
    photos = [painted(480, 360, color), painted(340, 470, color)]
    return synthesis.Synthesizer(photos, CurveSampler())


class Samples(unittest.TestCase):
    def test_each_network_gets_its_arrays(self):
        for kind, color in (("compact", False), ("reference", True)):
            batch = synthesizer(color).batch(np.random.default_rng(1), 2)
            self.assertEqual(tuple(batch), KINDS[kind])
        self.assertEqual(batch["rs"].shape, (2, 3, 64, 64))
        self.assertEqual(batch["field"].shape, (2, 2, 64, 64))
        self.assertLess(np.abs(batch["field"]).max(), 1.0)

    def test_the_field_takes_the_rs_picture_to_the_gs_picture(self):
        """Sampling RS at x + G(x) must come closer to GS than RS itself, whatever was drawn."""
        source, rng = synthesizer(True), np.random.default_rng(3)
        grid = np.stack(np.meshgrid(np.arange(64), np.arange(64)), axis=0).astype(np.float32)
        before, after = [], []
        for _ in range(8):
            sample = source.draw(rng)
            where = grid + 63 * sample["field"]
            rs, gs = (sample[n].transpose(1, 2, 0).astype(np.float32) for n in ("rs", "gs"))
            warped = cv2.remap(rs, where[0], where[1], cv2.INTER_LINEAR)
            inner = np.s_[6:-6, 6:-6]
            before.append(np.abs(rs - gs)[inner].mean())
            after.append(np.abs(warped - gs)[inner].mean())
        self.assertLess(np.mean(after), 0.75 * np.mean(before))

    def test_the_photographs_edge_is_never_seen(self):
        """A border of another colour would betray any pixel from beyond it."""
        source, rng = synthesizer(), np.random.default_rng(2)
        beyond_px = []
        plain = synthesis.photo_map

        def watched(affine, x, y):
            u, v = plain(affine, x, y)
            width, height = watched.size
            beyond_px.append(max(-u.min(), -v.min(), u.max() - width + 1, v.max() - height + 1))
            return u, v

        for photo in source.photos + [np.rot90(p) for p in source.photos]:
            one = synthesis.Synthesizer([photo], source.curves)
            with mock.patch.object(synthesis, "photo_map", watched), mock.patch.object(
                np, "rot90", lambda p: p
            ):
                watched.size = (photo.shape[1], photo.shape[0])
                for _ in range(12):
                    one.draw(rng)
        self.assertGreater(len(beyond_px), 48, "some have motion blur, several maps each")
        self.assertLess(max(beyond_px), 0.0)

    def test_a_seed_names_a_shard(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for shard, seed in (("shard-0000", 1), ("shard-0001", 1), ("shard-0002", 2)):
                cv2.setRNGSeed(len(shard) + seed)  # of no influence
                sample_pool.make_shard(synthesizer(), folder / shard, (seed, 0), 4)
            pool = sample_pool.SamplePool(folder, "compact")
            first, again, other = (pool.shards[f"shard-000{i}"] for i in range(3))
            for array in KINDS["compact"]:
                np.testing.assert_array_equal(first[array], again[array])
            self.assertTrue((first["planes"] != other["planes"]).any())
            self.assertEqual((len(pool), pool.reference_row), (12, "middle"))
            self.assertEqual(pool.batch(np.random.default_rng(1), 5)["planes"].shape[0], 5)

    def test_a_pool_for_another_network_is_refused(self):
        with tempfile.TemporaryDirectory() as name:
            sample_pool.make_shard(synthesizer(), Path(name) / "shard-0000", (1, 0), 1)
            with self.assertRaisesRegex(SystemExit, "rs.npy"):
                sample_pool.SamplePool(Path(name), "reference")

    def test_batches_depend_on_seed_process_and_step_alone(self):
        def batch(seed: int, process: int, step: int) -> torch.Tensor:
            return Batches(synthesizer(), 2, seed, process)[step]["planes"]

        self.assertTrue(torch.equal(batch(1, 0, 7), batch(1, 0, 7)))
        for other in ((2, 0, 7), (1, 1, 7), (1, 0, 8)):
            self.assertFalse(torch.equal(batch(1, 0, 7), batch(*other)))


class Mirror(unittest.TestCase):
    def test_planes_of_a_mirrored_picture_are_the_mirrored_planes(self):
        width, height = working_size(4, 3)
        # Leaning lines, so that the mirror image differs.
        lean = cv2.warpAffine(
            painted(width, height), np.array([[1, 0.1, 0], [0.03, 1, 0]]), (width, height),
            borderMode=cv2.BORDER_REFLECT_101,
        )
        plain = orientation_planes(lean)
        other = orientation_planes(np.ascontiguousarray(lean[:, ::-1]))
        batch = as_tensors({
            "planes": plain[None], "rotation": np.zeros((1, 3, BANDS)), "aspect": np.ones(1)
        })
        flipped = mirrored(batch, torch.tensor([True]))["planes"][0].numpy()
        difference = np.abs(flipped.astype(int) - other)
        self.assertLess(difference.mean(), MIRROR_MEAN_BYTES)
        self.assertGreater(np.abs(plain.astype(int) - other).mean(), 3 * MIRROR_MEAN_BYTES)

    def test_yaw_and_roll_change_sign_and_pitch_stays(self):
        batch = as_tensors({
            "planes": np.zeros((2, 32, 24, 16), np.uint8), "rotation": np.ones((2, 3, BANDS)),
            "rs_small": np.arange(2 * 48 * 64).reshape(2, 48, 64).astype(np.uint8),
            "aspect": np.ones(2),
        })
        result = mirrored(batch, torch.tensor([True, False]))
        self.assertEqual(result["rotation"][:, :, 0].tolist(), [[-1, 1, -1], [1, 1, 1]])
        self.assertTrue(torch.equal(result["rs_small"][0], batch["rs_small"][0].flip(-1)))
        self.assertTrue(torch.equal(result["rs_small"][1], batch["rs_small"][1]))

    def test_fields_change_the_sign_of_x(self):
        field = np.random.default_rng(1).normal(size=(1, 2, 64, 64))
        batch = as_tensors({"field": field, "aspect": np.ones(1)})
        result = mirrored(batch, torch.tensor([True]))["field"][0].numpy()
        np.testing.assert_allclose(result[0], -field[0, 0, :, ::-1], rtol=1e-6)
        np.testing.assert_allclose(result[1], field[0, 1, :, ::-1], rtol=1e-6)


class Structure(unittest.TestCase):
    def test_the_more_structured_of_two_is_taken(self):
        rng = np.random.default_rng(1)
        noise = rng.integers(0, 255, (270, 360)).astype(np.uint8)
        planes = np.stack([orientation_planes(noise), orientation_planes(painted(360, 270))])
        self.assertGreater(*structure_score(planes)[::-1])

        class Both:
            reference_row = "middle"

            def batch(self, _, count):
                half = count // 2
                return {"planes": planes[[0] * half + [1] * half], "which": np.repeat([0, 1], half)}

        taken = PreferStructure(Both(), 1.0).batch(rng, 50)["which"]
        self.assertEqual(taken.tolist(), [1] * 50)
        mixed = PreferStructure(Both(), 0.8).batch(rng, 1000)["which"].mean()
        self.assertAlmostEqual(mixed, 0.8, delta=0.05)
