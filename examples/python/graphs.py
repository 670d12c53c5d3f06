"""Trains a graph network on fractures made meanwhile, as graphs of PyTorch Geometric: a node a fragment, an edge a contact.

usage: graphs.py MESHES [STEPS]    (PyTorch and PyTorch Geometric are needed)

A node has the mean and the spread of its points' distances from their middle; the network predicts the share of them that lie on cracks.
"""

import sys
from itertools import islice
from typing import Any

import torch
from pysherd.torch import FractureDataset
from torch_geometric.data import Data
from torch_geometric.loader import DataLoader
from torch_geometric.nn import GCNConv


def graph_of(item: dict[str, Any]) -> Data:
    """Makes a graph of an item of the layout "fragments"."""
    at, neighbor = torch.from_numpy(item["positions"]), torch.from_numpy(item["neighbor"])
    away = (at - at.mean(dim=1, keepdim=True)).norm(dim=2)
    x = torch.stack([away.mean(dim=1), away.std(dim=1)], dim=1)
    touches = [(i, j - 1) for i, row in enumerate(neighbor) for j in row.unique().tolist() if 0 < j <= len(at)]  # others are missing
    edges = torch.tensor(touches, dtype=torch.long).reshape(-1, 2).T
    return Data(x=x, pos=at.mean(dim=1), edge_index=edges, y=(neighbor > 0).float().mean(dim=1))


class Net(torch.nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.first, self.second = GCNConv(2, 32), GCNConv(32, 1)

    def forward(self, graph: Any) -> torch.Tensor:
        hidden = self.first(graph.x, graph.edge_index).relu()
        return self.second(hidden, graph.edge_index).squeeze(-1)  # type: ignore[no-any-return]


if __name__ == "__main__":
    torch.manual_seed(0)
    data = FractureDataset(sys.argv[1], layout="fragments", points=128, resolution=48, pieces="4..8", preset="training", transform=graph_of)
    net, losses = Net(), []
    optimizer = torch.optim.Adam(net.parameters(), lr=1e-2)
    for graph in islice(DataLoader(data, batch_size=8), int((sys.argv[2:] or ["100"])[0])):
        loss = torch.nn.functional.mse_loss(net(graph), graph.y)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    print(f"loss {losses[0]:.4f} to {losses[-1]:.4f} in {len(losses)} steps")
