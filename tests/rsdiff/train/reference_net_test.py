# SPDX-License-Identifier: Apache-2.0
"""The reference network by itself: its checkpoint's keys, and what its parts may see."""

import unittest

import torch

from diffusion import NoiseSchedule
from reference_net import PatchAttention, ReferenceDiffusion, ReferenceUNet

PUBLISHED_PARAMETERS = 79_882_731
SMALL = {"width": 16, "multipliers": (1, 2), "field_size": 16}
# Float32 sums of a few hundred terms near one.
ROUNDING = 2e-5

Shapes = dict[str, tuple[int, ...]]


def layer(name: str, *shape: int) -> Shapes:
    return {f"{name}.weight": shape, f"{name}.bias": (shape[0],)}


def block(name: str, inside: int, outside: int) -> Shapes:
    return layer(f"{name}.proj", outside, inside, 3, 3) | layer(f"{name}.norm", outside)


def residual_block(name: str, inside: int, outside: int) -> Shapes:
    shapes = layer(f"{name}.mlp.1", 2 * outside, 512)
    shapes |= block(f"{name}.block1", inside, outside) | block(f"{name}.block2", outside, outside)
    shapes |= block(f"{name}.block3", 2 * inside, inside)
    if inside != outside:
        shapes |= layer(f"{name}.res_conv", outside, inside, 1, 1)
    return shapes


def attention(name: str, width: int, linear: bool) -> Shapes:
    out = f"{name}.fn.fn.to_out"
    shapes = {f"{name}.fn.fn.to_qkv.weight": (384, width, 1, 1), f"{name}.fn.norm.g": (1, width, 1, 1)}
    shapes |= layer(f"{out}.0" if linear else out, width, 128, 1, 1)
    if linear:
        shapes[f"{out}.1.g"] = (1, width, 1, 1)
    return shapes


def published_shapes() -> Shapes:
    """Every parameter of the published network, from its description."""
    shapes: Shapes = {"null_classes_emb": (64,), "classes_emb.weight": (1, 64)}
    shapes |= layer("init_conv", 3, 2, 7, 7) | layer("init_conv_1", 64, 3, 7, 7)
    shapes |= layer("time_mlp.1", 256, 64) | layer("time_mlp.3", 256, 256)
    shapes |= layer("classes_mlp.0", 256, 64) | layer("classes_mlp.2", 256, 256)
    for name in ("rs1", "rs2"):
        shapes[f"{name}.pe"] = (1, 1, 256)
        shapes |= {f"{name}.{part}.weight": (64, 64) for part in ("q", "k", "v", "proj")}
    levels = [(64, 64), (64, 128), (128, 256), (256, 512)]
    for i, (narrow, wide) in enumerate(levels):
        kernel = 3 if i == 3 else 4
        shapes |= residual_block(f"downs.{i}.0", narrow, narrow)
        shapes |= residual_block(f"downs.{i}.1", narrow, narrow)
        shapes |= attention(f"downs.{i}.2", narrow, linear=True)
        shapes |= layer(f"downs.{i}.3", wide, narrow, kernel, kernel)
    for i, (narrow, wide) in enumerate(reversed(levels)):
        shapes |= residual_block(f"ups.{i}.0", wide + narrow, wide)
        shapes |= residual_block(f"ups.{i}.1", wide + narrow, wide)
        shapes |= attention(f"ups.{i}.2", wide, linear=True)
        shapes |= layer(f"ups.{i}.3" if i == 3 else f"ups.{i}.3.1", narrow, wide, 3, 3)
    shapes |= residual_block("mid_block1", 512, 512) | residual_block("mid_block2", 512, 512)
    shapes |= attention("mid_attn", 512, linear=False)
    shapes |= residual_block("final_res_block", 128, 64) | layer("final_conv", 2, 64, 1, 1)
    return {f"model.{key}": shape for key, shape in shapes.items()}


