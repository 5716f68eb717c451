"""A normal distribution that is fitted while numbers pass by."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn


class Gaussian(nn.Module):
    """Mean and variance, kept with the weights of the network."""

    count: Tensor
    mean: Tensor
    squares: Tensor

    def __init__(self) -> None:
        super().__init__()
        for name in ("count", "mean", "squares"):
            self.register_buffer(name, torch.zeros((), dtype=torch.float64))

    def reset(self) -> None:
        """Forget everything."""
        for buffer in (self.count, self.mean, self.squares):
            buffer.zero_()

    def add(self, values: Tensor) -> None:
        """Take in (n,) values (Chan's parallel update)."""
        n = values.numel()
        if n == 0:
            return
        new = values.detach().to(self.mean)
        step, total = new.mean() - self.mean, self.count + n
        self.squares += (new - new.mean()).square().sum() + step.square() * self.count * n / total
        self.mean += step * n / total
        self.count += n

    @property
    def std(self) -> Tensor:
        """Standard deviation; at least 1e-6."""
        return (self.squares / self.count.clamp(min=1)).sqrt().clamp(min=1e-6)

    def cdf(self, values: Tensor) -> Tensor:
        """Return the share of the distribution below (n,) values; 0 before anything is fitted."""
        if not self.count:
            return torch.zeros_like(values)
        z = (values - self.mean.to(values)) / self.std.to(values)
        return 0.5 * (1 + torch.erf(z / math.sqrt(2)))

    def log_density(self, values: Tensor) -> Tensor:
        """Return the logarithm of the density at (n,) values."""
        z = (values - self.mean.to(values)) / self.std.to(values)
        return -0.5 * z.square() - self.std.to(values).log() - 0.5 * math.log(2 * math.pi)
