// rough: roughen cracks.  Every inside voxel takes the label at the end of a walk of displacement D through the solid,
// so the two sides of a crack still fit exactly.
//
// D is a sum of octaves of value noise.  Octave k has a lattice with a spacing of S / 2^k, S the longest side of the
// mesh's box, and an amplitude proportional to spacing^H: a smooth crack becomes a self-affine surface of Hurst
// exponent H.  Along one axis, that of propagation, the spacing t may differ from the spacing s along the others: where
// s^H is proportional to t^P in all octaves, the exponent is P along this axis, and the smaller of s and t is S / 2^k.
// Lattices do not depend on the voxels, so D is a function of space; octaves with a spacing below 2 voxels are left
// out.  The walk takes one face step at a time and skips steps that leave the solid, so it slides along walls.  All
// arithmetic is on integers.  An anchor's displacement is subtracted, so that what is there stays: where an impact
// strikes its cracks meet.  Leaves too far from every crack for a walk to reach another label keep their labels.
// Sources: Bouchaud, Scaling properties of cracks, J. Phys. Condens. Matter 9, 1997; Ponson, Bonamy, Bouchaud,
// Two-dimensional scaling properties of experimental fracture surfaces, Phys. Rev. Lett. 96, 2006.
//
// One work-item takes items i, i + all, ... (item = fracture * leafCount + leaf); any work-group size.
// Reference: tests/kernels/rough_test.cpp, bit for bit.

// SplitMix64's finalizer, as in src/base/random.h.
inline ulong rough_mixed(ulong x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ul;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebul;
  return x ^ (x >> 31);
}

// Returns the values of a lattice point along x, y and z, 16 bits each.
inline ulong lattice_bits(const ulong seed, const int octave, const int i, const int j, const int k) {
  const ulong key = (ulong)(uint)(i & 0xffff) | (ulong)(uint)(j & 0xffff) << 16 | (ulong)(uint)(k & 0xffff) << 32 |
                    (ulong)(uint)(octave & 0xffff) << 48;
  return rough_mixed(seed ^ rough_mixed(key + 0x9e3779b97f4a7c15ul));
}

inline int lattice_value(const ulong bits, const int axis, const int amplitude) {
  const int value = (int)((bits >> (16 * axis)) & 0xffff) - 32768;
  return (int)(((long)value * amplitude) >> 15);
}

// Returns random bits for the shift of a lattice, 16 for each axis.  Unshifted lattices would all have a point, and so
// zero slope, at the low corner of the box.
inline ulong lattice_shift(const ulong seed, const int octave) {
  return rough_mixed(seed + ((ulong)(uint)(octave & 0xffff) << 48));
}

// Returns the coordinate of a voxel's center in the lattice, in units of 2^-32 spacings: the high word is the cell, the
// low word the position in it.
inline long in_lattice(const int voxel, const long step, const ulong shift, const int axis) {
  return voxel * step + (step >> 1) + (long)((shift >> (16 * axis)) & 0xffff) * 65536;
}

// Returns t^3 (6 t^2 - 15 t + 10) in units of 2^-31 (a multiple of 2^-24), for t in units of 2^-31.  Rounding is
// downwards, to below 1.
inline int8 smooth_weights(const int8 t) {
  const int8 t2 = mul_hi(t, t);                                              // 2^-30
  const int8 t3 = mul_hi(t2 << 1, t);                                        // 2^-30
  const int8 factor = 6 * (t2 >> 4) - 15 * ((t >> 5) + 1) + 10 * (1 << 26);  // 2^-26
  return mul_hi(t3, factor) << 7;
}

// Returns a + (b - a) * weight, rounded down, for a weight in units of 2^-31.
inline int4 blend4(const int4 a, const int4 b, const int4 weight) { return a + mul_hi((b - a) << 1, weight); }
inline int8 blend8(const int8 a, const int8 b, const int8 weight) { return a + mul_hi((b - a) << 1, weight); }

