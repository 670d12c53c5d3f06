// rough: roughen cracks.  Every inside voxel takes the label at the end of a walk of displacement D through the solid,
// so the two sides of a crack still fit exactly.
//
// D is a sum of octaves of value noise on lattices of 2, 4, 8, ... voxels with amplitudes proportional to spacing^H: a
// smooth crack becomes a self-affine surface of Hurst exponent H.  The walk takes one face step at a time and skips
// steps that leave the solid, so it slides along walls.  All arithmetic is on integers.  Leaves too far from every
// crack for a walk to reach another label keep their labels.
// Source: Bouchaud, Scaling properties of cracks, J. Phys. Condens. Matter 9, 1997.
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
                    (ulong)(uint)octave << 48;
  return rough_mixed(seed ^ rough_mixed(key + 0x9e3779b97f4a7c15ul));
}

inline int lattice_value(const ulong bits, const int axis, const int amplitude) {
  const int value = (int)((bits >> (16 * axis)) & 0xffff) - 32768;
  return (int)(((long)value * amplitude) >> 15);
}

// Returns the lowest voxel of a leaf in an octave's lattice.  Lattices wider than a leaf are shifted by a random number
// of leaves: unshifted ones would all have a lattice point, and so zero slope, at the origin.
inline int4 shifted_low(const ulong seed, const int octave, const int4 low) {
  if (octave < 3) return low;
  const ulong bits = rough_mixed(seed + ((ulong)(uint)octave << 48));
  const int leaves = (2 << octave) >> 3;
  return low + (int4)((int)(bits & 0xffff) & (leaves - 1), (int)((bits >> 16) & 0xffff) & (leaves - 1),
                      (int)((bits >> 32) & 0xffff) & (leaves - 1), 0) * 8;
}

// Returns t^3 (6 t^2 - 15 t + 10) for t = offset / 2^log2Spacing, in units of 1/32768.
inline int smooth_weight(const int offset, const int log2Spacing) {
  const long t = (long)offset << (15 - log2Spacing);
  const long t2 = (t * t) >> 15;
  const long t3 = (t2 * t) >> 15;
  return (int)((t3 * (6 * t2 - 15 * t + 10 * 32768)) >> 15);
}

// Returns a + (b - a) * w / 32768, rounded down, for weight = w * 65536: mul_hi divides the product by 2^32.
inline int blend(const int a, const int b, const int weight) { return a + mul_hi((b - a) << 1, weight); }
inline int8 blend8(const int8 a, const int8 b, const int8 weight) { return a + mul_hi((b - a) << 1, weight); }

// Blends the lattice values `line` along z for a row of 8 voxels.
inline int8 blend_row(const int* line, const int log2Spacing, const int8 weight) {
  if (log2Spacing >= 3) return blend8((int8)(line[0]), (int8)(line[1]), weight);
  if (log2Spacing == 2) {
    const int4 a = (int4)(line[0]), b = (int4)(line[1]), c = (int4)(line[2]);
    return blend8((int8)(a, b), (int8)(b, c), weight);
  }
  const int2 a = (int2)(line[0]), b = (int2)(line[1]), c = (int2)(line[2]), d = (int2)(line[3]), e = (int2)(line[4]);
  return blend8((int8)(a, b, c, d), (int8)(b, c, d, e), weight);
}

