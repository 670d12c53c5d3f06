"""How the Python tests skip what cannot be run here, and say so.

A program of tests whose every test passed ends with status 0.  One that skipped a test ends with 77, which ctest reports as
skipped, and names what was skipped.  With SHERD_REQUIRE_<NAME>=1 what needs <NAME> runs all the same and fails: continuous
integration sets it for all that it has installed.
"""
import os
import sys
import unittest


def required(name):
    return os.environ.get(f"SHERD_REQUIRE_{name}") == "1"


def skip(test, name, reason):
    """End a test that needs <name>: as skipped, or as failed where it is required."""
    if required(name):
        test.fail(f"{reason}, and SHERD_REQUIRE_{name} is set")
    test.skipTest(reason)


def skip_unless(available, name, reason):
    """A decorator of tests and classes that need <name>."""
    return unittest.skipUnless(available or required(name), reason)


def main():
    result = unittest.main(exit=False).result
    for test, reason in result.skipped:
        print(f"skipped: {test.id()}: {reason}", file=sys.stderr)
    if not result.wasSuccessful() or result.testsRun == 0:
        sys.exit(1)
    sys.exit(77 if result.skipped else 0)
