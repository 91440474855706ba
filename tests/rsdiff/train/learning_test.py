# SPDX-License-Identifier: Apache-2.0
"""Losses, averages, schedules and what each learner does with a batch."""

import unittest

import numpy as np
import torch

from checkpoint import TIMESTEPS
from compact_net import CompactConfig, CompactNet
from data_source import as_tensors
from diffusion import NoiseSchedule
from ema import Ema
from image_net import ImageNet
from learners import CompactLearner, ImageLearner, ReferenceLearner
from losses import LossOptions, balanced, curve_loss, size_weight, state_loss, time_weight
from reference_net import ReferenceDiffusion, ReferenceUNet
from rotation_curve import BANDS, SCALE
from samples import KINDS
from train import learning_rate, parse_options, seed_step

SMALL = CompactConfig(width=8, deep_width=8, feature_width=16, denoiser_width=16, heads=2,
                      inter_blocks=1, denoiser_blocks=1)


def batch_of(kind: str, count: int) -> dict[str, torch.Tensor]:
    rng = np.random.default_rng(1)
    shapes = {"planes": (32, 24, 16), "rs_small": (48, 64), "gs_small": (48, 64),
              "rs": (3, 64, 64), "gs": (3, 64, 64)}
    arrays = {"aspect": np.full(count, 4 / 3)}
    for name in KINDS[kind]:
        if name in shapes:
            arrays[name] = rng.integers(0, 255, (count, *shapes[name])).astype(np.uint8)
    if kind == "compact":
        arrays["rotation"] = rng.normal(size=(count, 3, BANDS)) * SCALE[:, None]
    else:
        arrays["field"] = 0.02 * rng.normal(size=(count, 2, 64, 64))
    return as_tensors(arrays)


def small_reference() -> ReferenceDiffusion:
    """The published network's parts, but narrow; 80 M weights are made for nothing otherwise."""
    net = ReferenceDiffusion.__new__(ReferenceDiffusion)
    torch.nn.Module.__init__(net)
    net.model = ReferenceUNet(width=8, multipliers=(1, 2))
    return net


class Losses(unittest.TestCase):
    def test_time_weights(self):
        alphas = NoiseSchedule.linear(TIMESTEPS).tables("x0")["alphas_cumprod"]
        snr = time_weight(alphas, "snr")
        torch.testing.assert_close(snr, NoiseSchedule.linear(TIMESTEPS).tables("x0")["loss_weight"],
                                   rtol=1e-3, atol=0)
        clipped = time_weight(alphas, "clipped")
        self.assertEqual((float(clipped[0]), float(clipped[-1])), (5.0, 1.0))
        inside = (snr > 1) & (snr < 5)
        self.assertTrue(torch.equal(clipped[inside], snr[inside]))
        self.assertEqual(time_weight(alphas, "none").unique().tolist(), [1.0])

    def test_weighted_mean_square(self):
        out, truth = torch.tensor([[[2.0]], [[0.0]]]), torch.tensor([[[0.0]], [[1.0]]])
        self.assertEqual(float(state_loss(out, truth, torch.tensor([1.0, 10.0]))), 7.0)

    def test_a_curve_is_judged_by_its_values_and_slopes(self) -> None:
        truth = torch.zeros(1, 3, 4, 1)
        out = torch.zeros(1, 3, 4, 1)
        out[0, 0, :, 0] = torch.tensor([0.0, 1.0, 2.0, 3.0])  # yaw: slope 4 per readout
        one = torch.ones(1)
        values = (1.0 + 4.0 + 9.0) / 12
        self.assertAlmostEqual(float(curve_loss(out, truth, one, 0.0)), values, places=6)
        self.assertAlmostEqual(
            float(curve_loss(out, truth, one, 0.5)), values + (0.5 * 4) ** 2 / 3, places=6
        )
        pitch = out[:, [1, 0, 2]]
        self.assertAlmostEqual(float(curve_loss(pitch, truth, one, 0.0)), 0.4 * values, places=6)

    def test_huge_motions_count_less(self):
        truth = torch.stack([torch.zeros(3, 4, 1), torch.ones(3, 4, 1), 3 * torch.ones(3, 4, 1)])
        torch.testing.assert_close(size_weight(truth, 1.0), torch.tensor([2.0, 1.0, 0.2]))
        self.assertEqual(size_weight(truth, 0.0).tolist(), [1.0] * 3)
        torch.testing.assert_close(size_weight(truth, 1.0, 2.5), torch.tensor([5.0, 1.0, 0.2]))

    def test_the_second_loss_is_rescaled_to_equal_the_first(self):
        first, second = (torch.tensor(v, requires_grad=True) for v in (2.0, 0.5))
        total = balanced(first, second)
        total.backward()
        self.assertEqual(float(total), 4.0)
        self.assertEqual((float(first.grad), float(second.grad)), (1.0, 4.0))

    def test_learning_rates(self):
        cosine = parse_options(["run", "--lr", "2", "--steps", "1000"])
        self.assertAlmostEqual(learning_rate(2, cosine), 2 * 3 / 300, places=3)
        self.assertAlmostEqual(learning_rate(500, cosine), 2 * 0.51)
        self.assertAlmostEqual(learning_rate(1000, cosine), 2 * 0.02)
        constant = parse_options(["run", "--net", "reference"])
        self.assertEqual(learning_rate(299, constant), 1e-4)
        self.assertEqual(learning_rate(140_000, constant), 1e-4)
        self.assertEqual((constant.weight, constant.photometric, constant.batch, constant.ema),
                         ("snr", True, 64, 0.995))


