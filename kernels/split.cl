// split: pieces of a solid are split in two by planes or spheres, one for each piece; nodes of components are measured for
// the next splits, and labeled anew where a crack would cut off more than one component.  All arithmetic is on integers.
//
// One work-item takes items i, i + all, ... (item = fracture * leafCount + leaf); any work-group size.
// Reference: tests/kernels/split_test.cpp, bit for bit.

// The cracks of a fracture's pieces, by their label.  Positions are in 1/64 voxel.
struct piece_cracks {
  const global int4* plane;   // normal; w: the label of voxels on the positive side, 0 where the piece is not split
  const global int4* center;  // of a sphere; w: 0 of a plane, 1 of a sphere, 2 of a plane that ignores walls
  const global long* offset;
};

// A leaf: its lowest voxel, the ways of its voxels to the middle of their walls (512*3, in 1/64 voxel; null: all are 0), and
// the longest of any leaf along an axis.
struct leaf_position {
  int4 low;
  const global short* way;
  int reach;
};

// Returns by how much a position is beyond a crack, above 0 on the positive side: dot(normal, position) - offset, or
// |position - center|^2 - offset.
inline long beyond_crack(const struct piece_cracks* cracks, const uint label, const long x, const long y, const long z) {
  const int4 n = cracks->plane[label], c = cracks->center[label];
  if (c.w != 1) return n.x * x + n.y * y + n.z * z - cracks->offset[label];
  return (x - c.x) * (x - c.x) + (y - c.y) * (y - c.y) + (z - c.z) * (z - c.z) - cracks->offset[label];
}

// Returns the voxels of a leaf on the positive side of a label's plane, compared at their centers.
inline ulong8 positive_side_of_plane(const struct piece_cracks* cracks, const uint label, const int4 low) {
  const int4 n = cracks->plane[label];
  const long start = beyond_crack(cracks, label, 64l * low.x, 64l * low.y, 64l * low.z);
  ulong side[SHERD_LEAF_WORDS];
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    ulong word = 0;
    for (int y = 0; y < 8; ++y) {
      long at = start + 64 * ((long)n.x * x + (long)n.y * y);
      for (int z = 0; z < 8; ++z) {
        word |= (ulong)(at > 0) << (8 * y + z);
        at += 64l * n.z;
      }
    }
    side[x] = word;
  }
  return vload8(0, side);
}

// Returns the voxels of a leaf on the positive side of a label's crack.
inline ulong8 positive_side(const struct piece_cracks* cracks, const uint label, const struct leaf_position* leaf) {
  const int kind = cracks->center[label].w;
  if (kind == 2 || (!leaf->way && kind == 0)) return positive_side_of_plane(cracks, label, leaf->low);
  ulong side[SHERD_LEAF_WORDS];
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    ulong word = 0;
    for (int v = 0; v < 64; ++v) {
      long px = 64l * (leaf->low.x + x), py = 64l * (leaf->low.y + (v >> 3)), pz = 64l * (leaf->low.z + (v & 7));
      if (leaf->way) {
        const global short* const way = leaf->way + 3 * (64 * x + v);
        px += way[0];
        py += way[1];
        pz += way[2];
      }
      word |= (ulong)(beyond_crack(cracks, label, px, py, pz) > 0) << v;
    }
    side[x] = word;
  }
  return vload8(0, side);
}

// The least and the greatest value of beyond_crack in a leaf, or values beyond them.
struct crack_bounds {
  long least, most;
};

// Adds the least and the greatest square of a difference from c along an axis.
inline void add_squares(struct crack_bounds* bounds, const long low, const long high, const long c) {
  const long below = c - low, above = high - c;
  const long nearest = below < 0 ? -below : above < 0 ? -above : 0;
  const long farthest = max(below, above);
  bounds->least += nearest * nearest;
  bounds->most += farthest * farthest;
}

