// flood: grow labels over a domain of voxels, all seeds at once, one layer of face neighbours per step.
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

inline void enqueue(global uint* queued, global uint* list, global uint* listCount, const uint items,
                    const uint item, const uint step) {
  if (atomic_xchg(&queued[item], step) == step) return;
  const uint at = atomic_inc(&listCount[step % 3]);
  list[(size_t)(step & 1) * items + at] = item;
}

// Make `front` what `item` reached in `step`, and queue who can go on from it.
inline void publish(const ulong* front, const int selfLeft, const uint item, const uint leaf, const uint step,
                    const uint newTag, const global ulong* domain, const global uint* neighbour,
                    global ulong* frontMask, global uint* frontStep, global uint* frontTag, global uint* queued,
                    global uint* list, global uint* listCount, const uint items) {
  const size_t copy = (size_t)(step & 1) * items + item;
  ulong any = 0;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    frontMask[copy * SHERD_LEAF_WORDS + x] = front[x];
    any |= front[x];
  }
  frontStep[copy] = step;
  frontTag[copy] = newTag;
  if (selfLeft) enqueue(queued, list, listCount, items, item, step + 1);
  const ulong touches[SHERD_LEAF_FACES] = {front[0],       front[7],       any & SHERD_Y0,
                                           any & SHERD_Y7, any & SHERD_Z0, any & SHERD_Z7};
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    if (!touches[k]) continue;
    const uint other = neighbour[(size_t)leaf * SHERD_LEAF_FACES + k];
    if (other == SHERD_NO_LEAF) continue;
    // Does a front bit have a domain voxel behind the face?  (The face of theirs that we reach is k ^ 1's.)
    ulong open = 0;
    if (k < 2) {
      open = front[k == 0 ? 0 : 7] & domain[(size_t)other * SHERD_LEAF_WORDS + (k == 0 ? 7 : 0)];
    } else {
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        open |= through_face(k ^ 1, front[x]) & domain[(size_t)other * SHERD_LEAF_WORDS + x];
      }
    }
    if (open) enqueue(queued, list, listCount, items, item - leaf + other, step + 1);
  }
}

// Write a one-label leaf out, one row of eight voxels at a time.
inline void write_rows(const ulong* mask, const ushort label, global ushort* out) {
  const ushort8 bit = (ushort8)(1, 2, 4, 8, 16, 32, 64, 128);
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    for (int y = 0; y < 8; ++y) {
      const ushort row = (ushort)((mask[x] >> (8 * y)) & 0xff);
      const ushort8 set = convert_ushort8((bit & row) != (ushort8)(0)) & label;
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
    publish(front, 1, item, leaf, 0, only, domain, neighbour, frontMask, frontStep, frontTag, queued, list,
            listCount, items);
  }
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
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const size_t copy = (size_t)(step & 1) * items + item;
    ulong open = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      frontMask[copy * SHERD_LEAF_WORDS + x] = owned[item * SHERD_LEAF_WORDS + x];
      open |= domain[(item % leafCount) * SHERD_LEAF_WORDS + x] & ~owned[item * SHERD_LEAF_WORDS + x];
    }
    frontStep[copy] = step;
    frontTag[copy] = tag[item];
    if (open) enqueue(queued, list, listCount, items, (uint)item, step + 1);
  }
}