// A leaf meets at most 5 lattice cells along an axis, and their 6 points.
#define ROUGH_POINTS 6

// The voxels of a leaf along one axis of a lattice.
struct lattice_span {
  int low;        // the first cell
  int cells;      // number of cells
  int cell[8];    // of each voxel, from the first cell
  int weight[8];  // of each voxel
};

inline struct lattice_span span_of(const int voxel, const long step, const ulong shift, const int axis) {
  struct lattice_span span;
  long at = in_lattice(voxel, step, shift, axis);
  span.low = (int)(at >> 32);
  int t[8];
  for (int n = 0; n < 8; ++n) {
    span.cell[n] = (int)(at >> 32) - span.low;
    t[n] = (int)((uint)at >> 1);
    at += step;
  }
  span.cells = span.cell[7] + 1;
  vstore8(smooth_weights(vload8(0, t)), 0, span.weight);
  return span;
}

// Blends the lattice values `line` along z for a row of 8 voxels.
inline int8 blend_row(const int* line, const int cells, const int8 cell, const int8 weight) {
  int8 low = (int8)(line[0]), high = (int8)(line[1]);
  for (int k = 1; k < cells; ++k) {
    const int8 beyond = cell >= k;  // all bits where true
    low += (int8)(line[k] - line[k - 1]) & beyond;
    high += (int8)(line[k + 1] - line[k]) & beyond;
  }
  return blend8(low, high, weight);
}

// Adds an octave to a leaf's displacements, [axis*64 + x*8 + y] rows along z in 1/256 voxel.
inline void add_octave(const ulong seed, const struct sherd_octave octave, const int4 leafLow, int8* displacement) {
  const ulong shift = lattice_shift(seed, octave.number);
  const struct lattice_span alongX = span_of(leafLow.x, octave.step[0], shift, 0),
                            alongY = span_of(leafLow.y, octave.step[1], shift, 1),
                            alongZ = span_of(leafLow.z, octave.step[2], shift, 2);
  int lattice[3][ROUGH_POINTS * ROUGH_POINTS * ROUGH_POINTS];
  for (int i = 0; i <= alongX.cells; ++i) {
    for (int j = 0; j <= alongY.cells; ++j) {
      for (int k = 0; k <= alongZ.cells; ++k) {
        const ulong bits = lattice_bits(seed, octave.number, alongX.low + i, alongY.low + j, alongZ.low + k);
        for (int axis = 0; axis < 3; ++axis) {
          lattice[axis][(i * ROUGH_POINTS + j) * ROUGH_POINTS + k] = lattice_value(bits, axis, octave.amplitude);
        }
      }
    }
  }
  const int8 cellZ = vload8(0, alongZ.cell), weightZ = vload8(0, alongZ.weight);
  for (int axis = 0; axis < 3; ++axis) {
    int8 rows[ROUGH_POINTS * ROUGH_POINTS];
    for (int i = 0; i <= alongX.cells; ++i) {
      for (int j = 0; j <= alongY.cells; ++j) {
        const int row = i * ROUGH_POINTS + j;
        rows[row] = blend_row(lattice[axis] + row * ROUGH_POINTS, alongZ.cells, cellZ, weightZ);
      }
    }
    for (int x = 0; x < 8; ++x) {
      const int8* near = rows + alongX.cell[x] * ROUGH_POINTS;
      const int8 weightX = (int8)(alongX.weight[x]);
      int8 plane[ROUGH_POINTS];
      for (int j = 0; j <= alongY.cells; ++j) plane[j] = blend8(near[j], near[ROUGH_POINTS + j], weightX);
      for (int y = 0; y < 8; ++y) {
        const int8* row = plane + alongY.cell[y];
        displacement[axis * 64 + x * 8 + y] += blend8(row[0], row[1], (int8)(alongY.weight[y]));
      }
    }
  }
}

// The common label of voxels or leaves: 0 where they have none, ROUGH_SEVERAL where they differ.
#define ROUGH_SEVERAL 0xffffu

