// flood: grow labels from all seeds at once over a domain of voxels, one layer of neighbors per step: the 6 over faces,
// or all 26.
//
// A voxel belongs to the label that reaches it in the fewest steps, ties to the lower id, so the result does not depend
// on the schedule.  A step visits a list of leaves where a voxel can change, and handles slabs of 64 voxels as masks.
// Several fractures of the same leaves grow together: item = fracture * leafCount + leaf.
//
// A step never reads what the same step writes.  Only an item's own work-item writes its state.  Neighbors read its
// front only: the voxels it reached in one step, as words of its six faces.  A front has two copies: step s reads copy
// (s-1)&1 and writes copy s&1.  A copy whose step is not s-1 is stale and counts as empty, so nothing is cleared.
// Within an item every owned voxel counts: voxels reached before step s-1 have no free neighbor left.
//
// Most leaves receive one label only, and most of the others two.  Such a leaf stores them as its tag (the lower label
// in the lower half) and a mask of the voxels with the second label, and writes no voxel until flood_finish.  A third
// label sets the tag to SHERD_TAG_MIXED and writes the voxels.  A front stores the tag of its step, so neighbors of a
// leaf that becomes mixed in this step still read the earlier state.  Over 26 neighbors a leaf of two labels is mixed.
//
// A work-item takes consecutive list entries: they were listed together and are mostly close in memory.
// Reference: tests/kernels/flood_test.cpp, bit for bit.

// The state of a growth; one argument list for all kernels of this file.
#define FLOOD_STATE                                                                                           \
  const global ulong *restrict domain,     /* [leafCount*8]  voxels that may be reached */                    \
  const global uint *restrict neighbor,    /* [leafCount*6] */                                                \
  const global uint *restrict neighbors27, /* [leafCount*27] read for 26 neighbors */                         \
  const uint neighbors,                    /* 6 or 26 */                                                      \
  const uint leafCount,                                                                                       \
  global ulong *restrict beyond,           /* [leafCount*6]  the domain behind each face */                   \
  global ulong *restrict owned,            /* [items*8]      voxels that have a label */                      \
  global uint *restrict tag,               /* [items]        0, one or two labels, or mixed */                \
  global ulong *restrict second,           /* [items*3*8]    tag of two labels: the voxels of the second, */  \
                                           /* and its words of both copies of the front */                    \
  global ushort *restrict owner,           /* [items*512]    valid where the tag is mixed */                  \
  global struct front *restrict fronts,    /* [items*2]      by step parity */                                \
  global uint *restrict queued,            /* [items]        last step queued for */                          \
  global uint *restrict list,              /* [2*items]      items to visit, by step parity */                \
  global uint *restrict listCount,         /* [3]            entries, by step modulo 3 */                     \
  const uint items,                                                                                           \
  global uint *restrict cost,              /* [items*512]    steps, when keepCost */                          \
  const uint keepCost

// Writes the domain behind each face of a leaf.  Runs before the first step into a new domain.
kernel void flood_enter(FLOOD_STATE)
{
  for (size_t leaf = get_global_id(0); leaf < leafCount; leaf += get_global_size(0)) {
#pragma unroll
    for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
      const uint other = neighbor[leaf * SHERD_LEAF_FACES + k];
      beyond[leaf * SHERD_LEAF_FACES + k] = other == SHERD_NO_LEAF ? 0 : face_of(k ^ 1, vload8(other, domain));
    }
  }
}

