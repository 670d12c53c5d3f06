// nearest: give every inside voxel the label of its nearest seed, across gaps too; ties go to the lower label.  A leaf
// first leaves out the seeds that are nearest to none of its voxels: of Euclidean distances those that are farther than
// another seed in the box of its inside voxels, else those whose lower bound exceeds the least upper bound.  Where the
// others have one label, or two, no label is written per voxel (leaf_labels.h).
//
// A weight is subtracted from the squared distance to its seed, so the cells of Euclidean distances are those of a power
// diagram: the difference of two distances stays linear.
//
// In thin walls Euclidean distances may be those of the middle of the wall at a voxel: then all voxels on a straight line
// through the wall have one label, and cracks pass straight through it.
//
// One work-item takes items i, i + all, ... (item = fracture * leafCount + leaf); any work-group size.
// Reference: tests/kernels/growths_test.cpp, bit for bit.
// Source: Aurenhammer, Power Diagrams: Properties, Algorithms and Applications, 1987.

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

// The seeds of a fracture, and what decides which of them may be nearest to a voxel of a leaf.  A voxel's point is its
// center, or the middle of its wall.
struct leaf_seeds {
  const global int4* seed;
  const global long* weight;
  uint first, last;
  int4 low;     // lowest voxel of the leaf
  int4 center;  // of the leaf; of Euclidean distances that of the box of its inside voxels' points
  int4 reach;   // from the center of that box to its corners, or more
  uint near;    // a seed near the center
  long bound;   // of the distance of any of its voxels to the nearest seed, unless Euclidean
};

// How much farther a point is from a seed than from another, squared: a linear function of the point.
struct farther {
  long there;    // at a point
  long slope[3]; // per step
};

// |M (p - s)|^2 - |M (p - n)|^2 = |a|^2 - 2 (M^T a) (p - n), where a = M (s - n).
//   lighter  by how much the weight of the other is greater
inline struct farther farther_than(const struct sherd_metric* metric, const int4 seed, const int4 other,
                                   const long lighter, const int4 point) {
  const long x = seed.x - other.x, y = seed.y - other.y, z = seed.z - other.z;
  struct farther f;
  f.slope[0] = -2 * x;
  f.slope[1] = -2 * y;
  f.slope[2] = -2 * z;
  f.there = x * x + y * y + z * z;
  if (metric->shift != 0) {  // else the matrix is the identity
    const long a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z), c = sherd_row(metric, 2, x, y, z);
    for (int j = 0; j < 3; ++j) {
      f.slope[j] = -2 * (metric->row[j] * a + metric->row[3 + j] * b + metric->row[6 + j] * c);
    }
    f.there = a * a + b * b + c * c;
  }
  f.there += lighter;
  f.there += f.slope[0] * (point.x - other.x) + f.slope[1] * (point.y - other.y) + f.slope[2] * (point.z - other.z);
  return f;
}

inline int may_be_nearest(const struct sherd_metric* metric, const struct leaf_seeds* seeds, const uint s) {
  if (metric->kind != SHERD_EUCLIDEAN) return leaf_bound(metric, seeds->center, seeds->seed[s], -1) <= seeds->bound;
  const struct farther f = farther_than(metric, seeds->seed[s], seeds->seed[seeds->near],
                                        seeds->weight[seeds->near] - seeds->weight[s], seeds->center);
  const long least = f.there - (long)abs(f.slope[0]) * seeds->reach.x - (long)abs(f.slope[1]) * seeds->reach.y -
                     (long)abs(f.slope[2]) * seeds->reach.z;
  return least < (s > seeds->near ? 0 : 1);  // ties go to the lower label
}

// Returns the box of a mask that is not empty, as its lowest and its highest voxel.
inline void mask_box(const ulong* mask, int4* low, int4* high) {
  ulong all = 0;
  int first = SHERD_LEAF_WORDS, last = 0;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    all |= mask[x];
    if (!mask[x]) continue;
    first = min(first, x);
    last = x;
  }
  ulong row = all | all >> 32;  // the union of the rows along z
  row |= row >> 16;
  row = (row | row >> 8) & 0xff;
  *low = (int4)(first, lowest_bit(all) >> 3, lowest_bit(row), 0);
  *high = (int4)(last, (63 - (int)clz(all)) >> 3, 63 - (int)clz(row), 0);
}

inline int is_set(const ulong* mask, const int v) { return (int)((mask[v >> 6] >> (v & 63)) & 1); }

// Returns a voxel of a leaf, moved to the middle of its wall.
//   way  [512*3] of the leaf
inline int4 middle_at(const int4 low, const int v, const global short* way) {
  const int4 voxel = low + (int4)(v >> 6, (v >> 3) & 7, v & 7, 0);
  return NEAREST_VOXEL * voxel + (int4)(way[3 * v], way[3 * v + 1], way[3 * v + 2], 0);
}

