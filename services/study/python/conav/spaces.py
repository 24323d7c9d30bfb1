"""The part of gymnasium.spaces that the environments need, for machines without gymnasium."""
from __future__ import annotations

from typing import Any, Mapping, Optional, Tuple

import numpy as np


class _Space:
    def __init__(self) -> None:
        self._random = np.random.default_rng()

    def seed(self, seed: Optional[int] = None) -> None:
        self._random = np.random.default_rng(seed)


class Discrete(_Space):
    """The integers 0 to n - 1."""

    def __init__(self, n: int) -> None:
        super().__init__()
        self.n = n
        self.shape: Tuple[int, ...] = ()
        self.dtype = np.dtype(np.int64)

    def sample(self, mask: Optional[np.ndarray] = None) -> int:
        """Of those that `mask` has 1 for."""
        return int(self._random.choice(np.arange(self.n) if mask is None else np.flatnonzero(mask)))

    def contains(self, value: Any) -> bool:
        return isinstance(value, (int, np.integer)) and 0 <= int(value) < self.n


class Box(_Space):
    """Arrays with values between low and high, both included."""

    def __init__(self, low: Any, high: Any, shape: Tuple[int, ...], dtype: Any) -> None:
        super().__init__()
        self.shape = shape
        self.dtype = np.dtype(dtype)
        self.low = np.broadcast_to(np.asarray(low, self.dtype), shape)
        self.high = np.broadcast_to(np.asarray(high, self.dtype), shape)

    def sample(self) -> np.ndarray:
        if self.dtype.kind == "f":
            return self._random.uniform(self.low, self.high).astype(self.dtype)
        return self._random.integers(self.low, self.high, endpoint=True).astype(self.dtype)

    def contains(self, value: Any) -> bool:
        return (isinstance(value, np.ndarray) and value.shape == self.shape and value.dtype == self.dtype
                and bool(np.all(value >= self.low) and np.all(value <= self.high)))


class Dict(_Space):
    """A dict with a space for each key."""

    def __init__(self, spaces: Mapping[str, Any]) -> None:
        super().__init__()
        self.spaces = dict(spaces)

    def __getitem__(self, key: str) -> Any:
        return self.spaces[key]

    def sample(self) -> Any:
        return {key: space.sample() for key, space in self.spaces.items()}

    def contains(self, value: Any) -> bool:
        return (isinstance(value, dict) and value.keys() == self.spaces.keys()
                and all(space.contains(value[key]) for key, space in self.spaces.items()))
