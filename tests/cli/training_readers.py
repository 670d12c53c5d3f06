"""Readers of training data that go by the same steps as the loaders that networks come with, written anew: numpy and h5py only.

GARF 2d489c0 assembly/data/breaking_bad/base.py, Rectified Point Flow bf812e2 and TORA 9ca3970 */data/dataset.py, PuzzleFusion++
e249a25 puzzlefusion_plusplus/{vqvae,denoiser}/dataset.  Where a loader trusts what it reads, these trust it too.
"""
import os

import h5py
import numpy as np


class Garf:
    """base.py:76-105, 117-186, 232-254"""

    def __init__(self, path, category, split, max_parts=20, num_removal=0, num_redundancy=0):
        self.path, self.max_parts = path, max_parts
        self.num_removal, self.num_redundancy = num_removal, num_redundancy
        with h5py.File(path, "r") as file:
            listed = [d.decode("utf-8") for d in list(file["data_split"][category][split])]
            self.listed = listed
            self.data_list = []
            for item in listed:
                num_parts = len(file[item]["pieces"].keys())
                if 2 + num_removal <= num_parts <= max_parts - num_redundancy and num_parts > num_redundancy:
                    self.data_list.append(item)

    def __getitem__(self, index):
        name = self.data_list[index]
        with h5py.File(self.path, "r") as file:
            pieces = file[name]["pieces"].keys()
            pieces_names = [n.decode("utf-8") for n in file[name]["pieces_names"][:]]
            num_parts = len(pieces)
            meshes = [(np.array(file[name]["pieces"][p]["vertices"][:]), np.array(file[name]["pieces"][p]["faces"][:])) for p in pieces]
            shared = [np.array(file[name]["pieces"][p]["shared_faces"][:]) for p in pieces]
            graph = np.zeros((self.max_parts, self.max_parts), dtype=bool)
            for i in range(num_parts):
                for j in range(i + 1, num_parts):
                    if j in shared[i]:
                        graph[i, j] = graph[j, i] = 1
            removed = []
            if self.num_removal > 0:
                num_parts -= self.num_removal
                mask = file[name]["removal_masks"][self.num_removal - 1]
                kept = np.arange(len(meshes))[mask]  # their array of meshes is indexed so
                meshes = [meshes[i] for i in kept]
                order = np.array(file[name]["removal_order"][:self.num_removal])
                removed = list(np.array(pieces_names)[order])
                shared = [shared[i] for i in kept]
                assert len(meshes) == num_parts
            redundant = []
            if self.num_redundancy > 0:
                rows = file[name]["redundant_pieces"][:self.num_redundancy]
                redundant = [f"{p[0].decode('utf-8')}/pieces/{p[1].decode('utf-8')}" for p in rows]
                meshes += [(np.array(file[p]["vertices"][:]), np.array(file[p]["faces"][:])) for p in redundant]
                shared += [-np.ones(len(m[1]), dtype=np.int64) for m in meshes[num_parts:]]
        return {"name": name, "meshes": meshes, "shared_faces": shared, "graph": graph, "pieces": pieces_names,
                "removal_pieces": removed, "redundant_pieces": redundant}


class Rpf:
    """dataset.py:133-167, 189-203; with `tora`, its two more lines that look for "pieces" """

    def __init__(self, path, split, tora=False):
        self.file = h5py.File(path, "r", libver="latest", swmr=True)
        self.tora = tora
        name = os.path.splitext(os.path.basename(path))[0]
        raw = self.file["data_split"][name][split]
        self.listed = [r.decode() for r in raw[:]]
        self.fragments = [f for f in self.listed if 2 <= len(self.group(f).keys()) <= 64]

    def group(self, name):
        group = self.file[name]
        return group["pieces"] if self.tora and "pieces" in group else group

    def __getitem__(self, index):
        group = self.group(self.fragments[index])
        return [(np.array(group[p]["vertices"][:]), np.array(group[p]["faces"][:])) for p in sorted(list(group.keys()))]


