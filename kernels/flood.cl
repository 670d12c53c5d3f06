// flood: grow labels over a domain of voxels, all seeds at once, one layer of neighbours per step: the 6 over faces, or
// all 26.
//
// A voxel belongs to the label that reaches it in the fewest steps, ties to the lower id: one answer, whatever the
// order of work.  A step takes a list of leaves where something can change, and whole slabs of 64 voxels at a time by
// masks.  Several fractures of the same leaves grow together: item = fracture * leafCount + leaf.
//
// Rounds never read what the same round writes.  Only an item's own work-item writes its state; what neighbours may
// read is its front (mask, step, tag), which has two copies: step s reads copy (s-1)&1 and writes copy s&1.  A copy
// whose step is not s-1 is old and counts as empty, so nothing needs to be cleared.
//
// Most leaves only ever see one label.  Such a leaf keeps it as its tag and writes no voxel until flood_finish; a
// second label makes it SHERD_TAG_MIXED and writes it out.  A front carries the tag it was published with, so a
// neighbour that turns mixed in this round still reads as it was.
//
// One work-item takes list entries i, i + items, ...; any work-group size.
// Reference: tests/kernels/flood_test.cpp, bit for bit.

// The state of a growth; one argument list for all kernels of this file.
#define FLOOD_STATE                                                                              \
  const global ulong *restrict domain,       /* [leafCount*8]  voxels that may be reached */    \
  const global uint *restrict neighbour,     /* [leafCount*6] */                                \
  const global uint *restrict round27,       /* [leafCount*27] where all 26 neighbours count */ \
  const uint neighbours,                     /* 6 or 26 */                                      \
  const uint leafCount,                                                                         \
  global ulong *restrict owned,              /* [items*8]      voxels that have a label */      \
  global uint *restrict tag,                 /* [items]        0, the only label, or mixed */   \
  global ushort *restrict owner,             /* [items*512]    valid where the tag is mixed */  \
  global ulong *restrict frontMask,          /* [2*items*8]    voxels reached in a step */      \
  global uint *restrict frontStep,           /* [2*items]      the step */                      \
  global uint *restrict frontTag,            /* [2*items]      tag when published */            \
  global uint *restrict queued,              /* [items]        last step queued for */          \
  global uint *restrict list,                /* [2*items]      items to visit, by step parity */\
  global uint *restrict listCount,           /* [3]            entries, by step modulo 3 */     \
  const uint items,                                                                             \
  global uint *restrict cost,                /* [items*512]    steps, when keepCost */          \
  const uint keepCost

// The leaves beside one as round27 has them, x slowest, 13 itself: those over faces first, -x +x -y +y -z +z.
constant uchar kBeside[26] = {4, 22, 10, 16, 12, 14, 0,  1,  2,  3,  5,  6,  7,
                              8, 9,  11, 15, 17, 18, 19, 20, 21, 23, 24, 25, 26};

// The bits of a leaf's mask that border on the leaf at `beside`, of all slabs together.
inline ulong bordering(const int beside, const ulong first, const ulong last, const ulong any) {
  const int i = beside / 9, j = beside / 3 % 3, k = beside % 3;
  ulong bits = i == 0 ? first : i == 2 ? last : any;
  if (j != 1) bits &= j == 0 ? SHERD_Y0 : SHERD_Y7;
  if (k != 1) bits &= k == 0 ? SHERD_Z0 : SHERD_Z7;
  return bits;
}

// What a work-item queues for the next step is held back, and put on the list some at a time: an atomic exchange waits
// for all that was written before it.
#define FLOOD_HELD 64
struct held_items {
  uint item[FLOOD_HELD];  // some of them twice
  uint count;
};

inline void let_go(struct held_items* held, global uint* queued, global uint* list, global uint* listCount,
                   const uint items, const uint step) {
  uint count = 0;
  for (uint i = 0; i < held->count; ++i) {
    if (atomic_xchg(&queued[held->item[i]], step) != step) held->item[count++] = held->item[i];
  }
  held->count = 0;
  if (!count) return;
  const uint at = atomic_add(&listCount[step % 3], count);
  for (uint i = 0; i < count; ++i) list[(size_t)(step & 1) * items + at + i] = held->item[i];
}

