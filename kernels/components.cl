// components: the 6-connected parts of a mask.  A leaf's voxels fall into nodes (connected inside the leaf), and nodes
// that touch across leaf faces are joined in a lock-free union-find whose roots are the lowest node of each part, so
// that the result does not depend on the schedule.  Source: Jaiganesh and Burtscher, ECL-CC, HPDC 2018.
// One work-item takes leaves i, i + items, ...; any work-group size.
// Reference: tests/kernels/components_test.cpp, bit for bit.

// Number the nodes of each leaf 0.. by their first voxel.
kernel void component_nodes(
    const global ulong* restrict inside,  // [leafCount*8]
    const uint leafCount,
    global uchar* restrict localNode,     // [leafCount*512]  out: node of an inside voxel, else 0
    global uint* restrict nodeCount)      // [leafCount]      out
{
  for (size_t leaf = get_global_id(0); leaf < leafCount; leaf += get_global_size(0)) {
    ulong left[SHERD_LEAF_WORDS];
    ulong any = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      left[x] = inside[leaf * SHERD_LEAF_WORDS + x];
      any |= left[x];
    }
    for (int i = 0; i < SHERD_LEAF_SIZE; ++i) localNode[leaf * SHERD_LEAF_SIZE + i] = 0;
    uint node = 0;
    while (any) {
      ulong part[SHERD_LEAF_WORDS];
      int found = 0;  // the first voxel left
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        part[x] = found ? 0 : left[x] & (~left[x] + 1);
        found |= part[x] != 0;
      }
      for (int changed = 1; changed;) {
        changed = 0;
        for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
          ulong reach = part[x] | slab_neighbours(part[x]);
          if (x > 0) reach |= part[x - 1];
          if (x < SHERD_LEAF_WORDS - 1) reach |= part[x + 1];
          reach &= left[x];
          changed |= reach != part[x];
          part[x] = reach;
        }
      }
      any = 0;
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        if (node > 0) {
          for (ulong bits = part[x]; bits; bits &= bits - 1) {
            const int bit = 63 - (int)clz(bits & (~bits + 1));
            localNode[leaf * SHERD_LEAF_SIZE + (x << 6) + bit] = (uchar)node;
          }
        }
        left[x] &= ~part[x];
        any |= left[x];
      }
      ++node;
    }
    nodeCount[leaf] = node;
  }
}

// The root of a node.  Ancestors only ever get lower, so halving the path on the way is safe.
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

// Join the nodes that touch across the +x, +y and +z faces of each leaf.
kernel void component_join(
    const global ulong* restrict inside,     // [leafCount*8]
    const global uint* restrict neighbour,   // [leafCount*6]
    const global uchar* restrict localNode,  // [leafCount*512]
    const global uint* restrict firstNode,   // [leafCount]
    const uint leafCount,
    volatile global uint* parent)            // [nodes]  in, out
{
  for (size_t leaf = get_global_id(0); leaf < leafCount; leaf += get_global_size(0)) {
    for (int k = 1; k < SHERD_LEAF_FACES; k += 2) {
      const uint other = neighbour[leaf * SHERD_LEAF_FACES + k];
      if (other == SHERD_NO_LEAF) continue;
      uint lastA = SHERD_NO_LEAF, lastB = SHERD_NO_LEAF;
      for (int x = (k == 1 ? SHERD_LEAF_WORDS - 1 : 0); x < SHERD_LEAF_WORDS; ++x) {
        const int otherX = k == 1 ? 0 : x;
        ulong touching = inside[leaf * SHERD_LEAF_WORDS + x] &
                         through_face(k, inside[(size_t)other * SHERD_LEAF_WORDS + otherX]);
        for (; touching; touching &= touching - 1) {
          const int bit = 63 - (int)clz(touching & (~touching + 1));
          const int otherBit = k == 3 ? bit - 56 : (k == 5 ? bit - 7 : bit);
          const uint a = firstNode[leaf] + localNode[leaf * SHERD_LEAF_SIZE + (x << 6) + bit];
          const uint b = firstNode[other] +
                         localNode[(size_t)other * SHERD_LEAF_SIZE + (otherX << 6) + otherBit];
          if (a == lastA && b == lastB) continue;
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
    global uint* restrict root)    // [nodes]  out: lowest node of the part
{
  for (size_t i = get_global_id(0); i < nodes; i += get_global_size(0)) root[i] = root_of(parent, (uint)i);
}
