// The labels of an item, a leaf of one fracture: its tag is 0 (no voxel is labeled), one label, two labels (the lower
// in the lower half), or SHERD_TAG_MIXED.  A mixed leaf has a label per voxel in `owner`; of two labels `second` has a
// mask of the voxels with the second.  So most leaves need no label per voxel, and never touch their part of `owner`.
#ifndef SHERD_LEAF_LABELS_H
#define SHERD_LEAF_LABELS_H

// Returns the tag with `label` added; label 0 adds nothing.
inline uint with_label(const uint tag, const uint label) {
  const uint low = tag & 0xffff, high = tag >> 16;
  if (label == 0 || label == low || label == high || tag == SHERD_TAG_MIXED) return tag;
  if (high != 0) return SHERD_TAG_MIXED;
  return low == 0 ? label : min(low, label) | max(low, label) << 16;
}

inline int is_pair(const uint tag) { return tag >> 16 != 0 && tag != SHERD_TAG_MIXED; }

// Offset in `second` of an item's voxels of the second label, in rows of eight words.
inline size_t second_voxels(const uint item) { return 3 * (size_t)item; }

// Returns the union of the bits of a row.
inline ushort bits_of(const ushort8 row) {
  const ushort4 a = row.lo | row.hi;
  const ushort2 b = a.lo | a.hi;
  return b.x | b.y;
}

static constant ushort8 kRowBits = (ushort8)(1, 2, 4, 8, 16, 32, 64, 128);

// Writes the labels of a leaf that is not mixed, one row of eight voxels at a time.
inline void write_rows(const ulong8 mask, const ulong8 ofSecond, const uint tag, global ushort* out) {
  const ushort low = (ushort)(tag & 0xffff), other = low ^ (ushort)(tag >> 16);
  ulong words[SHERD_LEAF_WORDS], seconds[SHERD_LEAF_WORDS];
  vstore8(mask, 0, words);
  vstore8(ofSecond, 0, seconds);
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    for (int y = 0; y < 8; ++y) {
      const ushort row = (ushort)(words[x] >> (8 * y) & 0xff), secondRow = (ushort)(seconds[x] >> (8 * y) & 0xff);
      const ushort8 set = convert_ushort8((kRowBits & row) != (ushort8)(0)) & low;
      vstore8(set ^ (convert_ushort8((kRowBits & secondRow) != (ushort8)(0)) & other), (x << 3) + y, out);
    }
  }
}

// Returns the voxels that have the second label of a tag of two.
inline ulong8 second_of(const uint tag, const uint item, const global ulong* second) {
  return is_pair(tag) ? vload8(second_voxels(item), second) : (ulong8)(0);
}

// Writes the labels of a leaf's inside voxels, as a tag of two labels if `labels` is one.
inline void write_labels(const ulong* mask, const ushort* label, const uint labels, const uint item,
                         global ushort* owner, global uint* tag, global ulong* second) {
  if (!is_pair(labels)) {
    for (int row = 0; row < 64; ++row) {
      const ushort bits = (ushort)(mask[row >> 3] >> (8 * (row & 7)) & 0xff);
      vstore8(vload8(row, label) & convert_ushort8((kRowBits & bits) != (ushort8)(0)), (size_t)item * 64 + row, owner);
    }
    tag[item] = SHERD_TAG_MIXED;
    return;
  }
  const ushort high = (ushort)(labels >> 16);
  ulong ofSecond[SHERD_LEAF_WORDS], anySecond = 0, anyFirst = 0;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    ulong word = 0;
    for (int y = 0; y < 8; ++y) {
      word |= (ulong)bits_of(convert_ushort8(vload8((x << 3) + y, label) == (ushort8)(high)) & kRowBits) << (8 * y);
    }
    ofSecond[x] = word & mask[x];
    anySecond |= ofSecond[x];
    anyFirst |= mask[x] & ~word;
  }
  tag[item] = !anySecond ? labels & 0xffff : !anyFirst ? high : labels;
  if (anySecond && anyFirst) vstore8(vload8(0, ofSecond), second_voxels(item), second);
}

// The labels of all items; one argument list for the kernels that read them.
#define LEAF_LABELS                                                                         \
  const global ushort *restrict owner, /* [items*512]  valid where the tag is mixed */      \
  const global uint *restrict tag,     /* [items] */                                        \
  const global ulong *restrict second  /* [items*3*8]  the voxels of the second of two */

struct leaf_labels {
  const global ushort* owner;
  const global uint* tag;
  const global ulong* second;
};

// Returns the label of a labeled voxel.
inline uint label_of(const struct leaf_labels* labels, const size_t item, const int v) {
  const uint tag = labels->tag[item];
  if (tag == SHERD_TAG_MIXED) return labels->owner[item * SHERD_LEAF_SIZE + v];
  if (!is_pair(tag)) return tag;
  const ulong word = labels->second[second_voxels((uint)item) * SHERD_LEAF_WORDS + (v >> 6)];
  return word >> (v & 63) & 1 ? tag >> 16 : tag & 0xffff;
}

#endif