def small_network() -> ReferenceUNet:
    torch.manual_seed(1)
    return ReferenceUNet(**SMALL).eval()


class PublishedShapes(unittest.TestCase):
    def test_parameters_and_tables_are_those_of_a_published_checkpoint(self) -> None:
        network = ReferenceDiffusion(NoiseSchedule.linear(1000))
        found = {key: tuple(value.shape) for key, value in network.named_parameters()}
        self.assertEqual(found, published_shapes())
        self.assertEqual(sum(p.numel() for p in network.parameters()), PUBLISHED_PARAMETERS)
        tables = {key: tuple(value.shape) for key, value in network.named_buffers()}
        self.assertEqual(len(tables), 13)
        self.assertEqual(set(tables.values()), {(1000,)})


class Forward(unittest.TestCase):
    def setUp(self) -> None:
        torch.manual_seed(2)
        self.network = small_network()
        self.x = torch.randn(3, 2, 16, 16)
        self.image = torch.rand(1, 3, 16, 16) * 2 - 1
        self.time = torch.tensor([0, 500, 999])
        self.keep = torch.zeros(3, dtype=torch.bool)

    @torch.no_grad()
    def run_network(self, network: ReferenceUNet) -> torch.Tensor:
        return network.denoise(self.x, self.time, network.encode(self.image), self.keep)

    def test_is_repeatable_and_of_the_states_shape(self) -> None:
        out = self.run_network(self.network)
        self.assertEqual(out.shape, self.x.shape)
        self.assertTrue(torch.equal(out, self.run_network(small_network())))

    @torch.no_grad()
    def test_samples_that_share_an_image_do_not_meet(self) -> None:
        together = self.run_network(self.network)
        for i in range(3):
            alone = self.network(self.x[i : i + 1], self.time[i : i + 1], self.image, self.keep[:1])
            self.assertLess((together[i] - alone[0]).abs().max().item(), ROUNDING)

    def test_torchscript_computes_the_same(self) -> None:
        scripted = torch.jit.script(self.network)
        difference = self.run_network(scripted) - self.run_network(self.network)
        self.assertLess(difference.abs().max().item(), ROUNDING)

    @torch.no_grad()
    def test_time_class_and_image_matter(self) -> None:
        base = self.run_network(self.network)
        features = self.network.encode(self.image)
        late = self.network.denoise(self.x, self.time + 100, features, self.keep)
        dropped = self.network.denoise(self.x, self.time, features, ~self.keep)
        mirrored = self.network(self.x, self.time, self.image.flip(-1), self.keep)
        for other in (late, dropped, mirrored):
            self.assertGreater((other - base).abs().max().item(), 100 * ROUNDING)


class Patches(unittest.TestCase):
    @torch.no_grad()
    def test_attention_stays_inside_four_full_rows(self) -> None:
        torch.manual_seed(3)
        attention = PatchAttention(16, 16)
        x = torch.randn(1, 16, 16, 16)
        changed = x.clone()
        changed[:, :, 5, 7] += 10.0
        moved = (attention(changed) - attention(x)).abs().amax(dim=(0, 1, 3)) > ROUNDING
        self.assertEqual(moved.nonzero().flatten().tolist(), [4, 5, 6, 7])

    @torch.no_grad()
    def test_second_patches_are_shifted_by_half_and_leave_the_ends(self) -> None:
        network = small_network()
        x = torch.randn(1, 16, 16, 16)
        changed = x.clone()
        changed[:, :, 5, 7] += 10.0
        before, after = network.across_patches(x), network.across_patches(changed)
        moved = (after - before).abs().amax(dim=(0, 1, 3)) > ROUNDING
        self.assertEqual(moved.nonzero().flatten().tolist(), list(range(2, 10)))
        ends = network.rs1(x)
        self.assertTrue(torch.equal(before[:, :, :2], ends[:, :, :2]))
        self.assertTrue(torch.equal(before[:, :, -2:], ends[:, :, -2:]))