inline void enqueue(global uint* queued, struct held_items* held, global uint* list, global uint* listCount,
                    const uint items, const uint item, const uint step) {
  held->item[held->count++] = item;
  if (held->count == FLOOD_HELD) let_go(held, queued, list, listCount, items, step);
}

// Make `front` what `item` reached in `step`, and queue who can go on from it.  `arrived` is what it was reached by over
// faces: who was there before needs not be told.
inline void publish(const ulong* front, const ulong8* arrived, const int selfLeft, const uint item, const uint leaf,
                    const uint step, const uint newTag, const global ulong* domain, const global uint* neighbour,
                    const global uint* round27, const uint neighbours, global ulong* frontMask,
                    global uint* frontStep, global uint* frontTag, global uint* queued, struct held_items* held,
                    global uint* list, global uint* listCount, const uint items) {
  const size_t copy = (size_t)(step & 1) * items + item;
  const ulong8 slabs = vload8(0, front);
  vstore8(slabs, copy, frontMask);
  const ulong any = any_of(slabs);
  frontStep[copy] = step;
  frontTag[copy] = newTag;
  if (selfLeft) enqueue(queued, held, list, listCount, items, item, step + 1);
  if (neighbours == 26) {
    for (int n = 0; n < 26; ++n) {
      const uint other = round27[(size_t)leaf * 27 + kBeside[n]];
      if (other != SHERD_NO_LEAF && bordering(kBeside[n], front[0], front[7], any)) {
        enqueue(queued, held, list, listCount, items, item - leaf + other, step + 1);
      }
    }
    return;
  }
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    const ulong8 beyond = slabs_through_face(k ^ 1, slabs & ~arrived[k]);  // (their face that we reach is k ^ 1)
    if (!any_of(beyond)) continue;
    const uint other = neighbour[(size_t)leaf * SHERD_LEAF_FACES + k];
    if (other == SHERD_NO_LEAF || !any_of(beyond & vload8(other, domain))) continue;
    enqueue(queued, held, list, listCount, items, item - leaf + other, step + 1);
  }
}

constant ushort8 kRowBits = (ushort8)(1, 2, 4, 8, 16, 32, 64, 128);

// Write a one-label leaf out, one row of eight voxels at a time.
inline void write_rows(const ulong* mask, const ushort label, global ushort* out) {
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    for (int y = 0; y < 8; ++y) {
      const ushort row = (ushort)((mask[x] >> (8 * y)) & 0xff);
      const ushort8 set = convert_ushort8((kRowBits & row) != (ushort8)(0)) & label;
      vstore8(set, (x << 3) + y, out);
    }
  }
}

// Step 0: put the seeds down.  One work-item per item that holds seeds.
kernel void flood_seed(
    FLOOD_STATE,
    const global uint* restrict seedItem,    // [seedItems]    ascending, distinct
    const global uint* restrict firstSeed,   // [seedItems+1]  its seeds are firstSeed[i] .. firstSeed[i+1]-1
    const global ushort* restrict seedOffset,  // [seeds]        offset in the leaf, distinct in an item
    const global ushort* restrict seedLabel,   // [seeds]
    const uint seedItems)
{
  struct held_items held;
  held.count = 0;
  for (size_t i = get_global_id(0); i < seedItems; i += get_global_size(0)) {
    const uint item = seedItem[i];
    const uint leaf = item % leafCount;
    ulong front[SHERD_LEAF_WORDS];
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) front[x] = 0;
    uint only = seedLabel[firstSeed[i]];
    for (uint s = firstSeed[i]; s < firstSeed[i + 1]; ++s) {
      const uint offset = seedOffset[s];
      front[offset >> 6] |= 1ul << (offset & 63);
      owner[(size_t)item * SHERD_LEAF_SIZE + offset] = seedLabel[s];
      if (keepCost) cost[(size_t)item * SHERD_LEAF_SIZE + offset] = 0;
      if (seedLabel[s] != only) only = SHERD_TAG_MIXED;
    }
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) owned[(size_t)item * SHERD_LEAF_WORDS + x] = front[x];
    tag[item] = only;
    if (only == SHERD_TAG_MIXED) {  // unowned voxels of a mixed leaf read 0
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
        if (!((front[v >> 6] >> (v & 63)) & 1)) owner[(size_t)item * SHERD_LEAF_SIZE + v] = 0;
      }
    }
    ulong8 arrived[SHERD_LEAF_FACES];
    for (int k = 0; k < SHERD_LEAF_FACES; ++k) arrived[k] = 0;
    publish(front, arrived, 1, item, leaf, 0, only, domain, neighbour, round27, neighbours, frontMask, frontStep, frontTag,
            queued, &held, list, listCount, items);
  }
  let_go(&held, queued, list, listCount, items, 1);
}