// Returns the box of the points of a leaf's voxels, as its lowest and its highest point.
inline void point_box(const ulong* mask, const int4 low, const global short* way, int4* lowest, int4* highest) {
  if (!way) {
    mask_box(mask, lowest, highest);
    *lowest = NEAREST_VOXEL * (low + *lowest);
    *highest = NEAREST_VOXEL * (low + *highest);
    return;
  }
  int is_first = 1;
  for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
    if (!is_set(mask, v)) continue;
    const int4 at = middle_at(low, v, way);
    *lowest = is_first ? at : min(*lowest, at);
    *highest = is_first ? at : max(*highest, at);
    is_first = 0;
  }
}

//   way  of the leaf, or null where points are centers
inline struct leaf_seeds seeds_of(const struct sherd_metric* metric, const global int4* seed,
                                  const global long* weight, const uint first, const uint last, const ulong* mask,
                                  const int4 origin, const global short* way) {
  const int4 middle = NEAREST_VOXEL * origin + 7 * NEAREST_VOXEL / 2;
  struct leaf_seeds seeds = {seed, weight, first, last, origin, middle, (int4)(0), first, LONG_MAX};
  if (metric->kind != SHERD_EUCLIDEAN) {
    for (uint s = first; s < last; ++s) seeds.bound = min(seeds.bound, leaf_bound(metric, seeds.center, seed[s], 1));
    return seeds;
  }
  int4 low, high;
  point_box(mask, origin, way, &low, &high);
  seeds.center = low + ((high - low) >> 1);
  seeds.reach = high - seeds.center;
  long nearest = LONG_MAX;
  for (uint s = first; s < last; ++s) {
    const int4 from = seeds.center - seed[s];
    const long d = (long)from.x * from.x + (long)from.y * from.y + (long)from.z * from.z - (weight[s] >> metric->shift);
    if (d < nearest) seeds.near = s;
    nearest = min(nearest, d);
  }
  return seeds;
}

// Compares a seed with the nearest seed so far of each voxel of a leaf.  Distances are relative to that of `near` if
// Euclidean.
inline void compare_seed(const struct sherd_metric* metric, const int4 at, const long weight, const int4 low,
                         const ulong* mask, long* best, ushort* label) {
  const long step[3] = {NEAREST_VOXEL * metric->row[2], NEAREST_VOXEL * metric->row[5],
                        NEAREST_VOXEL * metric->row[8]};  // a voxel along z: a column of the matrix
  for (int row = 0; row < 64; ++row) {
    if (!((mask[row >> 3] >> (8 * (row & 7))) & 0xff)) continue;
    const int x = NEAREST_VOXEL * (low.x + (row >> 3)) - at.x, y = NEAREST_VOXEL * (low.y + (row & 7)) - at.y,
              z = NEAREST_VOXEL * low.z - at.z;
    const long a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z), c = sherd_row(metric, 2, x, y, z);
    for (int k = 0; k < 8; ++k) {
      const long d = sherd_norm(metric->kind, (long)abs(a + k * step[0]), (long)abs(b + k * step[1]),
                                (long)abs(c + k * step[2])) -
                     weight;
      const int v = 8 * row + k;
      if (d < best[v]) {  // strict: ties stay with the lower label
        best[v] = d;
        label[v] = (ushort)at.w;
      }
    }
  }
}

// The same of Euclidean distances, relative to that of the seed `near`.
inline void compare_farther(const struct farther* f, const ushort own, const ulong* mask, long* best, ushort* label) {
  for (int row = 0; row < 64; ++row) {
    if (!((mask[row >> 3] >> (8 * (row & 7))) & 0xff)) continue;
    const long there = f->there + NEAREST_VOXEL * ((row >> 3) * f->slope[0] + (row & 7) * f->slope[1]);
    for (int k = 0; k < 8; ++k) {
      const long d = there + k * (NEAREST_VOXEL * f->slope[2]);
      const int v = 8 * row + k;
      if (d < best[v]) {
        best[v] = d;
        label[v] = own;
      }
    }
  }
}

// The same where points are the middles of walls: f is that of the leaf's lowest voxel.
inline void compare_middles(const struct farther* f, const ushort own, const ulong* mask, const global short* way,
                            long* best, ushort* label) {
  for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
    if (!is_set(mask, v)) continue;
    const int4 from = middle_at((int4)(0), v, way);
    const long d = f->there + f->slope[0] * from.x + f->slope[1] * from.y + f->slope[2] * from.z;
    if (d < best[v]) {
      best[v] = d;
      label[v] = own;
    }
  }
}

