# SPDX-License-Identifier: Apache-2.0
"""Runs the unittest file that is named.

Exits 77, a skip, where a package it needs is missing or every test was skipped.
"""

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
    if not result.wasSuccessful() or not (result.testsRun or result.skipped):
        return 1
    return 77 if len(result.skipped) >= result.testsRun else 0


if __name__ == "__main__":
    sys.exit(main())
