#!/usr/bin/env python3
"""Runs the examples for PyTorch Geometric and for Lightning's data modules with the packages themselves, on shapes made here.

usage: network_modules.py    (with a Python that has pysherd, PyTorch, lightning 2 and torch_geometric)

Fails if the graph network does not learn, or a trainer of Lightning does not get the batches of two epochs, of other fractures each, and of the validation.
What GARF and Rectified Point Flow read of a batch is compared in tests/python/with_torch; their networks need a GPU and are not run here.
"""
import pathlib
import subprocess
import sys
import tempfile

import lightning as L
import torch

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"
sys.path.insert(0, str(EXAMPLES))

import lightning_modules  # noqa: E402


def write_box(path, height):
    corners = [(x, y, z * height) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    path.write_text("".join("v %g %g %g\n" % c for c in corners) + "".join("f %d %d %d %d\n" % f for f in faces))


class Counting(L.LightningModule):
    """Learns nothing, and keeps the names of what it was given."""

    def __init__(self):
        super().__init__()
        self.weight = torch.nn.Parameter(torch.ones(3))
        self.trained, self.validated = [], []

    def training_step(self, batch, _):
        self.trained.append([(name, float(points.sum())) for name, points in zip(batch["name"], batch["pointclouds_gt"])])
        return (batch["pointclouds"] * self.weight).mean()

    def validation_step(self, batch, _):
        self.validated.append(float(batch["pointclouds_gt"].sum()))

    def configure_optimizers(self):
        return torch.optim.SGD(self.parameters(), lr=0.1)


def train(meshes, kind):
    module = kind(data_root=str(meshes), batch_size=2, num_workers=2, num_points_to_sample=2000, items=8, val_items=4, options={"resolution": 24, "pieces": "2..4"})
    network = Counting()
    trainer = L.Trainer(max_epochs=2, accelerator="cpu", logger=False, enable_checkpointing=False, enable_progress_bar=False, num_sanity_val_steps=0)
    trainer.fit(network, datamodule=module)
    assert len(network.trained) == 8 and len({item for batch in network.trained for item in batch}) == 16, network.trained
    assert len(network.validated) == 4 and network.validated[:2] == network.validated[2:], network.validated


def main():
    with tempfile.TemporaryDirectory() as folder:
        meshes = pathlib.Path(folder)
        for side in range(1, 11):
            write_box(meshes / f"box{side}.obj", 0.4 + 0.2 * side)
        for kind in (lightning_modules.Garf, lightning_modules.RectifiedPointFlow):
            train(meshes, kind)
        run = subprocess.run([sys.executable, "-B", EXAMPLES / "graphs.py", meshes, "60"], capture_output=True, text=True, check=True)
        _, first, _, last, *_ = run.stdout.split()
        assert float(last) < float(first) / 2, run.stdout
        print(run.stdout, end="")


if __name__ == "__main__":
    main()