// The whole distance, as compare_seed, where points are the middles of walls.
inline void compare_seed_with_middles(const struct sherd_metric* metric, const int4 at, const long weight, const int4 low,
                                      const ulong* mask, const global short* way, long* best, ushort* label) {
  for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
    if (!is_set(mask, v)) continue;
    const int4 from = middle_at(low, v, way) - at;
    const long d = sherd_distance(metric, from.x, from.y, from.z) - weight;
    if (d < best[v]) {
      best[v] = d;
      label[v] = (ushort)at.w;
    }
  }
}

// Compares a seed of a leaf with the nearest so far, see compare_seed.
//   relative  distances to that of `near`; Euclidean ones only
inline void compare(const struct sherd_metric* metric, const struct leaf_seeds* seeds, const uint s, const int relative,
                    const ulong* mask, const global short* way, long* best, ushort* label) {
  const int4 at = seeds->seed[s];
  const long weight = seeds->weight[s];
  if (relative) {
    const struct farther f = farther_than(metric, at, seeds->seed[seeds->near], seeds->weight[seeds->near] - weight,
                                          NEAREST_VOXEL * seeds->low);
    if (way) {
      compare_middles(&f, (ushort)at.w, mask, way, best, label);
    } else {
      compare_farther(&f, (ushort)at.w, mask, best, label);
    }
  } else if (way) {
    compare_seed_with_middles(metric, at, weight, seeds->low, mask, way, best, label);
  } else {
    compare_seed(metric, at, weight, seeds->low, mask, best, label);
  }
}

// Copies a leaf's mask; returns the union of its words.
inline ulong load_mask(const global ulong* inside, ulong* mask) {
  ulong any = 0;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    mask[x] = inside[x];
    any |= mask[x];
  }
  return any;
}

kernel void nearest(
    const global ulong* restrict inside,      // [leafCount*8]
    const global int4* restrict origin,       // [leafCount]    lowest voxel as seen from the lowest leaf, w unused
    const uint leafCount,
    const uint items,
    const global int4* restrict seed,         // [seeds]        point, w the label; ascending by label in a fracture
    const global long* restrict weight,       // [seeds]        in the unit of Euclidean distances; 0 of others
    const global uint* restrict firstSeed,    // [fractures+1]
    const struct sherd_metric metric,
    const global short* restrict ways,        // [leafCount*512*3] to the middle of walls, 1/64 voxel; [1] where no fracture uses it
    const global uint* restrict usesWay,      // [fractures]    0, as with all metrics but the Euclidean: points are centers
    global ushort* restrict owner,            // [items*512]    out, see leaf_labels.h: 1.. inside, 0 outside
    global uint* restrict tag,                // [items]        out
    global ulong* restrict second,            // [items*3*8]    out
    global uint* restrict cost,               // [items*512]    out, when keepCost: distance in voxels, squared and
                                              // less the weight if Euclidean, >> metric.shift; at least 0
    const uint keepCost)
{
  const int shift = metric.shift + (metric.kind == SHERD_EUCLIDEAN ? 2 : 1) * SHERD_SEED_BITS;
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const uint leaf = (uint)(item % leafCount);
    ulong mask[SHERD_LEAF_WORDS];
    if (!load_mask(inside + (size_t)leaf * SHERD_LEAF_WORDS, mask)) {
      tag[item] = 0;
      continue;
    }
    const uint fracture = item / leafCount;
    const global short* way = usesWay[fracture] ? ways + (size_t)leaf * SHERD_LEAF_SIZE * 3 : 0;
    const struct leaf_seeds seeds =
        seeds_of(&metric, seed, weight, firstSeed[fracture], firstSeed[fracture + 1], mask, origin[leaf], way);
    uint labels = 0;  // of the seeds that may be nearest, as a tag
    for (uint s = seeds.first; s < seeds.last && labels != SHERD_TAG_MIXED; ++s) {
      if (may_be_nearest(&metric, &seeds, s)) labels = with_label(labels, (uint)seed[s].w);
    }
    if (labels <= 0xffff && !keepCost) {  // inside a Voronoi cell
      tag[item] = labels;
      continue;
    }
    long best[SHERD_LEAF_SIZE];
    ushort label[SHERD_LEAF_SIZE];
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      best[v] = LONG_MAX;
      label[v] = 0;
    }
    const int relative = metric.kind == SHERD_EUCLIDEAN && !keepCost;
    for (uint s = seeds.first; s < seeds.last; ++s) {
      if (may_be_nearest(&metric, &seeds, s)) compare(&metric, &seeds, s, relative, mask, way, best, label);
    }
    write_labels(mask, label, labels, (uint)item, owner, tag, second);
    for (int v = 0; keepCost && v < SHERD_LEAF_SIZE; ++v) {
      cost[item * SHERD_LEAF_SIZE + v] = is_set(mask, v) ? (uint)(max(best[v], 0l) >> shift) : 0u;
    }
  }
}