inline uint label_of_both(const uint a, const uint b) { return a == b || b == 0 ? a : a == 0 ? b : ROUGH_SEVERAL; }

kernel void rough_leaves(
    const global ulong* restrict inside,   // [leafCount*8]
    const uint leafCount,
    const uint items,
    LEAF_LABELS,                           // before
    global uint* restrict single,          // [items]      out: the leaf's common label
    global uint* restrict full)            // [items]      out: 1 where all voxels are inside
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    uint found = 0;
    ulong all = ~0ul;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong word = inside[(item % leafCount) * SHERD_LEAF_WORDS + x];
      all &= word;
      if (word != 0 && tag[item] != SHERD_TAG_MIXED) found = is_pair(tag[item]) ? ROUGH_SEVERAL : tag[item];
      for (int v = 0; word != 0 && tag[item] == SHERD_TAG_MIXED && v < 64; ++v) {
        if ((word >> v) & 1) found = label_of_both(found, owner[item * SHERD_LEAF_SIZE + x * 64 + v]);
      }
    }
    single[item] = found;
    full[item] = all == ~0ul ? 1 : 0;
  }
}

// Extends the common label of the leaves within `ring` leaves of each to ring + 1, and records how far there is one.
kernel void rough_rings(
    const global uint* restrict neighbors27,  // [leafCount*27]
    const uint leafCount,
    const uint items,
    const uint ring,
    const global uint* restrict single,       // [items]
    global uint* restrict wider,              // [items]  out
    global uint* restrict uniformRings)       // [items]  in, out: rings with at most one label, the leaf itself first
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t leaf = item % leafCount;
    uint found = single[item];
    if (found != ROUGH_SEVERAL) uniformRings[item] = ring + 1;
    for (int k = 0; k < 27; ++k) {
      const uint other = neighbors27[leaf * 27 + k];
      if (other != SHERD_NO_LEAF) found = label_of_both(found, single[item - leaf + other]);
    }
    wider[item] = found;
  }
}

// Returns how many leaves away a walk can end for displacements in least..most (1/256 voxel).
inline int leaves_away(const int least, const int most) { return (max(-(least >> 8), most >> 8) + 7) / 8; }

inline int least_of(const int4 v) { return min(min(v.x, v.y), min(v.z, v.w)); }
inline int most_of(const int4 v) { return max(max(v.x, v.y), max(v.z, v.w)); }

// The least and the greatest displacement of a leaf's voxels along each axis, 1/256 voxel.
struct displacement_bounds {
  int least[3], most[3];
};