// Adds an octave to a leaf's displacements, [axis*64 + x*8 + y] rows along z in 1/256 voxel.  A leaf spans at most 5
// lattice points per axis.
inline void add_octave(const ulong seed, const int octave, const int amplitude, const int4 leafLow,
                       int8* displacement) {
  const int log2Spacing = octave + 1, spacing = 1 << log2Spacing;
  const int side = log2Spacing >= 3 ? 2 : (8 >> log2Spacing) + 1;
  const int4 low = shifted_low(seed, octave, leafLow);
  const int i0 = low.x >> log2Spacing, j0 = low.y >> log2Spacing, k0 = low.z >> log2Spacing;
  int lattice[3][5 * 5 * 5];
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        const ulong bits = lattice_bits(seed, octave, i0 + i, j0 + j, k0 + k);
        for (int axis = 0; axis < 3; ++axis) {
          lattice[axis][(i * 5 + j) * 5 + k] = lattice_value(bits, axis, amplitude);
        }
      }
    }
  }
  int weightX[8], weightY[8], rowWeight[8];
  for (int n = 0; n < 8; ++n) {
    weightX[n] = smooth_weight((low.x + n) & (spacing - 1), log2Spacing) << 16;
    weightY[n] = smooth_weight((low.y + n) & (spacing - 1), log2Spacing) << 16;
    rowWeight[n] = smooth_weight((low.z + n) & (spacing - 1), log2Spacing) << 16;
  }
  const int8 weightZ = vload8(0, rowWeight);
  for (int axis = 0; axis < 3; ++axis) {
    for (int x = 0; x < 8; ++x) {
      const int* near = lattice[axis] + (((low.x + x) >> log2Spacing) - i0) * 25;
      int plane[5 * 5];
      for (int j = 0; j < side; ++j) {
        for (int k = 0; k < side; ++k) {
          plane[j * 5 + k] = blend(near[j * 5 + k], near[25 + j * 5 + k], weightX[x]);
        }
      }
      for (int y = 0; y < 8; ++y) {
        const int* row = plane + (((low.y + y) >> log2Spacing) - j0) * 5;
        int line[5];
        for (int k = 0; k < side; ++k) line[k] = blend(row[k], row[5 + k], weightY[y]);
        displacement[axis * 64 + x * 8 + y] += blend_row(line, log2Spacing, weightZ);
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
    const global ushort* restrict before,  // [items*512]  labels
    global uint* restrict single,          // [items]      out: the leaf's common label
    global uint* restrict full)            // [items]      out: 1 where all voxels are inside
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    uint found = 0;
    ulong all = ~0ul;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong word = inside[(item % leafCount) * SHERD_LEAF_WORDS + x];
      all &= word;
      for (int v = 0; word != 0 && v < 64; ++v) {
        if ((word >> v) & 1) found = label_of_both(found, before[item * SHERD_LEAF_SIZE + x * 64 + v]);
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

inline int least_of(const int8 v) {
  const int4 a = min(v.lo, v.hi);
  return min(min(a.x, a.y), min(a.z, a.w));
}
inline int most_of(const int8 v) {
  const int4 a = max(v.lo, v.hi);
  return max(max(a.x, a.y), max(a.z, a.w));
}

// Returns how many leaves away a walk can end for displacements in least..most (1/256 voxel).
inline int leaves_away(const int least, const int most) { return (max(-(least >> 8), most >> 8) + 7) / 8; }

// Returns an upper bound of the same from the octaves' values at the corners of the leaf; between the corners an octave
// is monotone along each axis.
inline int leaves_away_at_most(const ulong seed, const global int* restrict amplitude, const int octaves,
                               const int4 leafLow) {
  int least[3] = {128, 128, 128}, most[3] = {128, 128, 128};  // 128 rounds to the nearest voxel
  for (int octave = 0; octave < octaves; ++octave) {
    const int log2Spacing = octave + 1, spacing = 1 << log2Spacing;
    if (log2Spacing < 3) {  // the leaf spans several lattice cells
      for (int axis = 0; axis < 3; ++axis) {
        least[axis] -= amplitude[octave];
        most[axis] += amplitude[octave];
      }
      continue;
    }
    const int4 low = shifted_low(seed, octave, leafLow);
    ulong bits[8];
    for (int corner = 0; corner < 8; ++corner) {
      bits[corner] = lattice_bits(seed, octave, (low.x >> log2Spacing) + (corner >> 2),
                                  (low.y >> log2Spacing) + ((corner >> 1) & 1), (low.z >> log2Spacing) + (corner & 1));
    }
    int first[3], last[3];  // weights at the ends of the leaf along x, y, z
    const int offset[3] = {low.x & (spacing - 1), low.y & (spacing - 1), low.z & (spacing - 1)};
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = smooth_weight(offset[axis], log2Spacing) << 16;
      last[axis] = smooth_weight(offset[axis] + 7, log2Spacing) << 16;
    }
    const int8 weightX = (int8)((int4)(first[0]), (int4)(last[0]));
    const int8 weightY = (int8)((int2)(first[1]), (int2)(last[1]), (int2)(first[1]), (int2)(last[1]));
    const int8 weightZ = (int8)(first[2], last[2], first[2], last[2], first[2], last[2], first[2], last[2]);
    for (int axis = 0; axis < 3; ++axis) {
      int8 along[4];
      for (int n = 0; n < 4; ++n) {
        along[n] = blend8((int8)(lattice_value(bits[n], axis, amplitude[octave])),
                          (int8)(lattice_value(bits[n + 4], axis, amplitude[octave])), weightX);
      }
      const int8 value =
          blend8(blend8(along[0], along[2], weightY), blend8(along[1], along[3], weightY), weightZ);
      least[axis] += least_of(value) - 3;  // three blends round down
      most[axis] += most_of(value) + 3;
    }
  }
  return max(max(leaves_away(least[0], most[0]), leaves_away(least[1], most[1])), leaves_away(least[2], most[2]));
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

kernel void rough(
    const global ulong* restrict inside,      // [leafCount*8]
    const global uint* restrict neighbor,     // [leafCount*6]
    const global uint* restrict neighbors27,  // [leafCount*27]
    const global int4* restrict origin,       // [leafCount]   lowest voxel, w unused
    const uint leafCount,
    const uint items,
    const global ulong* restrict noiseSeed,   // [fractures]
    const global int* restrict amplitude,     // [octaves]     1/256 voxel, the largest lattice value
    const int octaves,
    const global uint* restrict uniformRings,  // [items]      from rough_rings
    const global uint* restrict full,         // [items]       from rough_leaves
    const global ushort* restrict before,     // [items*512]   labels
    global ushort* restrict after)            // [items*512]   out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const uint leaf = (uint)(item % leafCount);
    const size_t base = (item - leaf) * SHERD_LEAF_SIZE;
    const ulong seed = noiseSeed[item / leafCount];
    if ((int)uniformRings[item] > leaves_away_at_most(seed, amplitude, octaves, origin[leaf])) {  // only one label
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
        const bool isInside = (inside[(size_t)leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1;
        after[item * SHERD_LEAF_SIZE + v] = isInside ? before[item * SHERD_LEAF_SIZE + v] : 0;
      }
      continue;
    }
    int8 displacement[3 * 64];
    for (int row = 0; row < 3 * 64; ++row) displacement[row] = (int8)(128);  // half a voxel: rounds to the nearest
    for (int octave = 0; octave < octaves; ++octave) {
      add_octave(seed, octave, amplitude[octave], origin[leaf], displacement);
    }
    int4 last = (int4)(0);  // leaves away of the previous voxel: neighbors mostly end in the same leaf
    uint end = leaf_straight_away(neighbors27, full + (item - leaf), leaf, 0, 0, 0);
    for (int row = 0; row < 64; ++row) {
      int ways[3][8];
      for (int axis = 0; axis < 3; ++axis) vstore8(displacement[axis * 64 + row] >> 8, 0, ways[axis]);
      for (int z = 0; z < 8; ++z) {
        const int v = row * 8 + z;
        const int way[3] = {ways[0][z], ways[1][z], ways[2][z]};
        const int x = (v >> 6) + way[0], y = ((v >> 3) & 7) + way[1], to = (v & 7) + way[2];
        const int4 away = (int4)(x >> 3, y >> 3, to >> 3, 0);
        if (any(away != last)) {
          end = leaf_straight_away(neighbors27, full + (item - leaf), leaf, away.x, away.y, away.z);
          last = away;
        }
        ushort label = 0;
        if (end != SHERD_NO_LEAF) {  // only inside voxels between
          label = before[base + (size_t)end * SHERD_LEAF_SIZE + (((x & 7) << 6) | ((y & 7) << 3) | (to & 7))];
        } else if ((inside[(size_t)leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1) {
          label = before[base + walk_end(inside, neighbor, leaf, v, way)];
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
