// components: 6-connected components of a mask, or of equal labels in it.  The voxels of a leaf form nodes, connected
// inside the leaf.  A lock-free union-find joins nodes that touch across leaf faces; its roots are the lowest node of
// each component, so the result does not depend on the schedule.
// Source: Jaiganesh and Burtscher, ECL-CC, HPDC 2018.
//
// Most leaves are one node; a voxel's node is written only for leaves with several.
//
// A launch covers several fractures of the same leaves: item = fracture * leafCount + leaf.
// One work-item takes items i, i + all, ...; any work-group size.
// Reference: tests/kernels/components_test.cpp, bit for bit.

// Returns the node of an inside voxel of an item.
inline uint node_of(const global uint* firstNode, const global uint* nodeCount, const global ushort* localNode,
                    const size_t item, const int v) {
  return firstNode[item] + (nodeCount[item] > 1 ? localNode[item * SHERD_LEAF_SIZE + v] : 0u);
}

// Adds to `component` all voxels of `mask` that are connected to it within the leaf.
inline void fill_component(const ulong* mask, ulong* component) {
  for (int changed = 1; changed;) {
    changed = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      ulong reach = component[x] | slab_neighbors(component[x]);
      if (x > 0) reach |= component[x - 1];
      if (x < SHERD_LEAF_WORDS - 1) reach |= component[x + 1];
      reach &= mask[x];
      changed |= reach != component[x];
      component[x] = reach;
    }
  }
}

// Writes the node of its voxels; the first node of an item is written with the second, if there is one.
inline void write_node(const ulong* component, const uint node, global ushort* localNode) {
  if (node == 1) {
    for (int i = 0; i < SHERD_LEAF_SIZE; ++i) localNode[i] = 0;
  }
  for (int x = 0; x < SHERD_LEAF_WORDS && node > 0; ++x) {
    for (ulong bits = component[x]; bits; bits &= bits - 1) localNode[(x << 6) + lowest_bit(bits)] = (ushort)node;
  }
}

// Numbers the nodes of each item 0.. by their first voxel.
kernel void component_nodes(
    const global ulong* restrict inside,  // [leafCount*8]
    const uint leafCount,
    const uint items,
    LEAF_LABELS,                          // read when byLabel
    const uint byLabel,
    global ushort* restrict localNode,    // [items*512]  out, items with several nodes: node of an inside voxel, else 0
    global uint* restrict nodeCount)      // [items]      out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    const uint itemTag = byLabel ? tag[item] : 0;
    const global ushort* restrict labels = owner + (itemTag == SHERD_TAG_MIXED ? item * SHERD_LEAF_SIZE : 0);
    ulong remaining[SHERD_LEAF_WORDS];
    ulong any = 0, all = ~0ul;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      remaining[x] = inside[leaf * SHERD_LEAF_WORDS + x];
      any |= remaining[x];
      all &= remaining[x];
    }
    if (all == ~0ul && itemTag <= 0xffff) {  // a full leaf of one label
      nodeCount[item] = 1;
      continue;
    }
    uint node = 0;
    ulong same[SHERD_LEAF_WORDS], seconds[SHERD_LEAF_WORDS];  // voxels with the label of `first`; with the second
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) same[x] = ~0ul;
    vstore8(second_of(itemTag, (uint)item, second), 0, seconds);
    uint sameLabel = SHERD_TAG_MIXED;
    while (any) {
      ulong component[SHERD_LEAF_WORDS];
      int first = -1;  // first voxel without a node
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        component[x] = first >= 0 ? 0 : remaining[x] & (~remaining[x] + 1);
        if (component[x]) first = (x << 6) + lowest_bit(component[x]);
      }
      if (itemTag == SHERD_TAG_MIXED && labels[first] != sameLabel) {
        sameLabel = labels[first];
        equal_mask(labels, (ushort)sameLabel, same);
      } else if (is_pair(itemTag)) {
        const ulong others = seconds[first >> 6] >> (first & 63) & 1 ? 0 : ~0ul;
        for (int x = 0; x < SHERD_LEAF_WORDS; ++x) same[x] = seconds[x] ^ others;
      }
      ulong mask[SHERD_LEAF_WORDS];
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) mask[x] = remaining[x] & same[x];
      fill_component(mask, component);
      write_node(component, node, localNode + item * SHERD_LEAF_SIZE);
      any = 0;
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        remaining[x] &= ~component[x];
        any |= remaining[x];
      }
      ++node;
    }
    nodeCount[item] = node;
  }
}

// Returns the root of a node.  Ancestors only get lower, so path halving during the walk is safe.
inline uint root_of(volatile global uint* parent, uint node) {
  uint up = atomic_add(&parent[node], 0u);
  while (up != node) {
    const uint next = atomic_add(&parent[up], 0u);
    if (next != up) atomic_min(&parent[node], next);
    node = up;
    up = next;
  }
  return node;
}

inline void join(volatile global uint* parent, uint a, uint b) {
  for (;;) {
    a = root_of(parent, a);
    b = root_of(parent, b);
    if (a == b) return;
    const uint low = min(a, b), high = max(a, b);
    if (atomic_cmpxchg(&parent[high], high, low) == high) return;
  }
}

kernel void component_begin(const uint nodes, global uint* restrict parent)  // [nodes]  out
{
  for (size_t i = get_global_id(0); i < nodes; i += get_global_size(0)) parent[i] = (uint)i;
}