// Narrows bounds that include an octave by its amplitude to its range in the leaf.  Within a lattice cell the octave is
// monotone along each axis, so its extremes are at the ends of the leaf or at the lattice points between.
inline void narrow_bounds(const ulong seed, const struct sherd_octave octave, const int4 leafLow,
                          struct displacement_bounds* bounds) {
  // The leaf may span more than two cells: their range is nearly the amplitude.
  if (7 * max(octave.step[0], max(octave.step[1], octave.step[2])) > (1l << 32)) return;
  const ulong shift = lattice_shift(seed, octave.number);
  const int voxel[3] = {leafLow.x, leafLow.y, leafLow.z};
  int low[3], cells[3], t[8] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const long step = octave.step[axis];
    const long first = in_lattice(voxel[axis], step, shift, axis), last = first + 7 * step;
    low[axis] = (int)(first >> 32);
    cells[axis] = (int)(last >> 32) - low[axis] + 1;
    t[axis] = (int)((uint)first >> 1);
    t[4 + axis] = (int)((uint)last >> 1);
  }
  int end[8];
  vstore8(smooth_weights(vload8(0, t)), 0, end);
  // Points along an axis: the first voxel, the lattice point between two cells, the last voxel.
  const int weightX[3] = {end[0], cells[0] == 1 ? end[4] : 0, end[4]};
  const int weightY[3] = {end[1], cells[1] == 1 ? end[5] : 0, end[5]};
  const int4 weightZ = (int4)(end[2], cells[2] == 1 ? end[6] : 0, end[6], end[6]);
  int lattice[3][3 * 3 * 3];
  for (int i = 0; i <= cells[0]; ++i) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int k = 0; k <= cells[2]; ++k) {
        const ulong bits = lattice_bits(seed, octave.number, low[0] + i, low[1] + j, low[2] + k);
        for (int axis = 0; axis < 3; ++axis) {
          lattice[axis][(i * 3 + j) * 3 + k] = lattice_value(bits, axis, octave.amplitude);
        }
      }
    }
  }
  // Blends round down by less than 3 together; weights decrease by at most 6 * 2^-24 where they should rise.
  const int rounding = 4 + (octave.amplitude >> 18);
  const int lastZ = cells[2];
  for (int axis = 0; axis < 3; ++axis) {
    int4 rows[3 * 3];
    for (int i = 0; i <= cells[0]; ++i) {
      for (int j = 0; j <= cells[1]; ++j) {
        const int* line = lattice[axis] + (i * 3 + j) * 3;
        const int4 near = (int4)(line[0], line[lastZ - 1], line[lastZ - 1], line[lastZ - 1]);
        rows[i * 3 + j] = blend4(near, (int4)(line[1], line[lastZ], line[lastZ], line[lastZ]), weightZ);
      }
    }
    int4 least = (int4)(octave.amplitude), most = (int4)(-octave.amplitude);
    for (int x = 0; x <= cells[0]; ++x) {
      const int4* near = rows + (x == 0 ? 0 : cells[0] - 1) * 3;
      int4 plane[3];
      for (int j = 0; j <= cells[1]; ++j) plane[j] = blend4(near[j], near[3 + j], (int4)(weightX[x]));
      for (int y = 0; y <= cells[1]; ++y) {
        const int4* row = plane + (y == 0 ? 0 : cells[1] - 1);
        const int4 value = blend4(row[0], row[1], (int4)(weightY[y]));
        least = min(least, value);
        most = max(most, value);
      }
    }
    bounds->least[axis] += octave.amplitude + least_of(least) - rounding;
    bounds->most[axis] -= octave.amplitude - most_of(most) - rounding;
  }
}

// Returns whether every walk from a leaf ends less than `rings` leaves away, as far as bounds of the octaves show.
inline bool walks_end_within(const int rings, const ulong seed, const global struct sherd_octave* restrict octave,
                             const uint octaves, const int4 leafLow, const int4 anchor) {
  const int away[3] = {anchor.x, anchor.y, anchor.z};
  int sum = 0;
  for (uint n = 0; n < octaves; ++n) sum += octave[n].amplitude;
  struct displacement_bounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    bounds.least[axis] = 128 - sum - away[axis];  // 128 rounds to the nearest voxel
    bounds.most[axis] = 128 + sum - away[axis];
  }
  for (uint n = 0; n <= octaves; ++n) {
    int most = 0;
    for (int axis = 0; axis < 3; ++axis) most = max(most, leaves_away(bounds.least[axis], bounds.most[axis]));
    if (rings > most) return true;
    if (n == octaves) break;
    narrow_bounds(seed, octave[n], leafLow, &bounds);
  }
  return false;
}

// Returns the voxel, leaf*512 + offset, where a walk of displacement `way` ends.  `from` is an offset in `leaf`.
inline size_t walk_end(const global ulong* restrict inside, const global uint* restrict neighbor, const uint leaf,
                       const int from, const int* way) {
  int steps[3], passed[3] = {0, 0, 0}, most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    steps[axis] = (int)abs(way[axis]);
    most = max(most, steps[axis]);
  }
  uint atLeaf = leaf;
  int at = from;
  for (int i = 0; i < most; ++i) {
    for (int axis = 0; axis < 3; ++axis) {  // the steps of an axis are spaced evenly among `most`
      passed[axis] += steps[axis];
      if (passed[axis] < most) continue;
      passed[axis] -= most;
      const int up = way[axis] > 0 ? 1 : 0;
      const int shift = 6 - 3 * axis;
      const int next = ((at >> shift) & 7) + 2 * up - 1;
      uint nextLeaf = atLeaf;
      if (next & ~7) nextLeaf = neighbor[(size_t)atLeaf * SHERD_LEAF_FACES + 2 * axis + up];
      if (nextLeaf == SHERD_NO_LEAF) continue;
      const int nextAt = (at & ~(7 << shift)) | ((next & 7) << shift);
      if (!((inside[(size_t)nextLeaf * SHERD_LEAF_WORDS + (nextAt >> 6)] >> (nextAt & 63)) & 1)) continue;
      atLeaf = nextLeaf;
      at = nextAt;
    }
  }
  return (size_t)atLeaf * SHERD_LEAF_SIZE + at;
}