// Step 0: owns the seeds.  One work-item per item with seeds.
kernel void flood_seed(
    FLOOD_STATE,
    const global uint* restrict seedItem,      // [seedItems]    ascending, distinct
    const global uint* restrict firstSeed,     // [seedItems+1]  item i has seeds firstSeed[i] .. firstSeed[i+1]-1
    const global ushort* restrict seedOffset,  // [seeds]        offset in the leaf, distinct in an item
    const global ushort* restrict seedLabel,   // [seeds]
    const uint seedItems)
{
  const struct flood state = {FLOOD_MEMBERS};
  struct next_items next = next_of(queued, list, listCount, items, 1);
  for (size_t i = get_global_id(0); i < seedItems; i += get_global_size(0)) {
    const uint item = seedItem[i];
    ulong front[SHERD_LEAF_WORDS];
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) front[x] = 0;
    uint itemTag = seedLabel[firstSeed[i]];
    for (uint s = firstSeed[i]; s < firstSeed[i + 1]; ++s) {
      const uint offset = seedOffset[s];
      front[offset >> 6] |= 1ul << (offset & 63);
      owner[(size_t)item * SHERD_LEAF_SIZE + offset] = seedLabel[s];
      if (keepCost) cost[(size_t)item * SHERD_LEAF_SIZE + offset] = 0;
      if (seedLabel[s] != itemTag) itemTag = SHERD_TAG_MIXED;
    }
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) owned[(size_t)item * SHERD_LEAF_WORDS + x] = front[x];
    tag[item] = itemTag;
    if (itemTag == SHERD_TAG_MIXED) {  // unowned voxels of a mixed leaf have label 0
      for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
        if (!((front[v >> 6] >> (v & 63)) & 1)) owner[(size_t)item * SHERD_LEAF_SIZE + v] = 0;
      }
    }
    struct arrival seeds = arrival_at(item, item % leafCount, 0);
    seeds.reached = vload8(0, front);
    publish(&state, &seeds, itemTag, 1, &next);
  }
  flush_frontier(&next);
}

// Returns the first label of a row that is not 0, or 0.
inline ushort first_of(const ushort8 row) {
  ushort all[8];
  vstore8(row, 0, all);
  for (int i = 0; i < 8; ++i) {
    if (all[i]) return all[i];
  }
  return 0;
}

// Keeps some voxels of a leaf that is not mixed.
inline void load_unmixed(const ulong8 kept, const uint item, global ulong* owned, global uint* tag,
                         global ulong* second) {
  const uint old = tag[item];
  const ulong8 ofSecond = second_of(old, item, second) & kept;
  uint left = any_of(kept & ~ofSecond) ? old & 0xffff : 0;
  if (any_of(ofSecond)) left = with_label(left, old >> 16);
  vstore8(old ? kept : (ulong8)(0), item, owned);
  if (is_pair(left)) vstore8(ofSecond, second_voxels(item), second);
  tag[item] = left;
}

// Starts from labels instead of seeds: kept voxels, which have a label, keep it, the others become 0.
kernel void flood_load(
    FLOOD_STATE,
    const global ulong* restrict kept)       // [items*8]    voxels whose label stays
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    if (tag[item] != SHERD_TAG_MIXED) {
      load_unmixed(vload8(item, kept), (uint)item, owned, tag, second);
      continue;
    }
    ulong labeled[SHERD_LEAF_WORDS];
    ulong seconds[SHERD_LEAF_WORDS];  // voxels with a label other than `firstLabel`
    ushort firstLabel = 0;
    ushort8 others = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong keep = kept[item * SHERD_LEAF_WORDS + x];
      labeled[x] = 0;
      for (int y = 0; y < 8; ++y) {
        const size_t row = item * 64 + (x << 3) + y;
        const ushort bits = (ushort)(keep >> (8 * y) & 0xff);
        const ushort8 label = vload8(row, owner) & convert_ushort8((kRowBits & bits) != (ushort8)(0));
        vstore8(label, row, owner);
        const ushort8 has = convert_ushort8(label != (ushort8)(0));
        if (!firstLabel) firstLabel = first_of(label);
        others |= (label ^ firstLabel) & has;
        labeled[x] |= (ulong)bits_of(has & kRowBits) << (8 * y);
      }
    }
    vstore8(vload8(0, labeled), item, owned);
    uint itemTag = firstLabel;
    if (bits_of(others)) {
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        seconds[x] = 0;
        for (ulong bits = labeled[x]; bits; bits &= bits - 1) {
          const ushort label = owner[item * SHERD_LEAF_SIZE + (x << 6) + lowest_bit(bits)];
          if (label != firstLabel) seconds[x] |= bits & (~bits + 1);
          itemTag = with_label(itemTag, label);
        }
      }
    }
    if (is_pair(itemTag)) {
      const ulong8 notFirst = vload8(0, seconds);
      const ulong8 ofSecond = firstLabel == (itemTag & 0xffff) ? notFirst : vload8(item, owned) & ~notFirst;
      vstore8(ofSecond, second_voxels((uint)item), second);
    }
    tag[item] = itemTag;
  }
}

