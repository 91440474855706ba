# SPDX-License-Identifier: Apache-2.0
"""How far a prediction is from the truth, for training."""

from __future__ import annotations

from dataclasses import dataclass

import torch

WEIGHTS = ("snr", "clipped", "none")
CLIPPED_SNR = (1.0, 5.0)
# Of yaw, pitch and roll in a curve's error: pitch hardly shows in a picture, and what cannot be
# learned is noise in the gradient of what can.
AXIS_WEIGHTS = (1.0, 0.4, 0.7)


@dataclass(frozen=True)
class LossOptions:
    weight: str = "clipped"
    photometric: bool = False
    drop_condition: float = 0.1  # share of samples that do not see their picture
    large: float = 0.0  # motions of more network units (RMS) count less, 0 = all alike
    still: float = 1.0  # how much more a still picture counts, where large is not 0
    draws: int = 4  # noisy states per picture: the encoder is dear, the denoiser cheap
    regression: bool = False
    slope_share: float = 0.0  # of the error's slope along a curve; 0 = dense fields, plain errors


def time_weight(alphas_cumprod: torch.Tensor, kind: str) -> torch.Tensor:
    """Weight of the squared x0 error at each time.

    "snr" is the published one (that of plain noise prediction); "clipped" keeps late times, from
    which sampling starts, from counting for nothing and early ones from drowning the others.
    """
    snr = alphas_cumprod / (1 - alphas_cumprod)
    if kind == "snr":
        return snr
    if kind == "clipped":
        return snr.clamp(*CLIPPED_SNR)
    return torch.ones_like(snr)


def size_weight(truth: torch.Tensor, large: float, still: float = 1.0) -> torch.Tensor:
    """Weight of each sample by the size of its motion: else a few huge ones rule the loss.

    `still` multiplies that of pictures without motion: to leave those alone comes first.
    """
    if large == 0.0:
        return torch.ones_like(truth.flatten(1)[:, 0])
    size = truth.square().flatten(1).mean(dim=1)
    return torch.where(size == 0, still, 1.0) * 2 / (1 + size / large**2)


def state_loss(out: torch.Tensor, truth: torch.Tensor, weight: torch.Tensor) -> torch.Tensor:
    """Mean over the samples of weight times mean squared error."""
    return ((out - truth) ** 2).flatten(1).mean(dim=1).mul(weight).mean()


def curve_loss(
    out: torch.Tensor, truth: torch.Tensor, weight: torch.Tensor, slope_share: float
) -> torch.Tensor:
    """As state_loss for curves N x 3 x bands x 1, of their values and of their slopes.

    Slopes (per readout, times slope_share) are what leaning lines show, band by band; the value at
    a band sums the errors of many. Both are least at the mean of what the picture leaves possible.
    """
    error = out - truth
    slope = torch.diff(error, dim=2) * (error.shape[2] * slope_share)
    axes = error.new_tensor(AXIS_WEIGHTS)[:, None, None]
    parts = [(axes * part.square()).flatten(1).mean(dim=1) for part in (error, slope)]
    return (parts[0] + parts[1]).mul(weight).mean()


def balanced(first: torch.Tensor, second: torch.Tensor) -> torch.Tensor:
    """The sum, the second term rescaled to equal the first; gradients see a constant factor."""
    return first + second * (first.detach() / second.detach().clamp(min=1e-6))
