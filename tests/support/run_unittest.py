# SPDX-License-Identifier: Apache-2.0
"""Runs the unittest file that is named; exits 77, a skip, where a package it needs is missing."""

import importlib.util
import sys
import unittest

NEEDED = ("numpy", "cv2", "torch", "matplotlib")


def main() -> int:
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        print(f"skipped: this Python has no {', '.join(missing)}")
        return 77
    spec = importlib.util.spec_from_file_location("tested", sys.argv[1])
    module = importlib.util.module_from_spec(spec)
    sys.modules["tested"] = module
    spec.loader.exec_module(module)
    suite = unittest.defaultTestLoader.loadTestsFromModule(module)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    return 0 if result.wasSuccessful() and result.testsRun else 1


if __name__ == "__main__":
    sys.exit(main())