inline struct crack_bounds bounds_in_leaf(const struct piece_cracks* cracks, const uint label, const struct leaf_position* leaf) {
  const int4 n = cracks->plane[label], c = cracks->center[label];
  const long reach = leaf->reach, side = 64 * 7 + 2 * reach;
  const long x = 64l * leaf->low.x - reach, y = 64l * leaf->low.y - reach, z = 64l * leaf->low.z - reach;
  struct crack_bounds bounds = {0, 0};
  if (c.w == 1) {
    bounds.least = bounds.most = -cracks->offset[label];
    add_squares(&bounds, x, x + side, c.x);
    add_squares(&bounds, y, y + side, c.y);
    add_squares(&bounds, z, z + side, c.z);
    return bounds;
  }
  bounds.least = beyond_crack(cracks, label, x, y, z) + side * ((long)min(n.x, 0) + (long)min(n.y, 0) + (long)min(n.z, 0));
  bounds.most = bounds.least + side * ((long)abs(n.x) + (long)abs(n.y) + (long)abs(n.z));
  return bounds;
}

// Voxels of a leaf with one label.
struct labeled {
  uint label;
  ulong8 mask;
};

// Splits voxels of one label: the rest keeps it, and `added` gets those on the positive side.
inline struct labeled split_voxels(const struct piece_cracks* cracks, const struct leaf_position* leaf, struct labeled* kept) {
  struct labeled added = {(uint)cracks->plane[kept->label].w, (ulong8)(0)};
  if (added.label == 0) return added;
  const struct crack_bounds bounds = bounds_in_leaf(cracks, kept->label, leaf);
  if (bounds.most <= 0) return added;
  added.mask = kept->mask;
  if (bounds.least <= 0) added.mask &= positive_side(cracks, kept->label, leaf);
  kept->mask &= ~added.mask;
  return added;
}

// Splits a leaf of one label or two.
inline void split_leaf(const struct piece_cracks* cracks, const ulong8 mask, const struct leaf_position* leaf, const uint item,
                       global ushort* owner, global uint* tag, global ulong* second) {
  const uint before = tag[item];
  struct labeled part[4] = {{before & 0xffff, mask}, {before >> 16, (ulong8)(0)}};
  if (is_pair(before)) {
    part[1].mask = vload8(second_voxels(item), second);
    part[0].mask &= ~part[1].mask;
  }
  part[2] = split_voxels(cracks, leaf, &part[0]);
  part[3] = split_voxels(cracks, leaf, &part[1]);
  uint after = 0;
  for (int i = 0; i < 4; ++i) {
    if (any_of(part[i].mask)) after = with_label(after, part[i].label);
  }
  if (after == before && !any_of(part[2].mask | part[3].mask)) return;
  if (after == SHERD_TAG_MIXED) {
    ushort label[SHERD_LEAF_SIZE];
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) label[v] = 0;
    for (int i = 0; i < 4; ++i) {
      ulong words[SHERD_LEAF_WORDS];
      vstore8(part[i].mask, 0, words);
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        for (ulong bits = words[x]; bits; bits &= bits - 1) label[(x << 6) + lowest_bit(bits)] = (ushort)part[i].label;
      }
    }
    ulong words[SHERD_LEAF_WORDS];
    vstore8(mask, 0, words);
    write_labels(words, label, after, item, owner, tag, second);
    return;
  }
  tag[item] = after;
  if (!is_pair(after)) return;
  ulong8 ofSecond = (ulong8)(0);
  for (int i = 0; i < 4; ++i) {
    if (part[i].label == after >> 16) ofSecond |= part[i].mask;
  }
  vstore8(ofSecond, second_voxels(item), second);
}

// Writes a label per inside voxel, and 0 outside.
inline void read_labels(const struct leaf_labels* labels, const ulong* mask, const size_t item, ushort* label) {
  for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
    label[v] = (mask[v >> 6] >> (v & 63)) & 1 ? (ushort)label_of(labels, item, v) : 0;
  }
}

// Returns the tag of labels per voxel.
inline uint tag_of(const ushort* label) {
  uint found = 0;
  for (int v = 0; v < SHERD_LEAF_SIZE && found != SHERD_TAG_MIXED; ++v) found = with_label(found, label[v]);
  return found;
}

// Writes the labels of a leaf, where it has one as its tag.
inline void store_labels(const ulong* mask, const ushort* label, const uint item, global ushort* owner,
                         global uint* tag, global ulong* second) {
  const uint all = tag_of(label);
  if (all <= 0xffff) {
    tag[item] = all;
  } else {
    write_labels(mask, label, all, item, owner, tag, second);
  }
}

