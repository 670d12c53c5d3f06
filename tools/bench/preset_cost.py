#!/usr/bin/env python3
"""Measures what an item of pysherd.torch.FractureDataset costs by default, with the preset `training`, and with each thing that it draws.

usage: preset_cost.py MESH...    (with a Python that has pysherd and PyTorch, such as that of build/python/venv-torch)

Items have 1000 points, of four to eight pieces, at 64 voxels.  Prints milliseconds of the processor for an item: medians of the rounds, which take
turns, so that other work of the machine meets all alike.
"""
import statistics
import sys
import time

from pysherd.torch import FractureDataset

ROUNDS, ITEMS = 5, 40
OFF = {"roughness": 0, "mismatch": "0%", "scan_noise": "0%", "missing": 0}
TRAINING = {"preset": "training"}
KINDS = {
    "default": {},
    "training": TRAINING,
    "training, nothing drawn": {**TRAINING, **OFF},
    **{f"training, drawn {name} alone": {**TRAINING, **{k: v for k, v in OFF.items() if k != name}} for name in OFF},
}


def main():
    streams = {kind: iter(FractureDataset(sys.argv[1:], resolution=64, pieces=range(4, 9), points=1000, seed=1, **options)) for kind, options in KINDS.items()}
    took = {kind: [] for kind in KINDS}
    for stream in streams.values():
        for _ in range(8):
            next(stream)
    for _ in range(ROUNDS):
        for kind, stream in streams.items():
            before = time.process_time()
            for _ in range(ITEMS):
                next(stream)
            took[kind].append(1000 * (time.process_time() - before) / ITEMS)
    base = statistics.median(took["default"])
    for kind, times in took.items():
        print(f"{kind}: {statistics.median(times):.1f} ms, {statistics.median(times) / base:.2f} times the default")


if __name__ == "__main__":
    main()
