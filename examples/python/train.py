"""Trains a small PointNet to find the points of fragments that lie on a fracture surface, on fractures made meanwhile.

usage: train.py MESHES HELD_OUT [STEPS [SEED]]    (two folders of meshes; PyTorch is needed)

Prints the mean loss of the first and the last tenth of the steps, default 300, and F1 on fractures of the held-out meshes, beside the F1 of
calling every point one of a fracture surface, which is the best that a guess without looking reaches.
"""

import json
import sys
from itertools import islice
from typing import Any

import torch
from pysherd.torch import FractureDataset, collate_fragments
from torch import nn
from torch.utils.data import DataLoader


class PointNet(nn.Module):
    """Pools features of pairs, of each point with its neighbors, and then of all points of a fragment."""

    def __init__(self) -> None:
        super().__init__()
        self.pair = nn.Sequential(nn.Linear(4, 32), nn.ReLU(), nn.Linear(32, 64), nn.ReLU())
        self.head = nn.Sequential(nn.Linear(64 + 64, 64), nn.ReLU(), nn.Linear(64, 1))

    def forward(self, pairs: torch.Tensor) -> torch.Tensor:  # (fragments, points, neighbors, 4)
        point = self.pair(pairs).amax(dim=2)
        whole = point.amax(dim=1, keepdim=True).expand_as(point)
        logits: torch.Tensor = self.head(torch.cat([point, whole], dim=-1)).squeeze(-1)
        return logits


def fractures(meshes: str, seed: int, items: int | None = None) -> Any:
    return FractureDataset(meshes, layout="fragments", points=128, resolution=48, pieces="2..6", roughness="1%..2%", seed=seed, items=items, repeats=2)


def inputs(batch: dict[str, Any], neighbors: int = 8) -> tuple[torch.Tensor, torch.Tensor]:
    """Returns features of pairs of points, which no pose of the fragment changes, and which points are of a fracture surface."""
    at, normal = batch["positions"], batch["normals"]
    near = torch.cdist(at, at).topk(neighbors + 1, largest=False).indices[..., 1:]
    fragment = torch.arange(len(at))[:, None, None]
    way, other = at[fragment, near] - at[:, :, None], normal[fragment, near]
    angles = [(a * b).sum(dim=-1) for a, b in ((way, normal[:, :, None]), (way, other), (normal[:, :, None], other))]
    return torch.stack([way.norm(dim=-1), *angles], dim=-1), (batch["neighbor"] != 0).float()


def train(meshes: str, steps: int, seed: int) -> tuple[PointNet, list[float]]:
    torch.manual_seed(seed)
    net, losses = PointNet(), []
    optimizer = torch.optim.Adam(net.parameters(), lr=5e-3)
    for batch in islice(DataLoader(fractures(meshes, seed), batch_size=8, num_workers=1, collate_fn=collate_fragments), steps):
        x, is_break = inputs(batch)
        loss = nn.functional.binary_cross_entropy_with_logits(net(x), is_break)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    return net, losses


@torch.no_grad()
def scores(net: PointNet, meshes: str) -> tuple[float, float]:
    found = guessed = breaks = points = 0
    for batch in DataLoader(fractures(meshes, 1, items=96), batch_size=8, collate_fn=collate_fragments):
        x, is_break = inputs(batch)
        called = net(x) > 0
        found, guessed = found + int((called * is_break).sum()), guessed + int(called.sum())
        breaks, points = breaks + int(is_break.sum()), points + is_break.numel()
    return 2 * found / (guessed + breaks), 2 * breaks / (points + breaks)


if __name__ == "__main__":
    steps, seed = int((sys.argv[3:] or ["300"])[0]), int((sys.argv[4:] or ["0"])[0])
    net, losses = train(sys.argv[1], steps, seed)
    tenth = max(steps // 10, 1)
    f1, chance = scores(net, sys.argv[2])
    print(json.dumps({"loss": [sum(part) / tenth for part in (losses[:tenth], losses[-tenth:])], "f1": f1, "chance": chance}))