// Take labels that `owner` holds already instead of seeds: those of kept voxels stay, the rest reads 0.
kernel void flood_load(
    FLOOD_STATE,
    const global ulong* restrict kept)       // [items*8]    voxels whose label stays
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    uint only = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong mask = kept[item * SHERD_LEAF_WORDS + x];
      ulong labelled = 0;
      for (int i = 0; i < 64; ++i) {
        const size_t v = item * SHERD_LEAF_SIZE + (x << 6) + i;
        const uint label = (mask >> i) & 1 ? owner[v] : 0u;
        owner[v] = (ushort)label;
        if (!label) continue;
        labelled |= 1ul << i;
        if (label != only) only = only ? SHERD_TAG_MIXED : label;
      }
      owned[item * SHERD_LEAF_WORDS + x] = labelled;
    }
    tag[item] = only;
  }
}

// Begin a second growth from everything owned so far into another domain: all of it is the front of `step`.
kernel void flood_restart(FLOOD_STATE, const uint step)
{
  struct held_items held;
  held.count = 0;
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t copy = (size_t)(step & 1) * items + item;
    ulong open = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      frontMask[copy * SHERD_LEAF_WORDS + x] = owned[item * SHERD_LEAF_WORDS + x];
      open |= domain[(item % leafCount) * SHERD_LEAF_WORDS + x] & ~owned[item * SHERD_LEAF_WORDS + x];
    }
    frontStep[copy] = step;
    frontTag[copy] = tag[item];
    if (open) enqueue(queued, &held, list, listCount, items, (uint)item, step + 1);
  }
  let_go(&held, queued, list, listCount, items, step + 1);
}

// What a leaf's open voxels receive from fronts over faces, and from which items.
inline ulong8 arrive6(const global uint* beside, const uint base, const global ulong* frontMask,
                      const global uint* frontStep, const uint live, const ulong8 open, uint* source,
                      ulong8* arrived) {
  ulong8 reached = 0;
  if (source[13] != SHERD_NO_LEAF) {
    const ulong8 self = vload8(source[13], frontMask);
    reached = slabs_neighbours(self) & open;
  }
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    const uint other = beside[k];
    if (other == SHERD_NO_LEAF || frontStep[base + other] != live) continue;
    const ulong8 theirs = vload8(base + other, frontMask);
    arrived[k] = slabs_through_face(k, theirs) & open;
    reached |= arrived[k];
    if (any_of(arrived[k])) source[kBeside[k]] = base + other;
  }
  return reached;
}