class Averages(unittest.TestCase):
    def test_ema_follows_slowly(self):
        net = torch.nn.BatchNorm1d(2)
        ema = Ema(net, 0.9)
        values = [1.0]
        for step in range(1, 60):
            with torch.no_grad():
                net.weight.fill_(float(step))
            net.num_batches_tracked += 1
            ema.update(net)
            decay = min(0.9, (1 + step) / (10 + step))
            values.append(decay * values[-1] + (1 - decay) * step)
        torch.testing.assert_close(ema.values["weight"], torch.full((2,), values[-1]))
        self.assertEqual(int(ema.values["num_batches_tracked"]), 59)
        again = Ema(net, 0.9)
        again.load(ema.values, ema.step)
        self.assertTrue(torch.equal(again.values["weight"], ema.values["weight"]))


class Learners(unittest.TestCase):
    def check(self, learner, batch, names: set[str]) -> dict[str, torch.Tensor]:
        """All losses are there, finite, and give every weight that is used a gradient."""
        torch.manual_seed(0)
        losses = learner(batch)
        self.assertEqual(set(losses), names | {"total"})
        self.assertTrue(all(torch.isfinite(v) for v in losses.values()))
        losses["total"].backward()
        with_gradient = [n for n, p in learner.named_parameters() if p.grad is not None]
        self.assertGreater(len(with_gradient), 5)
        return losses

    def test_compact_diffusion(self):
        learner = CompactLearner(CompactNet(SMALL), LossOptions(photometric=True))
        losses = self.check(learner, batch_of("compact", 4), {"motion", "photometric"})
        torch.testing.assert_close(losses["total"], 2 * losses["motion"])

    def test_regression_and_ablated_attention(self):
        for intra, inter in ((False, False), (True, False)):
            config = CompactConfig(**{**SMALL.__dict__, "intra_patch": intra, "inter_patch": inter})
            learner = CompactLearner(CompactNet(config), LossOptions(regression=True))
            self.check(learner, batch_of("compact", 3), {"motion"})

    def test_reference(self):
        options = LossOptions(weight="snr", photometric=True, draws=1, drop_condition=0.5)
        learner = ReferenceLearner(small_reference(), options)
        self.check(learner, batch_of("reference", 2), {"motion", "photometric"})
        learner.eval()
        figures = learner.figures(batch_of("reference", 2))
        self.assertTrue(np.isfinite(list(figures.values())).all())

    def test_image_to_image(self):
        learner = ImageLearner(ImageNet(8, 8))
        self.check(learner, batch_of("compact", 3), {"picture"})
        self.assertEqual(set(learner.eval().figures(batch_of("compact", 3))), {"psnr_rs", "psnr"})

    def test_a_perfect_prediction_leaves_nothing(self):
        """The truth in network units, through every figure."""
        batch = batch_of("compact", 4)
        batch["rotation"][0] = 0.0
        learner = CompactLearner(CompactNet(SMALL), LossOptions()).eval()
        learner._from_nothing = lambda start, context: learner.truth(batch)
        figures = learner.figures(batch)
        for name in ("u", "v", "epe", "still_px", "mse"):
            self.assertEqual(figures[name], 0.0, name)

    def test_pictures_are_dropped_at_the_stated_rate(self):
        seen_by = []
        learner = CompactLearner(CompactNet(SMALL), LossOptions(draws=3, drop_condition=0.25))
        learner.denoise = lambda noisy, t, context, seen: (seen_by.append((t, seen)), noisy)[1]
        seed_step(1, 0, 0)
        learner(batch_of("compact", 400))
        (t, seen), = seen_by
        self.assertTrue(seen[:400].all(), "the first draw sees the picture")
        self.assertGreaterEqual(int(t[:400].min()), TIMESTEPS - 50)
        self.assertAlmostEqual(float(seen[400:].float().mean()), 0.75, delta=0.06)
        self.assertLess(int(t[400:].min()), 20)
