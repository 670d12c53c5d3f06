# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Between collections of Blender and NumPy."""
import numpy as np


def read(collection, name, dtype, columns=1):
    """A property of all items of a collection: [n], or [n, columns]."""
    values = np.empty(len(collection) * columns, dtype)
    collection.foreach_get(name, values)
    return values if columns == 1 else values.reshape(-1, columns)


def write(collection, name, values, dtype):
    collection.foreach_set(name, np.ascontiguousarray(values, dtype).ravel())


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