// Voxels on the positive side of their piece's crack get its second label.
kernel void split_labels(
    const global ulong* restrict inside,     // [leafCount*8]
    const global int4* restrict origin,      // [leafCount]    lowest voxel as seen from the lowest leaf, w unused
    const uint leafCount,
    const uint items,
    const global short* restrict way,        // [leafCount*512*3] to the middle of walls, 1/64 voxel; [1] where no fracture uses it
    const int reach,                         // the longest of these along an axis
    const global uint* restrict usesWay,     // [fractures]    0: voxels are compared at their centers
    const global uint* restrict firstPiece,  // [fractures]    index of label 0 in the next three
    const global int4* restrict plane,       // [labels]       see piece_cracks
    const global int4* restrict center,      // [labels]
    const global long* restrict offset,      // [labels]
    global ushort* restrict owner,           // [items*512]    in, out, see leaf_labels.h
    global uint* restrict tag,               // [items]        in, out
    global ulong* restrict second)           // [items*3*8]    in, out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount, fracture = item / leafCount;
    const size_t first = firstPiece[fracture];
    const struct piece_cracks cracks = {plane + first, center + first, offset + first};
    struct leaf_position position = {origin[leaf], 0, 0};
    if (usesWay[fracture]) {
      position.way = way + 3 * SHERD_LEAF_SIZE * leaf;
      position.reach = reach;
    }
    const uint before = tag[item];
    if (before == 0) continue;
    if (before != SHERD_TAG_MIXED) {
      split_leaf(&cracks, vload8(leaf, inside), &position, (uint)item, owner, tag, second);
      continue;
    }
    ulong mask[SHERD_LEAF_WORDS];
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) mask[x] = inside[leaf * SHERD_LEAF_WORDS + x];
    const struct leaf_labels labels = {owner, tag, second};
    ushort label[SHERD_LEAF_SIZE];
    read_labels(&labels, mask, item, label);
    uint splitLabel = 0;
    ulong side[SHERD_LEAF_WORDS];
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      if (label[v] == 0 || cracks.plane[label[v]].w == 0) continue;
      if (label[v] != splitLabel) {
        splitLabel = label[v];
        vstore8(positive_side(&cracks, splitLabel, &position), 0, side);
      }
      if ((side[v >> 6] >> (v & 63)) & 1) label[v] = (ushort)cracks.plane[splitLabel].w;
    }
    store_labels(mask, label, (uint)item, owner, tag, second);
  }
}

// Voxels on the positive side of a given crack get the second label of their piece.
kernel void split_by_sides(
    const global ulong* restrict inside,     // [leafCount*8]
    const global ulong* restrict positive,   // [leafCount*8]  inside voxels on the positive side
    const uint leafCount,
    const uint items,
    const global uint* restrict firstPiece,  // [fractures]    index of label 0 in the next
    const global uint* restrict added,       // [labels]       the label of voxels on the positive side, 0: not split
    global ushort* restrict owner,           // [items*512]    in, out, see leaf_labels.h
    global uint* restrict tag,               // [items]        in, out
    global ulong* restrict second)           // [items*3*8]    in, out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    const global uint* const addedTo = added + firstPiece[item / leafCount];
    const uint before = tag[item];
    ulong mask[SHERD_LEAF_WORDS], any = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      mask[x] = inside[leaf * SHERD_LEAF_WORDS + x];
      any |= positive[leaf * SHERD_LEAF_WORDS + x];
    }
    if (!any || (before <= 0xffff && addedTo[before] == 0)) continue;
    const struct leaf_labels labels = {owner, tag, second};
    ushort label[SHERD_LEAF_SIZE];
    read_labels(&labels, mask, item, label);
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      if (!((positive[leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1)) continue;
      if (addedTo[label[v]] != 0) label[v] = (ushort)addedTo[label[v]];
    }
    store_labels(mask, label, (uint)item, owner, tag, second);
  }
}

// The sums of a node's voxels, relative to the leaf's lowest one.  Each is below 2^16.
#define SPLIT_COUNT 0  // voxels
#define SPLIT_SUM 1    // x, y, z
#define SPLIT_SQUARE 4 // xx, yy, zz, xy, xz, yz
#define SPLIT_LABEL 10
#define SPLIT_SUMS 12

// Bits of a word by the bits of their y and z.
static constant ulong kBitsOfY[3] = {0xff00ff00ff00ff00ul, 0xffff0000ffff0000ul, 0xffffffff00000000ul};
static constant ulong kBitsOfZ[3] = {0xaaaaaaaaaaaaaaaaul, 0xccccccccccccccccul, 0xf0f0f0f0f0f0f0f0ul};

