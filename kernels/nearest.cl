// nearest: give every inside voxel the label of its nearest seed, across gaps too; ties go to the lower label.  A leaf
// first computes an upper bound of the distance of its voxels to their nearest seed, then tests only seeds whose lower
// bound does not exceed it.
//
// One work-item takes items i, i + all, ... (item = fracture * leafCount + leaf); any work-group size.
// Reference: tests/kernels/growths_test.cpp, bit for bit.

// Returns a lower (side -1) or upper (side 1) bound of the distance from any voxel of a leaf to a seed.  Differences
// are doubled so that the center of a leaf is an integer; per axis no voxel is further than 7 from it (doubled).
inline long leaf_bound(const struct sherd_metric* metric, const int4 doubledCenter, const int4 seed, const int side) {
  const long x = doubledCenter.x - 2 * seed.x, y = doubledCenter.y - 2 * seed.y, z = doubledCenter.z - 2 * seed.z;
  long a[3];
  for (int i = 0; i < 3; ++i) {
    const long q = sherd_row(metric, i, x, y, z);
    const long slack =
        7l * (abs(metric->row[3 * i]) + abs(metric->row[3 * i + 1]) + abs(metric->row[3 * i + 2]));
    a[i] = max((long)abs(q) + side * slack, 0l);
  }
  return sherd_norm(metric->kind, a[0], a[1], a[2]);
}

// The seeds of a fracture, and what bounds their distances to the voxels of a leaf.
struct leaf_seeds {
  const global int4* seed;
  uint first, last;
  int4 low;            // lowest voxel of the leaf
  int4 doubledCenter;
  long bound;          // of the distance of any of its voxels to the nearest seed
};

inline int may_be_nearest(const struct sherd_metric* metric, const struct leaf_seeds* seeds, const uint s) {
  return leaf_bound(metric, seeds->doubledCenter, seeds->seed[s], -1) <= seeds->bound;
}

// Returns the only seed that may be nearest to a voxel of the leaf, `last` if there is not one.
inline uint only_seed(const struct sherd_metric* metric, const struct leaf_seeds* seeds) {
  uint only = seeds->last;
  for (uint s = seeds->first; s < seeds->last; ++s) {
    if (!may_be_nearest(metric, seeds, s)) continue;
    if (only != seeds->last) return seeds->last;
    only = s;
  }
  return only;
}

// Compares a seed with the nearest seed so far of each voxel of a leaf.
inline void compare_seed(const struct sherd_metric* metric, const int4 at, const int4 low, const ulong* mask,
                         long* best, ushort* label) {
  for (int row = 0; row < 64; ++row) {
    if (!((mask[row >> 3] >> (8 * (row & 7))) & 0xff)) continue;
    const int x = low.x + (row >> 3) - at.x, y = low.y + (row & 7) - at.y, z = low.z - at.z;
    const long a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z), c = sherd_row(metric, 2, x, y, z);
    for (int k = 0; k < 8; ++k) {  // the next voxel adds a column of the matrix
      const long d = sherd_norm(metric->kind, (long)abs(a + k * metric->row[2]), (long)abs(b + k * metric->row[5]),
                                (long)abs(c + k * metric->row[8]));
      const int v = 8 * row + k;
      if (d < best[v]) {  // strict: ties stay with the lower label
        best[v] = d;
        label[v] = (ushort)at.w;
      }
    }
  }
}

inline int is_set(const ulong* mask, const int v) { return (int)((mask[v >> 6] >> (v & 63)) & 1); }

kernel void nearest(
    const global ulong* restrict inside,      // [leafCount*8]
    const global int4* restrict origin,       // [leafCount]    lowest voxel, w unused
    const uint leafCount,
    const uint items,
    const global int4* restrict seed,         // [seeds]        voxel, w the label; ascending by label in a fracture
    const global uint* restrict firstSeed,    // [fractures+1]
    const struct sherd_metric metric,
    global ushort* restrict owner,            // [items*512]    out: 1.. inside, 0 outside
    global uint* restrict cost,               // [items*512]    out, when keepCost: distance >> metric.shift
    const uint keepCost)
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const uint leaf = (uint)(item % leafCount);
    ulong mask[SHERD_LEAF_WORDS];
    ulong any = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      mask[x] = inside[(size_t)leaf * SHERD_LEAF_WORDS + x];
      any |= mask[x];
    }
    global ushort* restrict owners = owner + item * SHERD_LEAF_SIZE;
    if (!any) {
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) owners[v] = 0;
      continue;
    }
    struct leaf_seeds seeds = {seed, firstSeed[item / leafCount], firstSeed[item / leafCount + 1], origin[leaf],
                               2 * origin[leaf] + 7, LONG_MAX};
    for (uint s = seeds.first; s < seeds.last; ++s) {
      seeds.bound = min(seeds.bound, leaf_bound(&metric, seeds.doubledCenter, seed[s], 1));
    }
    const uint only = only_seed(&metric, &seeds);  // inside a Voronoi cell
    if (only != seeds.last && !keepCost) {
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) owners[v] = is_set(mask, v) ? (ushort)seed[only].w : (ushort)0;
      continue;
    }
    long best[SHERD_LEAF_SIZE];
    ushort label[SHERD_LEAF_SIZE];
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      best[v] = LONG_MAX;
      label[v] = 0;
    }
    for (uint s = seeds.first; s < seeds.last; ++s) {
      if (may_be_nearest(&metric, &seeds, s)) compare_seed(&metric, seed[s], seeds.low, mask, best, label);
    }
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      owners[v] = is_set(mask, v) ? label[v] : (ushort)0;
      if (keepCost) cost[item * SHERD_LEAF_SIZE + v] = is_set(mask, v) ? (uint)(best[v] >> metric.shift) : 0u;
    }
  }
}
