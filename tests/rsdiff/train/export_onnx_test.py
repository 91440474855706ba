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
from compact_net import CompactConfig, CompactNet


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
            export_onnx.write_model(folder / "model", files, 4, {"step": state["step"]})
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
