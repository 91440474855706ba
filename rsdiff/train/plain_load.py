# SPDX-License-Identifier: Apache-2.0
"""Reads PyTorch's zip files as data: tensors, numbers, texts and containers, never pickled code.

Written out because torch 1.13's own safe loading stumbles over plain floats, and its unsafe one
ignores the pickle module that it is given.
"""

from __future__ import annotations

import collections
import pickle
import zipfile
from pathlib import Path
from typing import Any

import torch

_DTYPES = {
    "FloatStorage": torch.float32,
    "DoubleStorage": torch.float64,
    "HalfStorage": torch.float16,
    "BFloat16Storage": torch.bfloat16,
    "LongStorage": torch.int64,
    "IntStorage": torch.int32,
    "ShortStorage": torch.int16,
    "CharStorage": torch.int8,
    "ByteStorage": torch.uint8,
    "BoolStorage": torch.bool,
}


def _tensor(flat: torch.Tensor, offset: int, size: tuple, stride: tuple, *_: Any) -> torch.Tensor:
    return flat.as_strided(size, stride, offset).clone()


def _parameter(tensor: torch.Tensor, *_: Any) -> torch.Tensor:
    return tensor


_CALLABLES = {
    ("collections", "OrderedDict"): collections.OrderedDict,
    ("torch", "Size"): torch.Size,
    ("torch._utils", "_rebuild_tensor_v2"): _tensor,
    ("torch._utils", "_rebuild_parameter"): _parameter,
}


class _Unpickler(pickle.Unpickler):
    def __init__(self, archive: zipfile.ZipFile, table: str):
        super().__init__(archive.open(table), encoding="utf-8")
        self.archive = archive
        self.folder = table.removesuffix("data.pkl") + "data/"
        self.storages: dict[str, torch.Tensor] = {}

    def find_class(self, module: str, name: str) -> Any:
        if module == "torch" and name in _DTYPES:
            return _DTYPES[name]
        if (module, name) in _CALLABLES:
            return _CALLABLES[(module, name)]
        raise pickle.UnpicklingError(f"{module}.{name} is no plain data")

    def persistent_load(self, saved: tuple) -> torch.Tensor:
        """A storage: its bytes as a flat tensor, read once."""
        _, dtype, key, _, count = saved
        if key not in self.storages:
            data = bytearray(self.archive.read(self.folder + key))
            if len(data) != count * torch.empty(0, dtype=dtype).element_size():
                raise pickle.UnpicklingError(f"storage {key} is not {count} numbers long")
            flat = torch.frombuffer(data, dtype=dtype) if data else torch.empty(0, dtype=dtype)
            self.storages[key] = flat
        return self.storages[key]


def load_plain(path: Path) -> Any:
    """The content of a checkpoint, tensors on the CPU."""
    try:
        with zipfile.ZipFile(path) as archive:
            tables = [n for n in archive.namelist() if n.endswith("/data.pkl")]
            if len(tables) != 1:
                raise pickle.UnpicklingError("not written by torch.save")
            return _Unpickler(archive, tables[0]).load()
    except FileNotFoundError:
        raise SystemExit(f"{path}: no such checkpoint") from None
    except Exception as error:  # damaged pickles raise nearly anything
        raise SystemExit(f"{path}: no checkpoint of plain data: {error}") from None
