// Data that leaves of flood.cl exchange: fronts and the list of the next step.
#ifndef SHERD_FLOOD_FRONT_H
#define SHERD_FLOOD_FRONT_H

// The voxels that an item reached in one step.  64 bytes, so reading a neighbor takes one cache line.
struct front {
  ulong face[SHERD_LEAF_FACES];  // see face_of
  uint step;
  uint tag;                      // of the item after that step
  ulong unused;
};

// Offset in `second` of an item's words of the second label on the faces of its front.
inline size_t second_faces(const uint item, const uint step) {
  return (3 * (size_t)item + 1 + (step & 1)) * SHERD_LEAF_WORDS;
}

// Index in `owner` of the voxel at the lowest set bit of a word of an item's face k.
inline size_t label_at(const uint item, const int k, const ulong bits) {
  return (size_t)item * SHERD_LEAF_SIZE + offset_at_face(k, lowest_bit(bits));
}

// The 26 neighbors of a leaf as indices into neighbors27 (x slowest, 13 the leaf): faces first, -x +x -y +y -z +z.
static constant uchar kBeside[26] = {4, 22, 10, 16, 12, 14, 0,  1,  2,  3,  5,  6,  7,
                              8, 9,  11, 15, 17, 18, 19, 20, 21, 23, 24, 25, 26};

// Returns the voxels of a front that are 26-adjacent to the leaf at index `beside` of neighbors27, as bits of a word of
// `face`.
inline ulong bordering(const int beside, const global ulong* face) {
  const int i = beside / 9, j = beside / 3 % 3, k = beside % 3;
  ulong bits = i != 1 ? face[i >> 1] : j != 1 ? face[2 + (j >> 1)] : face[4 + (k >> 1)];
  if (i != 1 && j != 1) bits &= j == 0 ? SHERD_Y0 : SHERD_Y7;
  if ((i != 1 || j != 1) && k != 1) bits &= k == 0 ? SHERD_Z0 : SHERD_Z7;
  return bits;
}

// Prefetches a cache line where kernels are compiled for a CPU; PoCL's prefetch() is empty.
#if defined(__x86_64__) || defined(__aarch64__)
#define FLOOD_FETCH(address) __builtin_prefetch(address)
#define FLOOD_FETCH_TO_WRITE(address) __builtin_prefetch(address, 1)
#else
#define FLOOD_FETCH(address)
#define FLOOD_FETCH_TO_WRITE(address)
#endif
#define FLOOD_NEAR_AHEAD 3  // list entries ahead whose neighbors' fronts are prefetched
#define FLOOD_FAR_AHEAD 6   // list entries ahead whose own state is prefetched

// Items that a work-item queues for the next step, appended to the list in batches: an atomic exchange waits for all
// earlier writes.
#define FLOOD_HELD 64
struct next_items {
  global uint* queued;
  global uint* list;
  global uint* listCount;
  uint step;
  uint held[FLOOD_HELD];  // may contain duplicates
  uint count;
};

inline struct next_items next_of(global uint* queued, global uint* list, global uint* listCount, const uint items,
                                 const uint step) {
  struct next_items next;
  next.queued = queued;
  next.list = list + (size_t)(step & 1) * items;
  next.listCount = listCount + step % 3;
  next.step = step;
  next.count = 0;
  return next;
}

inline void flush_frontier(struct next_items* next) {
  uint count = 0;
  for (uint i = 0; i < next->count; ++i) {
    const uint item = next->held[i];
    if (atomic_xchg(&next->queued[item], next->step) != next->step) next->held[count++] = item;
  }
  next->count = 0;
  if (!count) return;
  const uint at = atomic_add(next->listCount, count);
  for (uint i = 0; i < count; ++i) next->list[at + i] = next->held[i];
}

inline void enqueue_if(const int condition, struct next_items* next, const uint item) {
  FLOOD_FETCH_TO_WRITE(next->queued + item);
  next->held[next->count] = item;
  next->count += condition != 0;
}

