# SPDX-License-Identifier: Apache-2.0
"""Schedules and DDIM against closed forms."""

import math
import unittest

import torch

from diffusion import OBJECTIVES, NoiseSchedule, ddim_sample, guided, time_pairs

ROUNDING = 1e-5


def exact_output(objective: str, x0: torch.Tensor, x: torch.Tensor, abar: float) -> torch.Tensor:
    """What a network that knows x0 says."""
    noise = (x - math.sqrt(abar) * x0) / math.sqrt(1 - abar)
    v = math.sqrt(abar) * noise - math.sqrt(1 - abar) * x0
    return {"x0": x0, "noise": noise, "v": v}[objective]


class Schedules(unittest.TestCase):
    def test_linear_ends(self) -> None:
        tables = NoiseSchedule.linear(1000).tables("x0")
        self.assertAlmostEqual(tables["betas"][0].item(), 1e-4, places=9)
        self.assertAlmostEqual(tables["betas"][-1].item(), 0.02, places=8)
        self.assertAlmostEqual(tables["alphas_cumprod"][-1].item(), 4.036e-5, delta=1e-8)

    def test_cosine_follows_its_formula(self) -> None:
        abar = NoiseSchedule.cosine(1000).tables("x0")["alphas_cumprod"]
        start = math.cos(0.008 / 1.008 * math.pi / 2) ** 2
        middle = math.cos((0.5 + 0.008) / 1.008 * math.pi / 2) ** 2 / start
        self.assertAlmostEqual(abar[499].item(), middle, delta=ROUNDING)

    def test_loss_weights_make_objectives_equal(self) -> None:
        schedule = NoiseSchedule.cosine(100)
        abar = schedule.tables("x0")["alphas_cumprod"][30].double()
        snr = (abar / (1 - abar)).item()
        for objective, weight in zip(OBJECTIVES, (snr, 1.0, snr / (1 + snr))):
            self.assertAlmostEqual(
                schedule.tables(objective)["loss_weight"][30].item(), weight, delta=ROUNDING * snr
            )

    def test_published_time_pairs(self) -> None:
        pairs = time_pairs(1000, 8)
        self.assertEqual([a for a, _ in pairs], [999, 874, 749, 624, 499, 374, 249, 124])
        self.assertEqual([b for _, b in pairs], [874, 749, 624, 499, 374, 249, 124, -1])


class Sampling(unittest.TestCase):
    def setUp(self) -> None:
        torch.manual_seed(4)
        self.x0 = torch.rand(2, 2, 8, 8) * 1.8 - 0.9
        self.x = torch.randn(2, 2, 8, 8)
        self.schedule = NoiseSchedule.linear(1000)
        self.abar = self.schedule.tables("x0")["alphas_cumprod"].tolist()

    def test_a_network_that_knows_is_believed(self) -> None:
        for objective in OBJECTIVES:
            for eta in (0.0, 1.0):
                found = ddim_sample(
                    lambda x, t: exact_output(objective, self.x0, x, self.abar[int(t[0])]),
                    self.x,
                    self.schedule,
                    steps=5,
                    objective=objective,
                    eta=eta,
                    generator=torch.Generator().manual_seed(1),
                )
                # Noise divided by sqrt(abar) at T-1, about 160 times float32's rounding.
                self.assertLess((found - self.x0).abs().max().item(), 1e-4)

    def test_x0_is_kept_in_its_range(self) -> None:
        found = ddim_sample(lambda x, t: 3 * x, self.x, self.schedule, steps=3, clip_range=0.5)
        self.assertEqual(found.abs().max().item(), 0.5)

    def test_eta_one_of_gaussian_data_keeps_its_spread(self) -> None:
        # Data of deviation s: the best guess of x0 is x sqrt(abar) s^2 / (abar s^2 + 1 - abar).
        spread = 0.2

        def posterior_mean(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
            abar = self.abar[int(t[0])]
            return x * math.sqrt(abar) * spread**2 / (abar * spread**2 + 1 - abar)

        x = torch.randn(1, 1, 100, 100)
        for eta in (0.0, 1.0):
            found = ddim_sample(posterior_mean, x, self.schedule, steps=1000, eta=eta)
            # 10^4 samples know their deviation to 0.7%; the last steps leave up to 3% (eta 1).
            self.assertAlmostEqual(found.std().item(), spread, delta=0.04 * spread)


class Guidance(unittest.TestCase):
    def test_scale_extrapolates_and_rescale_pulls_back(self) -> None:
        torch.manual_seed(5)
        conditional, unconditional = torch.randn(2, 3, 8, 8), torch.randn(2, 3, 8, 8)
        plain = guided(conditional, unconditional, 3.0, 0.0)
        expected = unconditional + 3 * (conditional - unconditional)
        self.assertLess((plain - expected).abs().max().item(), ROUNDING)
        full = guided(conditional, unconditional, 3.0, 1.0)
        for sample, target in zip(full, conditional):
            self.assertAlmostEqual(sample.std().item(), target.std().item(), delta=1e-4)