// Adds the sums of a mask's voxels.
inline void add_sums(const ulong* mask, uint* sum) {
  ulong all = ~0ul;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) all &= mask[x];
  if (all == ~0ul) {
    sum[SPLIT_COUNT] += 512;
    for (int i = 0; i < 3; ++i) {
      sum[SPLIT_SUM + i] += 64 * 28;           // 0 + 1 + ... + 7
      sum[SPLIT_SQUARE + i] += 64 * 140;       // 0 + 1 + 4 + ... + 49
      sum[SPLIT_SQUARE + 3 + i] += 8 * 28 * 28;
    }
    return;
  }
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    const ulong word = mask[x];
    if (!word) continue;
    const uint count = (uint)popcount(word);
    uint y = 0, z = 0, yy = 0, zz = 0, yz = 0;
    for (int i = 0; i < 3; ++i) {
      const ulong ofY = word & kBitsOfY[i], ofZ = word & kBitsOfZ[i];
      y += (uint)popcount(ofY) << i;
      z += (uint)popcount(ofZ) << i;
      for (int j = 0; j < 3; ++j) {
        yy += (uint)popcount(ofY & kBitsOfY[j]) << (i + j);
        zz += (uint)popcount(ofZ & kBitsOfZ[j]) << (i + j);
        yz += (uint)popcount(ofY & kBitsOfZ[j]) << (i + j);
      }
    }
    sum[SPLIT_COUNT] += count;
    sum[SPLIT_SUM] += count * x;
    sum[SPLIT_SUM + 1] += y;
    sum[SPLIT_SUM + 2] += z;
    sum[SPLIT_SQUARE] += count * x * x;
    sum[SPLIT_SQUARE + 1] += yy;
    sum[SPLIT_SQUARE + 2] += zz;
    sum[SPLIT_SQUARE + 3] += x * y;
    sum[SPLIT_SQUARE + 4] += x * z;
    sum[SPLIT_SQUARE + 5] += yz;
  }
}

// Writes the sums of the voxels of each node, and their label.
kernel void split_measure(
    const global ulong* restrict inside,      // [leafCount*8]
    const uint leafCount,
    const uint items,
    LEAF_LABELS,
    const global ushort* restrict localNode,  // [items*512]  see components.cl
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    global ushort* restrict sums)             // [nodes*SPLIT_SUMS]  out
{
  const struct leaf_labels labels = {owner, tag, second};
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    const uint nodes = nodeCount[item];
    for (uint node = 0; node < nodes; ++node) {
      ulong mask[SHERD_LEAF_WORDS];
      if (nodes > 1) equal_mask(localNode + item * SHERD_LEAF_SIZE, (ushort)node, mask);
      int any = -1;  // a voxel of the node
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        const ulong word = inside[leaf * SHERD_LEAF_WORDS + x];
        mask[x] = nodes > 1 ? mask[x] & word : word;
        if (mask[x]) any = (x << 6) + lowest_bit(mask[x]);
      }
      uint sum[SPLIT_LABEL] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
      add_sums(mask, sum);
      global ushort* const out = sums + (size_t)(firstNode[item] + node) * SPLIT_SUMS;
      for (int i = 0; i < SPLIT_LABEL; ++i) out[i] = (ushort)sum[i];
      out[SPLIT_LABEL] = (ushort)label_of(&labels, item, any);
      out[SPLIT_LABEL + 1] = 0;
    }
  }
}

// Appends a pair of components, unless it is the last one.
inline void append_contact(const uint a, const uint b, uint* lastA, uint* lastB, const uint capacity,
                           volatile global uint* count, global uint* contact) {
  const uint low = min(a, b), high = max(a, b);
  if (low == *lastA && high == *lastB) return;
  *lastA = low;
  *lastB = high;
  const uint at = atomic_add(count, 1u);
  if (at >= capacity) return;
  contact[2 * (size_t)at] = low;
  contact[2 * (size_t)at + 1] = high;
}