// Starts a second growth into another domain: every owned voxel is in the front of `step`.
kernel void flood_restart(FLOOD_STATE, const uint step)
{
  struct next_items next = next_of(queued, list, listCount, items, step + 1);
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const ulong8 mine = vload8(item, owned);
    write_front(mine, second_of(tag[item], (uint)item, second), (uint)item, step, tag[item], fronts, second);
    if (next.count == FLOOD_HELD - 1) flush_frontier(&next);
    enqueue_if(any_of(vload8(item % leafCount, domain) & ~mine) != 0, &next, (uint)item);
  }
  flush_frontier(&next);
}

// Finds the open voxels that are reached over faces.  `before` are the front copies of the previous step.
inline void arrive6(const struct flood* state, const global struct front* before, const ulong8 mine, const ulong8 open,
                    struct arrival* arrival) {
  const global uint* const beside = state->neighbor + (size_t)arrival->leaf * SHERD_LEAF_FACES;
  ulong8 reached = slabs_neighbors(mine) & open;
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    if (beside[k] == SHERD_NO_LEAF) continue;
    const uint from = arrival->item - arrival->leaf + beside[k];
    const global struct front* const theirs = before + 2 * (size_t)from;
    if (theirs->step != arrival->step - 1) continue;
    const ulong through = theirs->face[k ^ 1] & face_of(k, open);
    if (!through) continue;
    arrival->through[k] = through;
    reached |= at_face(k, through);
    arrival->source[kBeside[k]] = from;
  }
  arrival->reached = reached;
}

// The same over the 26 neighbors.
inline void arrive26(const struct flood* state, const global struct front* before, const ulong8 mine8,
                     const ulong8 open, struct arrival* arrival) {
  const global uint* const beside = state->neighbors27 + (size_t)arrival->leaf * 27;
  ulong mine[SHERD_LEAF_WORDS];
  vstore8(mine8, 0, mine);
  ulong border[27];  // voxels of each front that are adjacent to the leaf
  for (int k = 0; k < 27; ++k) {
    border[k] = 0;
    if (k == 13 || beside[k] == SHERD_NO_LEAF) continue;
    const size_t from = arrival->item - arrival->leaf + beside[k];
    if (before[2 * from].step != arrival->step - 1) continue;
    border[k] = bordering(26 - k, before[2 * from].face);
    if (border[k]) arrival->source[k] = (uint)from;
  }
  ulong reached[SHERD_LEAF_WORDS];
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) reached[x] = 0;
  for (int x = -1; x <= SHERD_LEAF_WORDS; ++x) {  // a slab of this leaf or of its neighbors, dilated along z, then y
    const int isMiddle = (x & ~7) == 0;
    const ulong* const layer = border + ((x >> 3) + 1) * 9;
    ulong row[3];
#pragma unroll
    for (int j = 0; j < 3; ++j) {
      ulong word[3];
#pragma unroll
      for (int k = 0; k < 3; ++k) {
        const ulong bits = layer[j * 3 + k];
        word[k] = bits;
        if (!isMiddle) continue;
        if (j != 1) word[k] = (bits >> 8 * x & 0xff) << (j == 0 ? 56 : 0);
        if (j == 1 && k != 1) word[k] = (bits >> x & SHERD_Z0) << (k == 0 ? 7 : 0);
        if (j == 1 && k == 1) word[k] = mine[x];
      }
      row[j] = word[1] | moved_z_up(word[1]) | moved_z_down(word[1]) | through_face(4, word[0]) |
               through_face(5, word[2]);
    }
    const ulong slab = row[1] | moved_y_up(row[1]) | moved_y_down(row[1]) | through_face(2, row[0]) |
                       through_face(3, row[2]);
    for (int to = max(x - 1, 0); to <= min(x + 1, 7); ++to) reached[to] |= slab;
  }
  arrival->reached = vload8(0, reached) & open;
}

