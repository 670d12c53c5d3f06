"""Data modules for GARF and Rectified Point Flow that break meshes while the network trains, in place of those that read files.

In the network's folder, with this one on PYTHONPATH, and a folder of meshes in place of the file:
    python train.py experiment=pretraining_frac_seg data._target_=lightning_modules.Garf data.data_root=vessels
    python train.py data._target_=lightning_modules.RectifiedPointFlow data_root=vessels
"""

from collections.abc import Iterator
from typing import Any

import lightning as L
from pysherd.torch import FractureDataset, collate
from torch.utils.data import DataLoader


class Epochs(DataLoader[Any]):
    """Has other fractures each time; FractureDataset alone repeats those of its epoch."""

    epoch = 0

    def __iter__(self) -> Iterator[Any]:  # type: ignore[override]
        self.dataset.set_epoch(self.epoch)  # type: ignore[attr-defined]
        self.epoch += 1
        return super().__iter__()


class Fractures(L.LightningDataModule):
    layout, pieces = "garf", "2..20"

    def __init__(self, data_root: str, batch_size: int = 32, num_workers: int = 4, num_points_to_sample: int = 5000, items: int = 20000,
                 val_items: int = 500, options: dict[str, Any] | None = None, **theirs: Any) -> None:  # fmt: skip
        super().__init__()
        self.data_root, self.points, self.items = data_root, num_points_to_sample, {"train": items, "val": val_items}
        self.loading = {"batch_size": batch_size, "num_workers": num_workers, "collate_fn": collate}
        self.options = {"preset": "training", "resolution": 64, "pieces": self.pieces, **(options or {})}

    def data(self, split: str) -> FractureDataset:
        return FractureDataset(self.data_root, layout=self.layout, points=self.points, split=split, items=self.items[split], **self.options)

    def train_dataloader(self) -> Any:
        return Epochs(self.data("train"), **self.loading)

    def val_dataloader(self) -> Any:
        return DataLoader(self.data("val"), **self.loading)


class Garf(Fractures):
    pass


class RectifiedPointFlow(Fractures):
    layout = "rpf"
