# SPDX-License-Identifier: Apache-2.0
"""Checkpoints become model folders; code and damage in them are refused."""

import collections
import hashlib
import json
import os
import tempfile
import unittest
from pathlib import Path
from typing import Any

import torch

from convert_checkpoint import convert
from diffusion import NoiseSchedule
from reference_net import ReferenceDiffusion

SMALL = {"width": 16, "multipliers": (1, 2), "field_size": 16}


def small_state(seed: int, schedule: NoiseSchedule = NoiseSchedule.linear(1000)) -> dict[str, Any]:
    torch.manual_seed(seed)
    return ReferenceDiffusion(schedule, **SMALL).state_dict()


def published_checkpoint() -> dict[str, Any]:
    """Laid out as the published trainer saves it."""
    raw, average = small_state(1), small_state(2)
    ema: dict[str, Any] = {"initted": torch.tensor([True]), "step": torch.tensor([150000])}
    ema |= {f"online_model.{key}": value for key, value in raw.items()}
    ema |= {f"ema_model.{key}": value for key, value in average.items()}
    optimizer = torch.optim.Adam([torch.nn.Parameter(torch.ones(3))], lr=1e-4)
    return {
        "step": 150000,
        "model": raw,
        "opt": optimizer.state_dict(),
        "ema": collections.OrderedDict(ema),
        "scaler": {"scale": 65536.0, "growth_interval": 2000},
        "version": "1.6.0",
    }


class RunsCode:
    """Unpickled carelessly, makes a file."""

    def __init__(self, file: Path):
        self.file = file

    def __reduce__(self) -> Any:
        return os.system, (f"touch {self.file}",)


class Conversion(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.checkpoint = self.folder / "in.pt"
        self.model = self.folder / "model"

    def convert(self, content: Any, **options: Any) -> dict[str, Any]:
        torch.save(content, self.checkpoint)
        convert(self.checkpoint, self.model, **options)
        return json.loads((self.model / "model.json").read_text())

    def bias_of_model(self) -> torch.Tensor:
        return torch.jit.load(str(self.model / "network.pt")).state_dict()["final_conv.bias"]

    def expect_refusal(self, reason: str) -> None:
        with self.assertRaisesRegex(SystemExit, reason):
            convert(self.checkpoint, self.model)
        self.assertFalse((self.model / "model.json").exists())

    def test_model_file_says_what_the_program_asks(self) -> None:
        account = self.convert(published_checkpoint())
        weights = account.pop("weights")["network"]
        content = (self.model / weights["file"]).read_bytes()
        self.assertEqual(weights["sha256"], hashlib.sha256(content).hexdigest())
        self.assertEqual(
            account,
            {
                "format": "rs-stabilize model",
                "version": 1,
                "name": "reference",
                "backend": "torch",
                "condition": {"kind": "rgb", "channels": 3, "rows": 16, "columns": 16},
                "motion": {
                    "kind": "dense-field",
                    "rows": 16,
                    "columns": 16,
                    "reference_row": "first",
                },
                "diffusion": {"steps": 1000, "schedule": "linear", "objective": "x0"},
                "sampling": {"steps": 8, "eta": 1, "clip_range": 1},
                "training": {"source": "in.pt", "weights": "averaged", "step": 150000},
            },
        )
        self.assertEqual(sorted(p.name for p in self.model.iterdir()), ["model.json", "network.pt"])

    def test_averaged_weights_are_preferred_and_raw_ones_at_hand(self) -> None:
        checkpoint = published_checkpoint()
        self.convert(checkpoint)
        average = checkpoint["ema"]["ema_model.model.final_conv.bias"]
        self.assertTrue(torch.equal(self.bias_of_model(), average))
        self.convert(checkpoint, raw=True)
        self.assertTrue(torch.equal(self.bias_of_model(), checkpoint["model"]["model.final_conv.bias"]))

    def test_bare_weights_and_own_checkpoints_are_read(self) -> None:
        state = small_state(3)
        bare = {key[6:]: value for key, value in state.items() if key.startswith("model.")}
        for content in (state, bare, {"model": small_state(4), "ema": state}):
            self.convert(content)
            self.assertTrue(torch.equal(self.bias_of_model(), state["model.final_conv.bias"]))

    def test_schedule_and_objective_are_recognised(self) -> None:
        state = ReferenceDiffusion(NoiseSchedule.cosine(500), "v", **SMALL).state_dict()
        account = self.convert({"model": state, "ema": state, "reference_row": "middle"})
        self.assertEqual(account["diffusion"], {"steps": 500, "schedule": "cosine", "objective": "v"})
        self.assertEqual(account["motion"]["reference_row"], "middle")

    def test_code_is_refused_not_run(self) -> None:
        marker = self.folder / "code-was-run"
        torch.save(published_checkpoint() | {"version": RunsCode(marker)}, self.checkpoint)
        self.expect_refusal(r"(posix|os|nt)\.system")
        self.assertFalse(marker.exists())

    def test_other_networks_are_refused(self) -> None:
        state = small_state(5)
        missing = {key: value for key, value in state.items() if key != "model.rs1.q.weight"}
        for content, reason in (
            (missing, "its model.rs1.q.weight is missing"),
            (state | {"model.extra": torch.ones(1)}, "model.extra is no part"),
            (state | {"model.final_conv.bias": torch.ones(3)}, r"of size \(3,\)"),
            (state | {"model.final_conv.bias": torch.full((2,), float("nan"))}, "not finite"),
            (state | {"betas": torch.full((1000,), 0.5)}, "neither linear nor cosine"),
            ({"model": state}, "no averaged weights"),
            ({"something": torch.ones(1)}, "no reference network"),
            ([1, 2], "holds no dict"),
        ):
            torch.save(content, self.checkpoint)
            self.expect_refusal(reason)

    def test_damaged_files_are_refused(self) -> None:
        torch.save(published_checkpoint(), self.checkpoint)
        whole = self.checkpoint.read_bytes()
        table = whole.index(b"data.pkl")
        for damaged in (b"", b"no checkpoint", whole[: len(whole) // 2]):
            self.checkpoint.write_bytes(damaged)
            self.expect_refusal("checkpoint")
        for at in range(table + 80, table + 4000, 97):
            self.checkpoint.write_bytes(whole[:at] + bytes([whole[at] ^ 0x15]) + whole[at + 1 :])
            self.expect_refusal("checkpoint")
        self.checkpoint.unlink()
        self.expect_refusal("no such checkpoint")