// Returns an item's tag after what arrives over faces.  For a tag of two labels, sets `ofSecond`.
inline uint tag_arriving(const struct flood* state, const global struct front* before, const uint ownTag,
                         const ulong8 mine, const ulong8 ownSecond, struct arrival* arrival) {
  const ulong* const arrived = arrival->through;
  const uint* const source = arrival->source;
  const global ushort* const owner = state->owner;
  uint newTag = ownTag, tag[SHERD_LEAF_FACES];
  ulong withHigh[SHERD_LEAF_FACES];  // arriving voxels that have the second label of their source
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    if (!arrived[k]) continue;
    const uint from = source[kBeside[k]];
    tag[k] = before[2 * (size_t)from].tag;
    withHigh[k] = 0;
    if (tag[k] == SHERD_TAG_MIXED) {
      for (ulong bits = arrived[k]; bits; bits &= bits - 1) {
        newTag = with_label(newTag, owner[label_at(from, k ^ 1, bits)]);
      }
      continue;
    }
    if (is_pair(tag[k])) withHigh[k] = arrived[k] & state->second[second_faces(from, arrival->step - 1) + (k ^ 1)];
    if (arrived[k] & ~withHigh[k]) newTag = with_label(newTag, tag[k] & 0xffff);
    if (withHigh[k]) newTag = with_label(newTag, tag[k] >> 16);
  }
  if (!is_pair(newTag)) return newTag;
  const uint low = newTag & 0xffff;
  ulong8 byLow = slabs_neighbors((ownTag & 0xffff) == low ? mine & ~ownSecond : (ulong8)(0));
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    if (!arrived[k]) continue;
    ulong ofLow = 0;
    if (tag[k] == SHERD_TAG_MIXED) {
      for (ulong bits = arrived[k]; bits; bits &= bits - 1) {
        if (owner[label_at(source[kBeside[k]], k ^ 1, bits)] == low) ofLow |= bits & (~bits + 1);
      }
    } else {
      if ((tag[k] & 0xffff) == low) ofLow = arrived[k] & ~withHigh[k];
      if (tag[k] >> 16 == low) ofLow = withHigh[k];
    }
    byLow |= at_face(k, ofLow);
  }
  arrival->ofSecond = arrival->reached & ~byLow;
  return newTag;
}

// The same over 26 neighbors, where two labels make a leaf mixed.
inline uint tag_arriving26(const uint ownTag, const uint* source, const global struct front* before) {
  uint newTag = ownTag;
  for (int k = 0; k < 27; ++k) {
    if (k == 13 || source[k] == SHERD_NO_LEAF) continue;
    const uint theirs = before[2 * (size_t)source[k]].tag;
    newTag = theirs == SHERD_TAG_MIXED ? theirs : with_label(newTag, theirs);
  }
  return is_pair(newTag) ? SHERD_TAG_MIXED : newTag;
}

// Gives each reached voxel the lowest label among its neighbors in `mine` and in the fronts of its sources.  Reads no
// other label and writes reached voxels only: other work-items may access the rest of a row.
#define FLOOD_NO_LABEL 0xffff