// One layer.
kernel void flood_step(FLOOD_STATE, const uint step)
{
  if (get_global_id(0) == 0) listCount[(step + 2) % 3] = 0;  // the round after next counts from 0
  const uint entries = listCount[step % 3];
  const size_t before = (size_t)((step + 1) & 1) * items;    // the copy of step - 1
  for (size_t i = get_global_id(0); i < entries; i += get_global_size(0)) {
    const uint item = list[(size_t)(step & 1) * items + i];
    const uint leaf = item % leafCount;
    const uint base = item - leaf;

    ulong open[SHERD_LEAF_WORDS];  // reachable and not yet owned
    ulong isOpen = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      open[x] = domain[(size_t)leaf * SHERD_LEAF_WORDS + x] & ~owned[(size_t)item * SHERD_LEAF_WORDS + x];
      isOpen |= open[x];
    }
    if (!isOpen) continue;

    // What arrives, and whether all of it carries one label.
    ulong reached[SHERD_LEAF_WORDS];
    ulong self[SHERD_LEAF_WORDS];
    const int selfLive = frontStep[before + item] == step - 1;
    uint label = tag[item];  // 0: none yet
    int oneLabel = label != SHERD_TAG_MIXED;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      self[x] = selfLive ? frontMask[(before + item) * SHERD_LEAF_WORDS + x] : 0;
    }
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      ulong r = slab_neighbours(self[x]);
      if (x > 0) r |= self[x - 1];
      if (x < SHERD_LEAF_WORDS - 1) r |= self[x + 1];
      reached[x] = r & open[x];
    }
    uint source[SHERD_LEAF_FACES];  // neighbour items whose front is live
    for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
      source[k] = SHERD_NO_LEAF;
      const uint other = neighbour[(size_t)leaf * SHERD_LEAF_FACES + k];
      if (other == SHERD_NO_LEAF || frontStep[before + base + other] != step - 1) continue;
      const global ulong* restrict theirs = frontMask + (before + base + other) * SHERD_LEAF_WORDS;
      ulong arrives = 0;
      if (k < 2) {
        const int x = k == 0 ? 0 : 7;
        arrives = theirs[7 - x] & open[x];
        reached[x] |= arrives;
      } else {
        for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
          const ulong r = through_face(k, theirs[x]) & open[x];
          reached[x] |= r;
          arrives |= r;
        }
      }
      if (!arrives) continue;
      source[k] = base + other;
      const uint theirTag = frontTag[before + base + other];
      if (label == 0) label = theirTag;
      oneLabel &= theirTag == label && theirTag != SHERD_TAG_MIXED;
    }
    ulong isReached = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) isReached |= reached[x];
    if (!isReached) continue;

    global ushort* restrict owners = owner + (size_t)item * SHERD_LEAF_SIZE;
    if (!oneLabel) {
      const uint selfTag = tag[item];
      if (selfTag != SHERD_TAG_MIXED) {
        ulong old[SHERD_LEAF_WORDS];
        for (int x = 0; x < SHERD_LEAF_WORDS; ++x) old[x] = owned[(size_t)item * SHERD_LEAF_WORDS + x];
        write_rows(old, (ushort)selfTag, owners);
      }
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        for (ulong bits = reached[x]; bits; bits &= bits - 1) {
          const int bit = lowest_bit(bits);
          const int y = bit >> 3, z = bit & 7;
          uint best = SHERD_TAG_MIXED;
          for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
            const int d = (k & 1) ? 1 : -1;
            const int nx = x + (k < 2 ? d : 0), ny = y + ((k >> 1) == 1 ? d : 0), nz = z + (k >= 4 ? d : 0);
            const uint from = ((nx | ny | nz) & ~7) ? source[k] : item;
            if (from == SHERD_NO_LEAF || (from == item && !selfLive)) continue;
            const int offset = ((nx & 7) << 6) | ((ny & 7) << 3) | (nz & 7);
            if (!((frontMask[(before + from) * SHERD_LEAF_WORDS + (offset >> 6)] >> (offset & 63)) & 1)) continue;
            const uint theirTag = frontTag[before + from];
            best = min(best, theirTag == SHERD_TAG_MIXED ? (uint)owner[(size_t)from * SHERD_LEAF_SIZE + offset]
                                                         : theirTag);
          }
          owners[(x << 6) + bit] = (ushort)best;
        }
      }
      label = SHERD_TAG_MIXED;
    }
    if (keepCost) {
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        for (ulong bits = reached[x]; bits; bits &= bits - 1) {
          cost[(size_t)item * SHERD_LEAF_SIZE + (x << 6) + lowest_bit(bits)] = step;
        }
      }
    }
    ulong left = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      owned[(size_t)item * SHERD_LEAF_WORDS + x] |= reached[x];
      left |= open[x] & ~reached[x];
    }
    tag[item] = label;
    publish(reached, left != 0, item, leaf, step, label, domain, neighbour, frontMask, frontStep, frontTag,
            queued, list, listCount, items);
  }
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