// Writes the front of `item` in `step`; the voxels in `ofSecond` have the second label.
inline void write_front(const ulong8 reached, const ulong8 ofSecond, const uint item, const uint step, const uint tag,
                        global struct front* fronts, global ulong* second) {
  global struct front* const front = fronts + 2 * (size_t)item + (step & 1);
  front->step = step;
  front->tag = tag;
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) front->face[k] = face_of(k, reached);
  if (!is_pair(tag)) return;
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) second[second_faces(item, step) + k] = face_of(k, ofSecond);
}

// The members of FLOOD_STATE that functions take.
struct flood {
  const global uint* neighbor;
  const global uint* neighbors27;
  uint neighbors;
  uint leafCount;
  const global ulong* beyond;
  global uint* tag;
  global ulong* second;
  global ushort* owner;
  global struct front* fronts;
};
#define FLOOD_MEMBERS neighbor, neighbors27, neighbors, leafCount, beyond, tag, second, owner, fronts

// What arrives at an item in a step.
struct arrival {
  uint item, leaf, step;
  ulong8 reached;                   // voxels
  ulong8 ofSecond;                  // those that take the second label of a tag of two
  ulong through[SHERD_LEAF_FACES];  // reached through each face, as words of face_of; 0 over 26 neighbors
  uint source[27];                  // [neighbors27 index] items that they come from, else SHERD_NO_LEAF
};

inline struct arrival arrival_at(const uint item, const uint leaf, const uint step) {
  struct arrival arrival;
  arrival.item = item;
  arrival.leaf = leaf;
  arrival.step = step;
  arrival.reached = 0;
  arrival.ofSecond = 0;
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) arrival.through[k] = 0;
  for (int k = 0; k < 27; ++k) arrival.source[k] = SHERD_NO_LEAF;
  arrival.source[13] = item;
  return arrival;
}

// Prefetches the state of the item `far`, and the fronts beside the item `near`.
inline void fetch_ahead(const struct flood* state, const global struct front* before, const uint far, const uint near,
                        const uint step) {
  const uint farLeaf = far % state->leafCount, nearLeaf = near % state->leafCount;
  FLOOD_FETCH(state->neighbor + (size_t)farLeaf * SHERD_LEAF_FACES);
  FLOOD_FETCH(state->beyond + (size_t)farLeaf * SHERD_LEAF_FACES);
  FLOOD_FETCH(state->tag + far);
  FLOOD_FETCH_TO_WRITE(state->fronts + 2 * (size_t)far + (step & 1));
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    const uint other = state->neighbor[(size_t)nearLeaf * SHERD_LEAF_FACES + k];
    FLOOD_FETCH(before + 2 * (size_t)(other == SHERD_NO_LEAF ? near : near - nearLeaf + other));
  }
}

// Makes the reached voxels the front of the item and queues the items it can reach next, itself if `selfLeft`.  Voxels
// behind those that came through a face are owned already, so they queue no neighbor.
inline void publish(const struct flood* state, const struct arrival* arrival, const uint newTag, const int selfLeft,
                    struct next_items* next) {
  const uint item = arrival->item, leaf = arrival->leaf;
  write_front(arrival->reached, arrival->ofSecond, item, arrival->step, newTag, state->fronts, state->second);
  const global struct front* const front = state->fronts + 2 * (size_t)item + (arrival->step & 1);
  if (next->count > FLOOD_HELD - 27) flush_frontier(next);
  enqueue_if(selfLeft, next, item);
  if (state->neighbors == 26) {
    for (int n = 0; n < 26; ++n) {
      const uint other = state->neighbors27[(size_t)leaf * 27 + kBeside[n]];
      enqueue_if(other != SHERD_NO_LEAF && bordering(kBeside[n], front->face), next, item - leaf + other);
    }
    return;
  }
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    const size_t at = (size_t)leaf * SHERD_LEAF_FACES + k;
    enqueue_if((front->face[k] & ~arrival->through[k] & state->beyond[at]) != 0, next,
               item - leaf + state->neighbor[at]);
  }
}

#endif
