// The layout of leaf blocks, read by C++ and by OpenCL C, and the mask arithmetic on one leaf.
//
// A leaf is 8x8x8 voxels; a voxel's offset is (x << 6) | (y << 3) | z, z fastest, as in OpenVDB.  A mask has eight
// 64-bit words: word x is the slab at x, with bit (y << 3) | z for a voxel.  Neighbor k of leaf l is neighbor[l*6 + k]
// in the order -x +x -y +y -z +z, or SHERD_NO_LEAF.
#ifndef SHERD_LEAF_BLOCK_H
#define SHERD_LEAF_BLOCK_H

#define SHERD_LEAF_SIZE 512
#define SHERD_LEAF_WORDS 8
#define SHERD_LEAF_FACES 6
#define SHERD_NO_LEAF 0xffffffffu

#define SHERD_TAG_MIXED 0xffffffffu  // see leaf_labels.h
#define SHERD_FRONT_WORDS 8          // 64-bit words of a front
#define SHERD_NO_STEP 0xffffffffu     // a front that was never published

#ifdef __OPENCL_VERSION__

#define SHERD_Y0 0x00000000000000fful  // bits with y == 0
#define SHERD_Y7 0xff00000000000000ul  // bits with y == 7
#define SHERD_Z0 0x0101010101010101ul  // bits with z == 0
#define SHERD_Z7 0x8080808080808080ul  // bits with z == 7

// Shift the bits of a slab by one voxel; bits that leave the leaf are dropped.
inline ulong moved_y_up(ulong w) { return w << 8; }
inline ulong moved_y_down(ulong w) { return w >> 8; }
inline ulong moved_z_up(ulong w) { return (w & ~SHERD_Z7) << 1; }
inline ulong moved_z_down(ulong w) { return (w & ~SHERD_Z0) >> 1; }

// Returns the four in-slab neighbors of a slab's bits.
inline ulong slab_neighbors(ulong w) {
  return moved_y_up(w) | moved_y_down(w) | moved_z_up(w) | moved_z_down(w);
}

// Returns what slab x of a leaf receives through face k from the neighbor's slab x (k >= 2), or from its adjacent slab.
inline ulong through_face(const int k, const ulong w) {
  switch (k) {
    case 2: return w >> 56;                 // -y: its y == 7 is beside our y == 0
    case 3: return w << 56;                 // +y
    case 4: return (w >> 7) & SHERD_Z0;     // -z: its z == 7 is beside our z == 0
    case 5: return (w & SHERD_Z0) << 7;     // +z
    default: return w;                      // -x, +x: whole slabs touch
  }
}

// Returns the union of the eight words.
inline ulong any_of(const ulong8 w) {
  const ulong4 a = w.lo | w.hi;
  const ulong2 b = a.lo | a.hi;
  return b.x | b.y;
}

// Returns the 6-neighbors of a leaf's bits within the leaf.
inline ulong8 slabs_neighbors(const ulong8 w) {
  const ulong8 inSlab = w << 8 | w >> 8 | (w & ~SHERD_Z7) << 1 | (w & ~SHERD_Z0) >> 1;
  return inSlab | (ulong8)(0, w.s0123, w.s456) | (ulong8)(w.s1234, w.s567, 0);
}

// Returns the bits and their 26-neighbors within the leaf.
inline ulong8 slabs_dilated(const ulong8 w) {
  const ulong8 z = w | (w & ~SHERD_Z7) << 1 | (w & ~SHERD_Z0) >> 1;
  const ulong8 yz = z | z << 8 | z >> 8;
  return yz | (ulong8)(0, yz.s0123, yz.s456) | (ulong8)(yz.s1234, yz.s567, 0);
}

// Returns the voxels at face k in one word: the slab for an x face, bit (x << 3) | z for a y face, (y << 3) | x for a z
// face.  So a voxel and its neighbor across the face have the same bit.
#define SHERD_SLABS (ulong8)(0, 1, 2, 3, 4, 5, 6, 7)

inline ulong face_of(const int k, const ulong8 w) {
  switch (k) {
    case 0: return w.s0;
    case 1: return w.s7;
    case 2: return any_of((w & 0xff) << 8 * SHERD_SLABS);
    case 3: return any_of((w >> 56) << 8 * SHERD_SLABS);
    case 4: return any_of((w & SHERD_Z0) << SHERD_SLABS);
    default: return any_of((w >> 7 & SHERD_Z0) << SHERD_SLABS);
  }
}

// Inverse of face_of: the voxels at face k of a word.
inline ulong8 at_face(const int k, const ulong face) {
  const ulong8 w = face;
  switch (k) {
    case 0: return (ulong8)(face, 0, 0, 0, 0, 0, 0, 0);
    case 1: return (ulong8)(0, 0, 0, 0, 0, 0, 0, face);
    case 2: return w >> 8 * SHERD_SLABS & 0xff;
    case 3: return (w >> 8 * SHERD_SLABS) << 56;
    case 4: return w >> SHERD_SLABS & SHERD_Z0;
    default: return (w >> SHERD_SLABS & SHERD_Z0) << 7;
  }
}

// Returns the offset of the voxel at a bit of a word of face k.
inline int offset_at_face(const int k, const int bit) {
  const int high = bit >> 3, low = bit & 7;
  switch (k >> 1) {
    case 0: return (k & 1 ? 7 << 6 : 0) | bit;
    case 1: return high << 6 | (k & 1 ? 7 << 3 : 0) | low;
    default: return low << 6 | high << 3 | (k & 1 ? 7 : 0);
  }
}

// Returns the index of the lowest set bit.
inline int lowest_bit(const ulong bits) { return 63 - (int)clz(bits & (~bits + 1)); }

// Writes the mask of the voxels of a leaf that have this label.
inline void equal_mask(const global ushort* labels, const ushort label, ulong* mask) {
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    ulong word = 0;
    for (int i = 0; i < 64; ++i) word |= (ulong)(labels[(x << 6) + i] == label) << i;
    mask[x] = word;
  }
}

#endif
#endif