def rotation_of(quaternion):
    """The matrix of w, x, y, z."""
    w, x, y, z = np.asarray(quaternion, float) / np.linalg.norm(quaternion)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


class PuzzleFusion:
    """denoiser/dataset/dataset.py:26-79, 150-200; the auto-encoder's pc_dataset.py:41-66 reads `category` too"""
    MOST = 20

    def __init__(self, data_dir, matching=None, seed=0):
        self.random = np.random.default_rng(seed)
        self.data_list = []
        for name in sorted(f for f in os.listdir(data_dir) if f.endswith(".npz")):
            data = np.load(os.path.join(data_dir, name))
            sample = {"num_parts": data["num_parts"].item(), "data_id": data["data_id"].item(), "part_valids": data["part_valids"],
                      "part_pcs_gt": data["part_pcs_gt"], "mesh_file_path": data["mesh_file_path"].item(), "graph": data["graph"],
                      "ref_part": data["ref_part"], "category": data["category"]}
            if matching:
                path = os.path.join(matching, str(sample["data_id"]) + ".npz")
                if not os.path.exists(path):
                    continue
                matched = np.load(path, allow_pickle=True)
                correspondences = matched["correspondence"]
                if correspondences.shape[0] != 1:
                    if correspondences.dtype == "O":
                        sample["correspondences"] = correspondences.tolist()
                    else:
                        sample["correspondences"] = [correspondences[i] for i in range(correspondences.shape[0])]
                else:
                    sample["correspondences"] = [correspondences.squeeze()]
                sample["gt_pc_by_area"] = matched["gt_pcs"]
                for key in "critical_pcs_idx", "edges", "n_pcs", "n_critical_pcs":
                    sample[key] = matched[key]
            self.data_list.append(sample)

    def pad(self, data):
        data = np.array(data)
        padded = np.zeros((self.MOST, *data.shape[1:]), dtype=np.float32)
        padded[:data.shape[0]] = data
        return padded

    def rotated(self, points):
        quaternion = self.random.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        return points @ rotation_of(quaternion).T, quaternion * [1, -1, -1, -1]  # what undoes it

    def __getitem__(self, index):
        """What a network gets, and the poses that put the parts together."""
        sample = dict(self.data_list[index])
        parts = sample["part_pcs_gt"]
        turned, init_r = self.rotated(parts.reshape(-1, 3))
        turned = turned.reshape(parts.shape)
        reference = np.where(sample["ref_part"])[0]
        init_t = turned[reference.item()].mean(axis=0)
        turned = turned - init_t
        points, quaternions, translations = [], [], []
        for i in range(sample["num_parts"]):
            center = turned[i].mean(axis=0)
            moved, quaternion = self.rotated(turned[i] - center)
            points.append(moved)
            quaternions.append(quaternion)
            translations.append(center)
        sample["assembled"] = turned
        sample["part_pcs"] = self.pad(np.stack(points))
        sample["part_rots"], sample["part_trans"] = self.pad(np.stack(quaternions)), self.pad(np.stack(translations))
        sample["init_pose_r"], sample["init_pose_t"] = init_r, init_t
        if "gt_pc_by_area" in sample:
            by_area = sample["gt_pc_by_area"] @ rotation_of(init_r) - init_t
            sample["anchored"], out, at = by_area, [], 0
            for i in range(sample["num_parts"]):
                own = by_area[at:at + sample["n_pcs"][i]] - sample["part_trans"][i]
                out.append(own @ rotation_of(sample["part_rots"][i]))  # the inverse of the rotation
                at += sample["n_pcs"][i]
            sample["part_pcs_by_area"] = np.concatenate(out).astype(np.float32)
        return sample


def parts_of(sample, values):
    """Those of each part, of what is stored for all parts one after another."""
    ends = np.cumsum(sample["n_pcs"][:sample["num_parts"]])
    return np.split(values, ends[:-1])
