"""The examples for PyTorch Geometric and for Lightning's data modules.

Where these packages are not installed, which is so in this environment, stubs of the few names that the examples use take their place:
tests/long/network_modules.py runs the packages themselves.
"""
import importlib.util
import os
import pathlib
import subprocess
import sys

import documents
import numpy as np
import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "examples" / "python"
STUBS = {
    "lightning/__init__.py": "class LightningDataModule:\n    pass\n",
    "torch_geometric/__init__.py": "",
    "torch_geometric/data.py": "class Data:\n    def __init__(self, **fields):\n        self.__dict__.update(fields)\n",
    "torch_geometric/loader.py": """
import torch, torch.utils.data
from torch_geometric.data import Data
def batch(graphs):
    starts = [sum(len(g.x) for g in graphs[:i]) for i in range(len(graphs))]
    edges = torch.cat([g.edge_index + start for g, start in zip(graphs, starts)], dim=1)
    return Data(x=torch.cat([g.x for g in graphs]), y=torch.cat([g.y for g in graphs]), edge_index=edges)
class DataLoader(torch.utils.data.DataLoader):
    def __init__(self, data, **options):
        super().__init__(data, collate_fn=batch, **options)
""",
    "torch_geometric/nn.py": """
import torch
class GCNConv(torch.nn.Linear):
    def forward(self, x, edges):
        return super().forward(x).index_add(0, edges[1], super().forward(x)[edges[0]])
""",
}
# What the networks read of a batch in training and validation: models/ of GARF at 2d489c0, but for its meshes, which it reads to draw them; modeling.py,
# encoder/ and eval/ of Rectified Point Flow at bf812e2.
READ = {
    "Garf": {"fracture_surface_gt", "graph", "mesh_scale", "name", "num_parts", "pieces", "pointclouds", "pointclouds_normals", "points_per_part",
             "quaternions", "redundancy", "redundant_pieces", "ref_part", "removal_pieces", "scale", "translations"},
    "RectifiedPointFlow": {"anchor_indices", "anchor_parts", "dataset_name", "index", "name", "num_parts", "overlap_threshold", "pointclouds",
                           "pointclouds_gt", "pointclouds_normals", "points_per_part", "scales"},
}  # fmt: skip


@pytest.fixture
def meshes(tmp_path):
    for side in range(1, 11):
        documents.write_cube(tmp_path / "meshes" / f"cube{side}.obj", side)
    return tmp_path / "meshes"


@pytest.fixture
def path(tmp_path):
    """PYTHONPATH with stubs of what is not installed."""
    for name, text in STUBS.items():
        if importlib.util.find_spec(name.split("/")[0]) is None:
            file = tmp_path / "stubs" / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
    return str(tmp_path / "stubs")


def test_graphs_are_trained_on(meshes, path):
    run = subprocess.run([sys.executable, "-B", EXAMPLES / "graphs.py", meshes, "3"], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
    assert run.returncode == 0 and run.stdout.endswith("in 3 steps\n"), run.stderr


def test_a_graph_has_the_contacts_of_its_fracture(meshes, path, monkeypatch):
    monkeypatch.syspath_prepend(path)
    monkeypatch.syspath_prepend(str(EXAMPLES))
    from graphs import graph_of

    from pysherd.torch import FractureDataset

    data = FractureDataset(meshes, layout="fragments", points=2000, resolution=24, pieces=5, missing=2, items=3)
    for item in data:
        contacts = {(a - 1, b - 1) for a, b in data.fracture(item["index"]).contacts.fragments.tolist()}
        graph = graph_of(item)
        edges = set(map(tuple, graph.edge_index.T.tolist()))
        # A contact of few voxels may have none of the points.
        assert edges <= contacts | {(b, a) for a, b in contacts} and len(edges) >= len(contacts)
        assert len(graph.x) == len(graph.pos) == len(graph.y) == item["fragments"]


@pytest.mark.parametrize("name", READ)
def test_data_modules_have_what_the_networks_read(meshes, path, monkeypatch, name):
    monkeypatch.syspath_prepend(path)
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import lightning_modules

    # With the other arguments of the networks' own configurations.
    module = getattr(lightning_modules, name)(data_root=str(meshes), batch_size=2, num_workers=0, num_points_to_sample=2000, items=4, val_items=2, min_parts=2,
                                              max_parts=20, categories=["everyday"], options={"resolution": 24, "pieces": "2..4"})  # fmt: skip
    loader = module.train_dataloader()
    first, second = ([batch for batch in loader] for _ in range(2))
    assert [READ[name] - set(batch) for batch in first + second] == [set()] * 4
    assert all(batch["pointclouds"].shape == (2, 2000, 3) for batch in first)
    assert not np.array_equal(first[0]["pointclouds_gt"], second[0]["pointclouds_gt"])
    once, again = (next(iter(module.val_dataloader())) for _ in range(2))
    assert np.array_equal(once["pointclouds_gt"], again["pointclouds_gt"])
    assert not set(once["name"]) & {item for batch in first for item in batch["name"]}
