# SPDX-License-Identifier: Apache-2.0
"""Whole runs of a few steps: going on after a stop, several processes, logs, what is refused."""

import csv
import io
import json
import os
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import torch

import checkpoint
import plot_log
import train
from devices import Place
from learning_test import SMALL, batch_of, small_reference
from run_log import CsvLog, Progress

CONFIG = json.dumps({k: v for k, v in SMALL.__dict__.items() if isinstance(v, int)
                     and not isinstance(v, bool)})


def make_pool(folder: Path, kind: str = "compact") -> None:
    shard = folder / "shard-0000"
    shard.mkdir(parents=True)
    for name, tensor in batch_of(kind, 24).items():
        np.save(shard / f"{name}.npy", tensor.numpy())
    (shard / "reference_row").write_text("first" if kind == "reference" else "middle")


class Run(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        make_pool(self.folder / "pool")

    def options(self, run: str, *more: str):
        pool = str(self.folder / "pool")
        options = train.parse_options([
            str(self.folder / run), "--pool", pool, "--dev", pool, "--dev-samples", "6",
            "--batch", "4", "--config", CONFIG, *more,
        ])
        options.run.mkdir(exist_ok=True)
        return options

    def train(self, run: str, *more: str) -> dict:
        trainer = train.Trainer(self.options(run, *more), Place(torch.device("cpu")))
        trainer.train(Progress(io.StringIO()))
        return checkpoint.load(self.folder / run / "checkpoint.pt")

    def rows(self, run: str) -> list[dict[str, str]]:
        with (self.folder / run / "log.csv").open(newline="") as file:
            return list(csv.DictReader(file))

    def test_going_on_gives_the_weights_of_an_unbroken_run(self):
        schedule = ["--lr-schedule", "constant", "--report", "3"]
        whole = self.train("whole", *schedule, "--steps", "6")
        self.train("parts", *schedule, "--steps", "3")
        parts = self.train("parts", *schedule, "--steps", "6")
        self.assertEqual(parts["step"], 6)
        for which in ("model", "ema"):
            for key, value in whole[which].items():
                self.assertTrue(torch.equal(value, parts[which][key]), key)
        self.assertEqual([r["step"] for r in self.rows("parts")], ["3", "6"])
        for name in ("u", "v", "psnr"):
            self.assertEqual(self.rows("parts")[1][name], self.rows("whole")[1][name])
        other = self.train("other", *schedule, "--steps", "6", "--seed", "2")
        self.assertFalse(torch.equal(other["model"]["denoiser.slopes.weight"],
                                     whole["model"]["denoiser.slopes.weight"]))

    def test_other_networks_are_refused(self):
        self.train("run", "--steps", "1")
        with self.assertRaisesRegex(SystemExit, "another network"):
            self.train("run", "--steps", "2", "--patch-attention", "none")
        with self.assertRaisesRegex(SystemExit, "--dev"):
            train.parse_options(["run", "--pool", "p"])
        with self.assertRaisesRegex(SystemExit, "CUDA"):
            self.train("half", "--precision", "fp16")

    def test_objectives_and_short_numbers(self):
        self.train("image", "--objective", "image", "--steps", "1")
        self.assertIn("psnr", self.rows("image")[0])
        state = self.train("regression", "--objective", "regression", "--steps", "1", "--precision",
                           "bf16", "--photometric", "--prefer-structure", "0.8")
        self.assertTrue(all(torch.isfinite(v).all() for v in state["model"].values()))
        net, _ = checkpoint.load_averaged(self.folder / "regression" / "checkpoint.pt")
        self.assertFalse(net.training)

    def test_the_published_network_trains_on_its_own_samples(self):
        make_pool(self.folder / "fields", "reference")
        fields = str(self.folder / "fields")
        with mock.patch.object(checkpoint, "make_net", lambda name, config: small_reference()):
            state = self.train("reference", "--net", "reference", "--pool", fields, "--dev", fields,
                               "--steps", "2", "--draws", "1")
        self.assertEqual((state["net"], state["reference_row"]), ("reference", "first"))
        (row,) = self.rows("reference")
        self.assertTrue({"motion", "photometric", "epe", "psnr"} <= set(row))

    def test_curves_are_drawn(self):
        self.train("run", "--steps", "2", "--report", "1")
        picture = self.folder / "curve.png"
        plot_log.draw([self.folder / "run"], ["u", "epe"], picture)
        self.assertGreater(picture.stat().st_size, 1000)

    def test_two_processes_keep_the_same_weights(self):
        """Each with its own samples, as torchrun starts them; see also `if __name__` below."""
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = str(free.getsockname()[1])
        workers = [subprocess.Popen(
            [sys.executable, "-B", __file__, str(self.folder)],
            env={**os.environ, "RANK": str(rank), "LOCAL_RANK": str(rank), "WORLD_SIZE": "2",
                 "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": port, "CUDA_VISIBLE_DEVICES": ""},
        ) for rank in range(2)]
        self.assertEqual([w.wait(timeout=300) for w in workers], [0, 0])
        first, second = (torch.load(self.folder / f"rank-{r}.pt") for r in range(2))
        for key in first["weights"]:
            self.assertTrue(torch.equal(first["weights"][key], second["weights"][key]), key)
        self.assertFalse(torch.equal(first["planes"], second["planes"]))
        self.assertEqual(first["planes"].shape[0], 2, "the batch is shared out")
        self.assertEqual([r["step"] for r in self.rows("both")], ["3"])


class Telling(unittest.TestCase):
    def test_a_log_goes_on_from_the_step(self):
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "log.csv"
            log = CsvLog(path, 0)
            for step in (10, 20, 30):
                log.add({"step": step, "loss": 1 / step})
            CsvLog(path, 20).add({"step": 25, "loss": 0.5})
            self.assertEqual(path.read_text().split(), ["step,loss", "10,0.1", "20,0.05", "25,0.5"])
            with self.assertRaisesRegex(SystemExit, "other columns"):
                CsvLog(path, 25).add({"step": 30, "other": 1})

    def test_progress_is_one_line_on_a_terminal_and_silent_elsewhere(self):
        class Terminal(io.StringIO):
            def isatty(self):
                return True

        for stream, expected in ((io.StringIO(), "done\n"), (Terminal(), "\rstep 1\rdone  \n")):
            progress = Progress(stream)
            progress.update("step 1")
            progress.report("done")
            self.assertEqual(stream.getvalue(), expected)


def one_process(folder: Path) -> None:
    """A worker of the test with two processes: three steps, then its weights and first samples."""
    run = Run()
    run.folder = folder
    with train.place() as here:
        trainer = train.Trainer(run.options("both", "--steps", "3"), here)
        trainer.train(Progress(io.StringIO()))
        weights = dict(trainer.net.named_parameters())
        first = train.training_batches(trainer.options, here)[0]
        torch.save({"weights": weights, "planes": first["planes"]}, folder / f"rank-{here.rank}.pt")


if __name__ == "__main__":
    torch.set_num_threads(1)
    one_process(Path(sys.argv[1]))