// Returns the leaf i, j, k leaves away if all voxels of all leaves in the box between are inside, else SHERD_NO_LEAF.
inline uint leaf_straight_away(const global uint* restrict neighbors27, const global uint* restrict full,
                               const uint leaf, const int i, const int j, const int k) {
  const int stepI = i < 0 ? 4 : 22, stepJ = j < 0 ? 10 : 16, stepK = k < 0 ? 12 : 14;
  uint alongX = leaf, alongY = leaf, alongZ = leaf;
  for (int a = 0; a <= (int)abs(i); ++a) {
    alongY = alongX;
    for (int b = 0; b <= (int)abs(j); ++b) {
      alongZ = alongY;
      for (int c = 0; c <= (int)abs(k); ++c) {
        if (!full[alongZ]) return SHERD_NO_LEAF;
        if (c < (int)abs(k)) alongZ = neighbors27[(size_t)alongZ * 27 + stepK];
        if (alongZ == SHERD_NO_LEAF) return SHERD_NO_LEAF;
      }
      if (b < (int)abs(j)) alongY = neighbors27[(size_t)alongY * 27 + stepJ];
      if (alongY == SHERD_NO_LEAF) return SHERD_NO_LEAF;
    }
    if (a < (int)abs(i)) alongX = neighbors27[(size_t)alongX * 27 + stepI];
    if (alongX == SHERD_NO_LEAF) return SHERD_NO_LEAF;
  }
  return alongZ;
}

