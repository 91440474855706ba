# SPDX-License-Identifier: Apache-2.0
"""The exported networks compute in OpenCV what the trained ones compute in PyTorch."""

import hashlib
import json
import tempfile
import unittest
from pathlib import Path

import torch
from torch import nn

import checkpoint
import export_onnx
from calibration import centred, draw_samples, spread_scale
from compact_net import CompactConfig, CompactNet
from learning_test import SMALL, batch_of
from rotation_curve import BANDS


def lively_net(config: CompactConfig) -> CompactNet:
    """Random weights and norm statistics, so that every layer and every fold counts."""
    torch.manual_seed(3)
    net = CompactNet(config)
    with torch.no_grad():
        for module in net.modules():
            if isinstance(module, nn.BatchNorm2d):
                module.weight.uniform_(0.5, 1.5)
                module.bias.normal_(0, 0.2)
                module.running_mean.normal_(0, 0.2)
                module.running_var.uniform_(0.5, 2.0)
        net.encoder.position.normal_()
        net.denoiser.position.normal_()
        net.denoiser.direct.weight.normal_(0, 0.1)
    return net.eval()


SHIPPED = Path(export_onnx.__file__).parents[1] / "models" / "compact"


class Shipped(unittest.TestCase):
    def test_the_shipped_networks_are_those_of_the_shipped_checkpoint(self):
        net, _ = checkpoint.load_averaged(SHIPPED / "checkpoint.pt")
        encoder = (SHIPPED / "encoder.onnx").read_bytes()
        inputs = [export_onnx.encoder_inputs()]
        self.assertLess(export_onnx.largest_difference(encoder, net.encoder, inputs),
                        export_onnx.TOLERANCE)
        for batch in export_onnx.BATCH_SIZES:
            data = (SHIPPED / f"denoiser_{batch}.onnx").read_bytes()
            inputs = [export_onnx.denoiser_inputs(net, batch)]
            self.assertLess(export_onnx.largest_difference(data, net.denoiser, inputs),
                            export_onnx.TOLERANCE)


class Calibration(unittest.TestCase):
    def test_samples_of_the_truths_own_distribution_need_no_scale(self):
        generator = torch.Generator().manual_seed(1)
        truth = torch.randn(600, 3, BANDS, generator=generator)
        samples = torch.randn(600, 16, 3, BANDS, generator=generator)
        scale, covered = spread_scale(samples, truth)
        # Straight lines between ordered samples lie a little outside the true quantiles.
        self.assertAlmostEqual(scale, 1.0, delta=0.05)
        for share in covered:
            self.assertAlmostEqual(share, 0.8, delta=0.02)
        scale, _ = spread_scale(0.25 * samples, truth)
        # Less than 4: the mean of the wide samples was itself a quarter of a deviation off.
        self.assertAlmostEqual(scale, 4.0 * (1 - 1 / 16) ** 0.5, delta=0.15)

    def test_still_frames_do_not_count(self):
        samples, truth = torch.randn(50, 16, 3, BANDS), torch.randn(50, 3, BANDS)
        truth[25:] = 0.0
        self.assertEqual(spread_scale(samples, truth)[0], spread_scale(samples[:25], truth[:25])[0])

    def test_drawn_curves_are_zero_in_the_middle(self):
        net = lively_net(SMALL)
        batch = batch_of("compact", 3)
        samples = draw_samples(net, batch, 4, 2, 12.0)
        self.assertEqual(samples.shape, (3, 4, 3, BANDS))
        torch.testing.assert_close(samples, draw_samples(net, batch, 4, 2, 12.0))
        self.assertGreater(float(samples.std(dim=1).max()), 0.0)
        cubic = 2 * torch.linspace(-1, 1, BANDS) ** 3 + 5.0  # odd about the middle, then raised
        torch.testing.assert_close(centred(cubic), cubic - 5.0, atol=1e-5, rtol=0)


class Export(unittest.TestCase):
    def test_opencv_agrees_with_pytorch(self):
        """`export` itself refuses a difference above TOLERANCE, for every file it writes."""
        files = export_onnx.export(lively_net(CompactConfig()))
        self.assertEqual(set(files), {"encoder.onnx", "denoiser_1.onnx", "denoiser_8.onnx"})
        self.assertLess(sum(map(len, files.values())), 20e6)

    def test_the_comparison_sees_another_network(self):
        net = lively_net(CompactConfig())
        inputs = export_onnx.denoiser_inputs(net, 1)
        data = export_onnx.onnx_bytes(export_onnx.ExportDenoiser(net, 1), inputs, "prediction")
        self.assertLess(export_onnx.largest_difference(data, net.denoiser, [inputs]),
                        export_onnx.TOLERANCE)
        with torch.no_grad():
            net.denoiser.blocks[0].query_key_value[1].running_mean.add_(0.2)
        self.assertGreater(export_onnx.largest_difference(data, net.denoiser, [inputs]),
                           10 * export_onnx.TOLERANCE)

    def test_networks_without_attention_are_exported_too(self):
        export_onnx.export(lively_net(CompactConfig(intra_patch=False, inter_patch=False)))

    def test_the_model_file_names_weights_and_checksums(self):
        net = lively_net(CompactConfig())
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            checkpoint.save(folder / "checkpoint.pt", {
                "net": "compact", "config": checkpoint.config_of(net), "step": 12,
                "ema": net.state_dict(),
            })
            loaded, state = checkpoint.load_averaged(folder / "checkpoint.pt")
            files = export_onnx.export(loaded)
            export_onnx.write_model(folder / "model", files, {"steps": 4}, {"step": state["step"]})
            model = json.loads((folder / "model" / "model.json").read_text())
            entries = [model["weights"]["encoder"], *model["weights"]["denoiser"]]
            self.assertEqual([e.get("batch") for e in entries], [None, 1, 8])
            for entry in entries:
                data = (folder / "model" / entry["file"]).read_bytes()
                self.assertEqual(hashlib.sha256(data).hexdigest(), entry["sha256"])
            self.assertEqual((model["training"]["step"], model["sampling"]["steps"]), (12, 4))

    def test_regression_takes_any_noise_for_none(self):
        net = lively_net(CompactConfig())
        inputs = export_onnx.denoiser_inputs(net, 1)
        blind = export_onnx.blind_to_noise(net)
        with torch.no_grad():
            expected = net.denoiser(torch.zeros_like(inputs["x"]), inputs["time"],
                                    inputs["features"])
            self.assertGreater(float((net.denoiser(*inputs.values()) - expected).abs().max()), 0.1)
            torch.testing.assert_close(blind.denoiser(*inputs.values()), expected)