inline void take_labels(const struct flood* state, const global struct front* before, const ulong8 mine,
                        const struct arrival* arrival) {
  const uint* const source = arrival->source;
  const uint neighbors = state->neighbors;
  global ushort* restrict owners = state->owner + (size_t)arrival->item * SHERD_LEAF_SIZE;
  ushort near[10 * 10 * 10];  // labels of the voxels at x, y, z of -1..8
  for (int i = 0; i < 10 * 10 * 10 / 8; ++i) vstore8((ushort8)(FLOOD_NO_LABEL), i, near);
  ulong words[SHERD_LEAF_WORDS], reached[SHERD_LEAF_WORDS];
  vstore8(mine & (neighbors == 26 ? slabs_dilated(arrival->reached) : slabs_neighbors(arrival->reached)), 0, words);
  vstore8(arrival->reached, 0, reached);
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    for (ulong word = words[x]; word; word &= word - 1) {
      const int bit = lowest_bit(word);
      near[((x + 1) * 10 + (bit >> 3) + 1) * 10 + (bit & 7) + 1] = owners[(x << 6) + bit];
    }
  }
  for (uint n = 0; n < neighbors; ++n) {
    const int at = kBeside[n], i = at / 9, j = at / 3 % 3, k = at % 3;
    if (source[at] == SHERD_NO_LEAF) continue;
    const global struct front* const theirs = before + 2 * (size_t)source[at];
    const global ushort* const labels = state->owner + (size_t)source[at] * SHERD_LEAF_SIZE;
    const ulong ofSecond =
        is_pair(theirs->tag) ? bordering(26 - at, state->second + second_faces(source[at], arrival->step - 1)) : 0;
    for (ulong word = bordering(26 - at, theirs->face); word; word &= word - 1) {
      const int bit = lowest_bit(word), high = bit >> 3, low = bit & 7;
      const int x = i != 1 ? 7 * (i == 0) : j != 1 ? high : low;
      const int y = j != 1 ? 7 * (j == 0) : high, z = k != 1 ? 7 * (k == 0) : low;
      const uint label = theirs->tag == SHERD_TAG_MIXED ? labels[(x << 6) + (y << 3) + z]
                         : ofSecond >> bit & 1         ? theirs->tag >> 16
                                                       : theirs->tag & 0xffff;
      near[((x + 8 * i - 7) * 10 + y + 8 * j - 7) * 10 + z + 8 * k - 7] = (ushort)label;
    }
  }
  for (int row = 0; row < 64; ++row) {
    uint set = (uint)(reached[row >> 3] >> (8 * (row & 7))) & 0xff;
    if (!set) continue;
    const ushort* const here = near + (((row >> 3) + 1) * 10 + (row & 7) + 1) * 10 + 1;
    ushort8 least = min(vload8(0, here - 1), vload8(0, here + 1));
    least = min(least, min(vload8(0, here - 10), vload8(0, here + 10)));
    least = min(least, min(vload8(0, here - 100), vload8(0, here + 100)));
    for (int k = 0; neighbors == 26 && k < 9; ++k) {  // the 3x3 rows around, 4 is the row itself
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

// Gives the reached voxels their labels; returns the item's tag after it.
inline uint take(const struct flood* state, const global struct front* before, const ulong8 mine,
                 struct arrival* arrival) {
  const uint item = arrival->item, ownTag = state->tag[item];
  const ulong8 ownSecond = second_of(ownTag, item, state->second);
  const uint newTag = state->neighbors == 26 ? tag_arriving26(ownTag, arrival->source, before)
                                             : tag_arriving(state, before, ownTag, mine, ownSecond, arrival);
  if (newTag == SHERD_TAG_MIXED) {
    if (ownTag != SHERD_TAG_MIXED) {
      write_rows(mine, ownSecond, ownTag, state->owner + (size_t)item * SHERD_LEAF_SIZE);
    }
    take_labels(state, before, mine, arrival);
  } else if (is_pair(newTag)) {
    const int sameLow = (ownTag & 0xffff) == (newTag & 0xffff);
    vstore8((sameLow ? ownSecond : mine) | arrival->ofSecond, second_voxels(item), state->second);
  }
  if (newTag != ownTag) state->tag[item] = newTag;
  return newTag;
}

// Writes the step in which voxels were reached.
inline void write_cost(const struct arrival* arrival, global uint* cost) {
  ulong words[SHERD_LEAF_WORDS];
  vstore8(arrival->reached, 0, words);
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    for (ulong bits = words[x]; bits; bits &= bits - 1) {
      cost[(size_t)arrival->item * SHERD_LEAF_SIZE + (x << 6) + lowest_bit(bits)] = arrival->step;
    }
  }
}

// Grows one layer.
kernel void flood_step(FLOOD_STATE, const uint step)
{
  if (get_global_id(0) == 0) listCount[(step + 2) % 3] = 0;  // the list of step + 2 starts empty
  const uint entries = listCount[step % 3];
  const global struct front* const before = fronts + ((step + 1) & 1);
  const global uint* const visits = list + (size_t)(step & 1) * items;
  const struct flood state = {FLOOD_MEMBERS};
  struct next_items next = next_of(queued, list, listCount, items, step + 1);
  const size_t share = (entries + get_global_size(0) - 1) / get_global_size(0);
  const size_t end = min((size_t)entries, share * (get_global_id(0) + 1));
  for (size_t i = share * get_global_id(0); i < end; ++i) {
    const uint item = visits[i];
    const uint leaf = item % leafCount;
    if (i + FLOOD_FAR_AHEAD < entries) {
      const uint far = visits[i + FLOOD_FAR_AHEAD];
      FLOOD_FETCH(owned + (size_t)far * SHERD_LEAF_WORDS);
      FLOOD_FETCH(domain + (size_t)(far % leafCount) * SHERD_LEAF_WORDS);
      fetch_ahead(&state, before, far, visits[i + FLOOD_NEAR_AHEAD], step);
    }
    const ulong8 mine = vload8(item, owned);
    const ulong8 open = vload8(leaf, domain) & ~mine;  // reachable and not yet owned
    if (!any_of(open)) continue;
    struct arrival arrival = arrival_at(item, leaf, step);
    if (neighbors == 26) {
      arrive26(&state, before, mine, open, &arrival);
    } else {
      arrive6(&state, before, mine, open, &arrival);
    }
    if (!any_of(arrival.reached)) continue;
    const uint newTag = take(&state, before, mine, &arrival);
    if (keepCost) write_cost(&arrival, cost);
    vstore8(mine | arrival.reached, item, owned);
    publish(&state, &arrival, newTag, any_of(open & ~arrival.reached) != 0, &next);
  }
  flush_frontier(&next);
}

// Writes the labels of every leaf that is not mixed.
kernel void flood_finish(FLOOD_STATE)
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    if (tag[item] == SHERD_TAG_MIXED) continue;
    write_rows(vload8(item, owned), second_of(tag[item], (uint)item, second), tag[item],
               owner + item * SHERD_LEAF_SIZE);
  }
}

// Copies the labels of items first .. first+count-1 to `labels`.  Leaves that are not mixed never touch their memory in
// `owner`.
kernel void flood_show(
    FLOOD_STATE,
    const uint first,
    const uint count,
    global ushort* restrict labels)          // [count*512]  out
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint item = first + (uint)i;
    global ushort* const out = labels + i * SHERD_LEAF_SIZE;
    if (tag[item] == SHERD_TAG_MIXED) {
      for (int row = 0; row < 64; ++row) vstore8(vload8((size_t)item * 64 + row, owner), row, out);
    } else {
      write_rows(vload8(item, owned), second_of(tag[item], item, second), tag[item], out);
    }
  }
}
