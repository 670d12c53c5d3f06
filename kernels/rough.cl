// rough: let cracks wander.  Every inside voxel takes the label found at the end of a walk of displacement D through
// the solid, so that the two sides of a crack still fit exactly.
//
// D is a sum of octaves of value noise on lattices of 2, 4, 8, ... voxels, whose amplitudes grow as spacing^H: on a
// crack that was smooth it is a self-affine relief of Hurst exponent H.  The walk takes one face step at a time and
// leaves out those that would leave the solid, so that it slides along walls.  Everything is integers.
// Source of the relief: Bouchaud, Scaling properties of cracks, J. Phys. Condens. Matter 9, 1997.
//
// One work-item takes items i, i + all, ... (item = fracture * leafCount + leaf); any work-group size.
// Reference: tests/kernels/rough_test.cpp, bit for bit.

// SplitMix64's finalizer, as in src/random.h.
inline ulong rough_mixed(ulong x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ul;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebul;
  return x ^ (x >> 31);
}

// A lattice point's values along x, y and z: three times 16 bits.
inline ulong lattice_bits(const ulong seed, const int octave, const int i, const int j, const int k) {
  const ulong place = (ulong)(uint)(i & 0xffff) | (ulong)(uint)(j & 0xffff) << 16 | (ulong)(uint)(k & 0xffff) << 32 |
                      (ulong)(uint)octave << 48;
  return rough_mixed(seed ^ rough_mixed(place + 0x9e3779b97f4a7c15ul));
}

// t^3 (6 t^2 - 15 t + 10) for t = at / 2^log2Spacing, out of 32768.
inline int smooth_weight(const int at, const int log2Spacing) {
  const long t = (long)at << (15 - log2Spacing);
  const long t2 = (t * t) >> 15;
  const long t3 = (t2 * t) >> 15;
  return (int)((t3 * (6 * t2 - 15 * t + 10 * 32768)) >> 15);
}

inline int blend(const int a, const int b, const int weight) { return a + (((b - a) * weight) >> 15); }

// Add one octave of one axis to a leaf's displacements (1/256 voxel).  A leaf meets at most 5 lattice points an axis.
inline void add_octave(const ulong seed, const int octave, const int axis, const int amplitude, const int4 low,
                       int* displacement) {
  const int log2Spacing = octave + 1, spacing = 1 << log2Spacing;
  const int side = log2Spacing >= 3 ? 2 : (8 >> log2Spacing) + 1;
  const int i0 = low.x >> log2Spacing, j0 = low.y >> log2Spacing, k0 = low.z >> log2Spacing;
  int lattice[5 * 5 * 5];
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        const ulong bits = lattice_bits(seed, octave, i0 + i, j0 + j, k0 + k);
        lattice[(i * 5 + j) * 5 + k] = (int)((bits >> (16 * axis)) & 0xffff) - 32768;
      }
    }
  }
  int weightY[8], weightZ[8];
  for (int n = 0; n < 8; ++n) {
    weightY[n] = smooth_weight((low.y + n) & (spacing - 1), log2Spacing);
    weightZ[n] = smooth_weight((low.z + n) & (spacing - 1), log2Spacing);
  }
  for (int x = 0; x < 8; ++x) {
    const int weightX = smooth_weight((low.x + x) & (spacing - 1), log2Spacing);
    const int i = ((low.x + x) >> log2Spacing) - i0;
    int plane[5 * 5];
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        plane[j * 5 + k] = blend(lattice[(i * 5 + j) * 5 + k], lattice[((i + 1) * 5 + j) * 5 + k], weightX);
      }
    }
    for (int y = 0; y < 8; ++y) {
      const int j = ((low.y + y) >> log2Spacing) - j0;
      int line[5];
      for (int k = 0; k < side; ++k) line[k] = blend(plane[j * 5 + k], plane[(j + 1) * 5 + k], weightY[y]);
      for (int z = 0; z < 8; ++z) {
        const int k = ((low.z + z) >> log2Spacing) - k0;
        const int value = blend(line[k], line[k + 1], weightZ[z]);
        displacement[(x << 6) | (y << 3) | z] += (int)(((long)value * amplitude) >> 15);
      }
    }
  }
}

kernel void rough(
    const global ulong* restrict inside,      // [leafCount*8]
    const global uint* restrict neighbour,    // [leafCount*6]
    const global int4* restrict origin,       // [leafCount]   lowest voxel, w unused
    const uint leafCount,
    const uint items,
    const global ulong* restrict noiseSeed,   // [fractures]
    const global int* restrict amplitude,     // [octaves]     1/256 voxels at the lattice's extremes
    const int octaves,
    const global ushort* restrict before,     // [items*512]   labels
    global ushort* restrict after)            // [items*512]   out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const uint leaf = (uint)(item % leafCount);
    const size_t base = item - leaf;
    ulong any = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) any |= inside[(size_t)leaf * SHERD_LEAF_WORDS + x];
    if (!any) {
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) after[item * SHERD_LEAF_SIZE + v] = 0;
      continue;
    }
    int displacement[3][SHERD_LEAF_SIZE];
    for (int axis = 0; axis < 3; ++axis) {
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) displacement[axis][v] = 0;
      for (int octave = 0; octave < octaves; ++octave) {
        add_octave(noiseSeed[item / leafCount], octave, axis, amplitude[octave], origin[leaf], displacement[axis]);
      }
    }
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      ushort label = 0;
      if ((inside[(size_t)leaf * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1) {
        int way[3], direction[3], most = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const int whole = (displacement[axis][v] + 128) >> 8;
          way[axis] = abs(whole);
          direction[axis] = whole < 0 ? 0 : 1;
          most = max(most, way[axis]);
        }
        uint atLeaf = leaf;
        int at = v;
        for (int i = 0; i < most; ++i) {
          for (int axis = 0; axis < 3; ++axis) {  // `way` steps of each axis, evenly among `most`
            if ((i + 1) * way[axis] / most == i * way[axis] / most) continue;
            const int shift = 6 - 3 * axis;
            const int place = (at >> shift) & 7;
            const int next = place + (direction[axis] ? 1 : -1);
            uint nextLeaf = atLeaf;
            if (next & ~7) nextLeaf = neighbour[(size_t)atLeaf * SHERD_LEAF_FACES + 2 * axis + direction[axis]];
            if (nextLeaf == SHERD_NO_LEAF) continue;
            const int nextAt = (at & ~(7 << shift)) | ((next & 7) << shift);
            if (!((inside[(size_t)nextLeaf * SHERD_LEAF_WORDS + (nextAt >> 6)] >> (nextAt & 63)) & 1)) continue;
            atLeaf = nextLeaf;
            at = nextAt;
          }
        }
        label = before[(base + atLeaf) * SHERD_LEAF_SIZE + at];
      }
      after[item * SHERD_LEAF_SIZE + v] = label;
    }
  }
}

// Seeds keep their voxel, so that no fragment is lost.
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