// The same over faces, edges and corners.
inline void arrive26(const global uint* beside, const uint base, const global ulong* frontMask,
                     const global uint* frontStep, const uint live, const ulong* open, ulong* reached, uint* source) {
  for (int k = 0; k < 27; ++k) {
    const uint other = beside[k];
    if (k == 13 || other == SHERD_NO_LEAF || frontStep[base + other] != live) continue;
    const global ulong* restrict theirs = frontMask + (size_t)(base + other) * SHERD_LEAF_WORDS;
    ulong any = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) any |= theirs[x];
    if (bordering(26 - k, theirs[0], theirs[7], any)) source[k] = base + other;
  }
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) reached[x] = 0;
  for (int x = -1; x <= SHERD_LEAF_WORDS; ++x) {  // a slab of this leaf or of the leaves beside, spread along z, then y
    ulong row[3];
    for (int j = 0; j < 3; ++j) {
      ulong word[3];
      for (int k = 0; k < 3; ++k) {
        const uint from = source[((x >> 3) + 1) * 9 + j * 3 + k];
        word[k] = from == SHERD_NO_LEAF ? 0 : frontMask[(size_t)from * SHERD_LEAF_WORDS + (x & 7)];
      }
      row[j] = word[1] | moved_z_up(word[1]) | moved_z_down(word[1]) | through_face(4, word[0]) |
               through_face(5, word[2]);
    }
    const ulong slab = row[1] | moved_y_up(row[1]) | moved_y_down(row[1]) | through_face(2, row[0]) |
                       through_face(3, row[2]);
    for (int to = max(x - 1, 0); to <= min(x + 1, 7); ++to) reached[to] |= slab & open[to];
  }
}

// Give the reached voxels the lowest label of the front voxels beside them.  Voxels that are not in a front are not
// read, and only reached ones written: another work-item may be at its own part of a row.
#define FLOOD_NO_LABEL 0xffff

inline void take_labels(const uint* source, const global ulong* frontMask, const global uint* frontTag,
                        const global ushort* owner, const uint neighbours, const ulong* reached,
                        global ushort* owners) {
  ushort near[10 * 10 * 10];  // labels of the front voxels at x, y, z of -1..8
  for (int i = 0; i < 10 * 10 * 10 / 8; ++i) vstore8((ushort8)(FLOOD_NO_LABEL), i, near);
  for (int k = 0; k < 27; ++k) {
    if (source[k] == SHERD_NO_LEAF) continue;
    const int i = 8 * (k / 9) - 8, j = 8 * (k / 3 % 3) - 8, l = 8 * (k % 3) - 8;  // where the leaf begins
    const uint tag = frontTag[source[k]];
    for (int x = max(i, -1); x <= min(i + 7, 8); ++x) {
      ulong word = frontMask[(size_t)source[k] * SHERD_LEAF_WORDS + (x & 7)];
      if (j != 0) word &= j < 0 ? SHERD_Y7 : SHERD_Y0;
      if (l != 0) word &= l < 0 ? SHERD_Z7 : SHERD_Z0;
      for (; word; word &= word - 1) {
        const int bit = lowest_bit(word);
        const ushort label =
            tag == SHERD_TAG_MIXED ? owner[(size_t)source[k] * SHERD_LEAF_SIZE + ((x & 7) << 6) + bit] : (ushort)tag;
        near[((x + 1) * 10 + j + (bit >> 3) + 1) * 10 + l + (bit & 7) + 1] = label;
      }
    }
  }
  for (int row = 0; row < 64; ++row) {
    uint set = (uint)(reached[row >> 3] >> (8 * (row & 7))) & 0xff;
    if (!set) continue;
    const ushort* const here = near + (((row >> 3) + 1) * 10 + (row & 7) + 1) * 10 + 1;
    ushort8 least = min(vload8(0, here - 1), vload8(0, here + 1));
    least = min(least, min(vload8(0, here - 10), vload8(0, here + 10)));
    least = min(least, min(vload8(0, here - 100), vload8(0, here + 100)));
    for (int k = 0; neighbours == 26 && k < 9; ++k) {  // the rows beside, itself at 4
      const ushort* const beside = here + (k / 3 - 1) * 100 + (k % 3 - 1) * 10;
      if (k != 4) least = min(least, vload8(0, beside));
      least = min(least, min(vload8(0, beside - 1), vload8(0, beside + 1)));
    }
    ushort labels[8];
    vstore8(least, 0, labels);
    for (; set; set &= set - 1) {
      const int z = lowest_bit(set);
      owners[row * 8 + z] = labels[z];
    }
  }
}

