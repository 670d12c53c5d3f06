// nearest: give every inside voxel the label of its nearest seed, across gaps too; ties go to the lower label.  A leaf
// first computes an upper bound of the distance of its voxels to their nearest seed, then tests only seeds whose lower
// bound does not exceed it.
//
// One work-item takes items i, i + all, ... (item = fracture * leafCount + leaf); any work-group size.
// Reference: tests/kernels/growths_test.cpp, bit for bit.

// All points are in steps of 1/64 voxel (SHERD_SEED_BITS).
#define NEAREST_VOXEL (1 << SHERD_SEED_BITS)

// Returns a lower (side -1) or upper (side 1) bound of the distance from any voxel of a leaf to a seed.  Per axis no
// voxel is farther than 3.5 from the center.
inline long leaf_bound(const struct sherd_metric* metric, const int4 center, const int4 seed, const int side) {
  const long x = center.x - seed.x, y = center.y - seed.y, z = center.z - seed.z;
  long a[3];
  for (int i = 0; i < 3; ++i) {
    const long q = sherd_row(metric, i, x, y, z);
    const long slack =
        7l * (NEAREST_VOXEL / 2) * (abs(metric->row[3 * i]) + abs(metric->row[3 * i + 1]) + abs(metric->row[3 * i + 2]));
    a[i] = max((long)abs(q) + side * slack, 0l);
  }
  return sherd_norm(metric->kind, a[0], a[1], a[2]);
}

// The seeds of a fracture, and what bounds their distances to the voxels of a leaf.
struct leaf_seeds {
  const global int4* seed;
  uint first, last;
  int4 low;            // lowest voxel of the leaf
  int4 center;         // of the leaf
  long bound;          // of the distance of any of its voxels to the nearest seed
};

inline int may_be_nearest(const struct sherd_metric* metric, const struct leaf_seeds* seeds, const uint s) {
  return leaf_bound(metric, seeds->center, seeds->seed[s], -1) <= seeds->bound;
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
  const long step[3] = {NEAREST_VOXEL * metric->row[2], NEAREST_VOXEL * metric->row[5],
                        NEAREST_VOXEL * metric->row[8]};  // a voxel along z: a column of the matrix
  for (int row = 0; row < 64; ++row) {
    if (!((mask[row >> 3] >> (8 * (row & 7))) & 0xff)) continue;
    const int x = NEAREST_VOXEL * (low.x + (row >> 3)) - at.x, y = NEAREST_VOXEL * (low.y + (row & 7)) - at.y,
              z = NEAREST_VOXEL * low.z - at.z;
    const long a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z), c = sherd_row(metric, 2, x, y, z);
    for (int k = 0; k < 8; ++k) {
      const long d = sherd_norm(metric->kind, (long)abs(a + k * step[0]), (long)abs(b + k * step[1]),
                                (long)abs(c + k * step[2]));
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
    const global int4* restrict origin,       // [leafCount]    lowest voxel as seen from the lowest leaf, w unused
    const uint leafCount,
    const uint items,
    const global int4* restrict seed,         // [seeds]        point, w the label; ascending by label in a fracture
    const global uint* restrict firstSeed,    // [fractures+1]
    const struct sherd_metric metric,
    global ushort* restrict owner,            // [items*512]    out: 1.. inside, 0 outside
    global uint* restrict cost,               // [items*512]    out, when keepCost: distance in voxels, squared if
                                              // Euclidean, >> metric.shift
    const uint keepCost)
{
  const int shift = metric.shift + (metric.kind == SHERD_EUCLIDEAN ? 2 : 1) * SHERD_SEED_BITS;
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
                               NEAREST_VOXEL * origin[leaf] + 7 * NEAREST_VOXEL / 2, LONG_MAX};
    for (uint s = seeds.first; s < seeds.last; ++s) {
      seeds.bound = min(seeds.bound, leaf_bound(&metric, seeds.center, seed[s], 1));
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
      if (keepCost) cost[item * SHERD_LEAF_SIZE + v] = is_set(mask, v) ? (uint)(best[v] >> shift) : 0u;
    }
  }
}