// Writes the labels of a leaf that has no walk to another label.
inline void keep_labels(const global ulong* restrict inside, const struct leaf_labels* before, const size_t leaf,
                        const size_t item, global ushort* restrict after) {
  for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
    const bool isInside = (inside[leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1;
    after[item * SHERD_LEAF_SIZE + v] = isInside ? (ushort)label_of(before, item, v) : 0;
  }
}

// Returns the displacements of a leaf, [axis*64 + x*8 + y] rows along z in 1/256 voxel, beside `start`.
inline void displacements_of(const ulong seed, const global struct sherd_octave* restrict octave, const uint octaves,
                             const int4 leafLow, const int4 start, int8* displacement) {
  for (int row = 0; row < 64; ++row) {
    displacement[row] = (int8)(start.x);
    displacement[64 + row] = (int8)(start.y);
    displacement[2 * 64 + row] = (int8)(start.z);
  }
  for (uint n = 0; n < octaves; ++n) add_octave(seed, octave[n], leafLow, displacement);
}

// Finds the displacements at some voxels.
kernel void rough_at(
    const global int4* restrict voxel,                  // [fractures]   w: 0 where there is none
    const uint fractures,
    const global ulong* restrict noiseSeed,             // [fractures]
    const global struct sherd_octave* restrict octave,  // [octaves]
    const uint octaves,
    global int4* restrict found)                        // [fractures]   out: 1/256 voxel, w unused
{
  for (size_t i = get_global_id(0); i < fractures; i += get_global_size(0)) {
    const int4 at = voxel[i];
    int8 displacement[3 * 64];
    displacements_of(noiseSeed[i], octave, at.w != 0 ? octaves : 0, (int4)(at.x & ~7, at.y & ~7, at.z & ~7, 0),
                     (int4)(0), displacement);
    int along[3][8];
    for (int axis = 0; axis < 3; ++axis) {
      vstore8(displacement[axis * 64 + (at.x & 7) * 8 + (at.y & 7)], 0, along[axis]);
    }
    found[i] = (int4)(along[0][at.z & 7], along[1][at.z & 7], along[2][at.z & 7], 0);
  }
}

kernel void rough(
    const global ulong* restrict inside,                // [leafCount*8]
    const global uint* restrict neighbor,               // [leafCount*6]
    const global uint* restrict neighbors27,            // [leafCount*27]
    const global int4* restrict origin,                 // [leafCount]   lowest voxel, w unused
    const uint leafCount,
    const uint items,
    const global ulong* restrict noiseSeed,             // [fractures]
    const global struct sherd_octave* restrict octave,  // [octaves]
    const uint octaves,
    const global int4* restrict anchor,                 // [fractures]   1/256 voxel, subtracted from displacements
    const global uint* restrict uniformRings,           // [items]       from rough_rings
    const global uint* restrict full,                   // [items]       from rough_leaves
    LEAF_LABELS,                                        // before
    global ushort* restrict after)                      // [items*512]   out
{
  const struct leaf_labels before = {owner, tag, second};
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const uint leaf = (uint)(item % leafCount);
    const ulong seed = noiseSeed[item / leafCount];
    const int4 away = anchor[item / leafCount];
    if (walks_end_within((int)uniformRings[item], seed, octave, octaves, origin[leaf], away)) {
      keep_labels(inside, &before, leaf, item, after);
      continue;
    }
    int8 displacement[3 * 64];
    displacements_of(seed, octave, octaves, origin[leaf], (int4)(128) - away,
                     displacement);  // 128 rounds to the nearest voxel
    int4 last = (int4)(0);  // leaves away of the previous voxel: neighbors mostly end in the same leaf
    uint end = leaf_straight_away(neighbors27, full + (item - leaf), leaf, 0, 0, 0);
    for (int row = 0; row < 64; ++row) {
      int ways[3][8];
      for (int axis = 0; axis < 3; ++axis) vstore8(displacement[axis * 64 + row] >> 8, 0, ways[axis]);
      for (int z = 0; z < 8; ++z) {
        const int v = row * 8 + z;
        const int way[3] = {ways[0][z], ways[1][z], ways[2][z]};
        const int x = (v >> 6) + way[0], y = ((v >> 3) & 7) + way[1], to = (v & 7) + way[2];
        const int4 leaves = (int4)(x >> 3, y >> 3, to >> 3, 0);
        if (any(leaves != last)) {
          end = leaf_straight_away(neighbors27, full + (item - leaf), leaf, leaves.x, leaves.y, leaves.z);
          last = leaves;
        }
        ushort label = 0;
        if (end != SHERD_NO_LEAF) {  // only inside voxels between
          label = (ushort)label_of(&before, item - leaf + end, ((x & 7) << 6) | ((y & 7) << 3) | (to & 7));
        } else if ((inside[(size_t)leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1) {
          const size_t at = walk_end(inside, neighbor, leaf, v, way);
          label = (ushort)label_of(&before, item - leaf + at / SHERD_LEAF_SIZE, (int)(at % SHERD_LEAF_SIZE));
        }
        after[item * SHERD_LEAF_SIZE + v] = label;
      }
    }
  }
}

// Restores the labels of the seeds, so that no fragment disappears.
kernel void rough_pin(
    const global uint* restrict seedItem,      // [seeds]
    const global ushort* restrict seedOffset,  // [seeds]
    const global ushort* restrict seedLabel,   // [seeds]
    const uint seeds,
    global ushort* restrict label)             // [items*512]  in, out
{
  for (size_t i = get_global_id(0); i < seeds; i += get_global_size(0)) {
    label[(size_t)seedItem[i] * SHERD_LEAF_SIZE + seedOffset[i]] = seedLabel[i];
  }
}