// Joins the nodes that touch across the +x, +y and +z faces of each item.
kernel void component_join(
    const global ulong* restrict inside,      // [leafCount*8]
    const global uint* restrict neighbor,     // [leafCount*6]
    const uint leafCount,
    const uint items,
    LEAF_LABELS,                              // read when byLabel
    const uint byLabel,
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    volatile global uint* parent)             // [nodes]  in, out
{
  const struct leaf_labels labels = {owner, tag, second};
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    for (int k = 1; k < SHERD_LEAF_FACES; k += 2) {
      const uint otherLeaf = neighbor[leaf * SHERD_LEAF_FACES + k];
      if (otherLeaf == SHERD_NO_LEAF) continue;
      const size_t other = item - leaf + otherLeaf;
      uint lastA = SHERD_NO_LEAF, lastB = SHERD_NO_LEAF;
      const bool onePair = nodeCount[item] == 1 && nodeCount[other] == 1;  // one contact is enough
      bool done = false;
      for (int x = (k == 1 ? SHERD_LEAF_WORDS - 1 : 0); x < SHERD_LEAF_WORDS && !done; ++x) {
        const int otherX = k == 1 ? 0 : x;
        ulong contacts = inside[leaf * SHERD_LEAF_WORDS + x] &
                         through_face(k, inside[(size_t)otherLeaf * SHERD_LEAF_WORDS + otherX]);
        for (; contacts && !done; contacts &= contacts - 1) {
          done = onePair;
          const int bit = lowest_bit(contacts);
          const int otherBit = k == 3 ? bit - 56 : (k == 5 ? bit - 7 : bit);
          const int v = (x << 6) + bit, otherV = (otherX << 6) + otherBit;
          const uint a = node_of(firstNode, nodeCount, localNode, item, v);
          const uint b = node_of(firstNode, nodeCount, localNode, other, otherV);
          if (a == lastA && b == lastB) continue;
          if (byLabel && label_of(&labels, item, v) != label_of(&labels, other, otherV)) continue;
          join(parent, a, b);
          lastA = a;
          lastB = b;
        }
      }
    }
  }
}

kernel void component_flatten(
    const uint nodes,
    volatile global uint* parent,  // [nodes]
    global uint* restrict root)    // [nodes]  out: lowest node of the component
{
  for (size_t i = get_global_id(0); i < nodes; i += get_global_size(0)) root[i] = root_of(parent, (uint)i);
}

// Counts the voxels of each node and writes their label.
kernel void component_measure(
    const global ulong* restrict inside,      // [leafCount*8]
    const uint leafCount,
    const uint items,
    LEAF_LABELS,
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    global uint* restrict nodeVoxels,         // [nodes]  out
    global ushort* restrict nodeLabel)        // [nodes]  out
{
  const struct leaf_labels labels = {owner, tag, second};
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    for (uint n = 0; n < nodeCount[item]; ++n) nodeVoxels[firstNode[item] + n] = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      for (ulong bits = inside[leaf * SHERD_LEAF_WORDS + x]; bits; bits &= bits - 1) {
        const int v = (x << 6) + lowest_bit(bits);
        const uint node = node_of(firstNode, nodeCount, localNode, item, v);
        ++nodeVoxels[node];
        nodeLabel[node] = (ushort)label_of(&labels, item, v);
      }
    }
  }
}

// Marks the components that contain one of the given voxels.
kernel void component_mark(
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    const global uint* restrict root,         // [nodes]
    const global uint* restrict voxelItem,    // [voxels]
    const global ushort* restrict voxelOffset,  // [voxels]  offset in the leaf
    const uint voxels,
    volatile global uint* keep)               // [nodes]  in: 0; out: 1 at the roots of marked components
{
  for (size_t i = get_global_id(0); i < voxels; i += get_global_size(0)) {
    const uint item = voxelItem[i];
    const uint node = node_of(firstNode, nodeCount, localNode, item, voxelOffset[i]);
    atomic_xchg(&keep[root[node]], 1u);
  }
}

// Writes the voxels of marked components as masks, and counts the voxels in no marked component.
kernel void component_kept(
    const global ulong* restrict inside,      // [leafCount*8]
    const uint leafCount,
    const uint items,
    const global ushort* restrict localNode,  // [items*512]
    const global uint* restrict firstNode,    // [items]
    const global uint* restrict nodeCount,    // [items]
    const global uint* restrict root,         // [nodes]
    const global uint* restrict keep,         // [nodes]
    global ulong* restrict kept,              // [items*8]  out
    volatile global uint* disconnected)       // [fractures]  in: 0; out: voxels in no marked component
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    uint removed = 0;
    uint keptNodes = 0;
    for (uint n = 0; n < nodeCount[item]; ++n) keptNodes += keep[root[firstNode[item] + n]] != 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong all = inside[leaf * SHERD_LEAF_WORDS + x];
      ulong mask = keptNodes ? all : 0;
      if (keptNodes && keptNodes < nodeCount[item]) {
        for (ulong bits = all; bits; bits &= bits - 1) {
          const int bit = lowest_bit(bits);
          const uint node = node_of(firstNode, nodeCount, localNode, item, (x << 6) + bit);
          if (!keep[root[node]]) mask &= ~(1ul << bit);
        }
      }
      kept[item * SHERD_LEAF_WORDS + x] = mask;
      removed += (uint)popcount(all & ~mask);
    }
    if (removed) atomic_add(&disconnected[item / leafCount], removed);
  }
}