// One layer.
kernel void flood_step(FLOOD_STATE, const uint step)
{
  if (get_global_id(0) == 0) listCount[(step + 2) % 3] = 0;  // the round after next counts from 0
  const uint entries = listCount[step % 3];
  const size_t before = (size_t)((step + 1) & 1) * items;    // the copy of step - 1
  struct held_items held;
  held.count = 0;
  for (size_t i = get_global_id(0); i < entries; i += get_global_size(0)) {
    const uint item = list[(size_t)(step & 1) * items + i];
    const uint leaf = item % leafCount;
    const uint base = item - leaf;

    const ulong8 owned8 = vload8(item, owned);
    const ulong8 open8 = vload8(leaf, domain) & ~owned8;  // reachable and not yet owned
    if (!any_of(open8)) continue;

    ulong reached[SHERD_LEAF_WORDS];
    ulong8 reached8, arrived[SHERD_LEAF_FACES];
    for (int k = 0; k < SHERD_LEAF_FACES; ++k) arrived[k] = 0;
    uint source[27];  // items whose live front may border on this leaf, as kBeside numbers them
    for (int k = 0; k < 27; ++k) source[k] = SHERD_NO_LEAF;
    if (frontStep[before + item] == step - 1) source[13] = item;
    if (neighbours == 26) {
      ulong open[SHERD_LEAF_WORDS];
      vstore8(open8, 0, open);
      arrive26(round27 + (size_t)leaf * 27, base, frontMask + before * SHERD_LEAF_WORDS, frontStep + before, step - 1,
               open, reached, source);
      reached8 = vload8(0, reached);
    } else {
      reached8 = arrive6(neighbour + (size_t)leaf * SHERD_LEAF_FACES, base, frontMask + before * SHERD_LEAF_WORDS,
                         frontStep + before, step - 1, open8, source, arrived);
      vstore8(reached8, 0, reached);
    }
    if (!any_of(reached8)) continue;
    uint label = tag[item];  // 0: none yet
    int oneLabel = label != SHERD_TAG_MIXED;
    for (uint n = 0; n < neighbours; ++n) {
      const uint from = source[kBeside[n]];
      if (from == SHERD_NO_LEAF) continue;
      const uint theirTag = frontTag[before + from];
      if (label == 0) label = theirTag;
      oneLabel &= theirTag == label && theirTag != SHERD_TAG_MIXED;
    }
    global ushort* restrict owners = owner + (size_t)item * SHERD_LEAF_SIZE;
    if (!oneLabel) {
      const uint selfTag = tag[item];
      if (selfTag != SHERD_TAG_MIXED) {
        ulong old[SHERD_LEAF_WORDS];
        vstore8(owned8, 0, old);
        write_rows(old, (ushort)selfTag, owners);
      }
      take_labels(source, frontMask + before * SHERD_LEAF_WORDS, frontTag + before, owner, neighbours, reached, owners);
      label = SHERD_TAG_MIXED;
    }
    if (keepCost) {
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        for (ulong bits = reached[x]; bits; bits &= bits - 1) {
          cost[(size_t)item * SHERD_LEAF_SIZE + (x << 6) + lowest_bit(bits)] = step;
        }
      }
    }
    vstore8(owned8 | reached8, item, owned);
    tag[item] = label;
    publish(reached, arrived, any_of(open8 & ~reached8) != 0, item, leaf, step, label, domain, neighbour, round27, neighbours,
            frontMask, frontStep, frontTag, queued, &held, list, listCount, items);
  }
  let_go(&held, queued, list, listCount, items, step + 1);
}

// Write out every leaf that is not mixed.
kernel void flood_finish(FLOOD_STATE)
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    if (tag[item] == SHERD_TAG_MIXED) continue;
    ulong mask[SHERD_LEAF_WORDS];
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) mask[x] = owned[item * SHERD_LEAF_WORDS + x];
    write_rows(mask, (ushort)tag[item], owner + item * SHERD_LEAF_SIZE);
  }
}