// Lists pairs of components of the same piece that touch, with repetitions and in any order.
kernel void split_contacts(
    const global ulong* restrict inside,      // [leafCount*8]
    const global uint* restrict neighbor,     // [leafCount*6]
    const uint leafCount,
    const uint items,
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    const global uint* restrict root,         // [nodes]
    const global uint* restrict piece,        // [nodes]      of each node; 0: not asked for
    const uint capacity,
    volatile global uint* count,              // [1]          in: 0; out: contacts found, also those beyond the capacity
    global uint* restrict contact)            // [capacity*2] out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    const uint nodes = nodeCount[item];
    int isAsked = 0, axes = 0;  // bit k: components may touch along axis k
    for (uint n = 0; n < nodes; ++n) isAsked |= piece[firstNode[item] + n] != 0;
    for (int axis = 0; axis < 3 && isAsked; ++axis) {
      const uint otherLeaf = neighbor[leaf * SHERD_LEAF_FACES + 2 * axis + 1];
      const size_t other = item - leaf + otherLeaf;
      const int isOther = otherLeaf != SHERD_NO_LEAF &&
                          (nodeCount[other] > 1 ||
                           (nodeCount[other] == 1 && root[firstNode[other]] != root[firstNode[item]]));
      axes |= (nodes > 1 || isOther) << axis;
    }
    uint lastA = SHERD_NO_LEAF, lastB = SHERD_NO_LEAF;
    for (int v = 0; v < SHERD_LEAF_SIZE && axes; ++v) {
      if (!((inside[leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1)) continue;
      const uint a = node_of(firstNode, nodeCount, localNode, item, v);
      if (piece[a] == 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const int shift = 6 - 3 * axis;
        if (!((axes >> axis) & 1) || (nodes == 1 && ((v >> shift) & 7) != 7)) continue;
        size_t other = item;
        int at = v + (1 << shift);
        if (((v >> shift) & 7) == 7) {
          const uint otherLeaf = neighbor[leaf * SHERD_LEAF_FACES + 2 * axis + 1];
          if (otherLeaf == SHERD_NO_LEAF) continue;
          other = item - leaf + otherLeaf;
          at = v & ~(7 << shift);
        }
        if (!((inside[(other % leafCount) * SHERD_LEAF_WORDS + (at >> 6)] >> (at & 63)) & 1)) continue;
        const uint b = node_of(firstNode, nodeCount, localNode, other, at);
        if (piece[b] == piece[a] && root[a] != root[b]) {
          append_contact(root[a], root[b], &lastA, &lastB, capacity, count, contact);
        }
      }
    }
  }
}

// Gives nodes new labels.
kernel void split_relabel(
    const global ulong* restrict inside,      // [leafCount*8]
    const uint leafCount,
    const uint items,
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    const global uint* restrict changed,      // [items]      not 0: of a node of the item
    const global ushort* restrict nodeLabel,  // [nodes]
    global ushort* restrict owner,            // [items*512]  out, of changed items; see leaf_labels.h
    global uint* restrict tag,                // [items]      out
    global ulong* restrict second)            // [items*3*8]  out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    if (!changed[item]) continue;
    if (nodeCount[item] == 1) {
      tag[item] = nodeLabel[firstNode[item]];
      continue;
    }
    ulong mask[SHERD_LEAF_WORDS];
    ushort label[SHERD_LEAF_SIZE];
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) mask[x] = inside[(item % leafCount) * SHERD_LEAF_WORDS + x];
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      const int isInside = (mask[v >> 6] >> (v & 63)) & 1;
      label[v] = isInside ? nodeLabel[node_of(firstNode, nodeCount, localNode, item, v)] : 0;
    }
    store_labels(mask, label, (uint)item, owner, tag, second);
  }
}

// Finds the voxel of each of the given nodes that is nearest to a position; ties go to the lowest offset.
kernel void split_nearest(
    const global ulong* restrict inside,      // [leafCount*8]
    const uint leafCount,
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    const global uint* restrict item,         // [count]
    const global uint* restrict node,         // [count]  of the item, counted from its first
    const global int4* restrict position,     // [count]  from the leaf's lowest voxel, w unused
    const uint count,
    global ushort* restrict offset)           // [count]  out
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    const size_t leaf = item[i] % leafCount;
    long least = LONG_MAX;
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      if (!((inside[leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1)) continue;
      if (node_of(firstNode, nodeCount, localNode, item[i], v) != firstNode[item[i]] + node[i]) continue;
      const long x = (v >> 6) - position[i].x, y = ((v >> 3) & 7) - position[i].y, z = (v & 7) - position[i].z;
      const long squared = x * x + y * y + z * z;
      if (squared >= least) continue;
      least = squared;
      offset[i] = (ushort)v;
    }
  }
}
