// What flood.cl's leaves know of each other: tags, fronts and the list of the next step.
#ifndef SHERD_FLOOD_FRONT_H
#define SHERD_FLOOD_FRONT_H

// What an item reached in a step.  64 bytes, so that looking at a neighbour takes one cache line.
struct front {
  ulong face[SHERD_LEAF_FACES];  // see face_of
  uint step;
  uint tag;                      // the item's, as it then was
  ulong unused;
};

// A tag with one label more, or 0.
inline uint with_label(const uint tag, const uint label) {
  const uint low = tag & 0xffff, high = tag >> 16;
  if (label == 0 || label == low || label == high || tag == SHERD_TAG_MIXED) return tag;
  if (high != 0) return SHERD_TAG_MIXED;
  return low == 0 ? label : min(low, label) | max(low, label) << 16;
}

inline int is_pair(const uint tag) { return tag >> 16 != 0 && tag != SHERD_TAG_MIXED; }

// Where `second` has an item's voxels of the second label, and its front's faces of them.
inline size_t second_voxels(const uint item) { return 3 * (size_t)item; }
inline size_t second_faces(const uint item, const uint step) {
  return (3 * (size_t)item + 1 + (step & 1)) * SHERD_LEAF_WORDS;
}

// Where `owner` has the label of the lowest bit of a word of an item's face k.
inline size_t label_at(const uint item, const int k, const ulong bits) {
  return (size_t)item * SHERD_LEAF_SIZE + offset_at_face(k, lowest_bit(bits));
}

// The leaves beside one as round27 has them, x slowest, 13 itself: those over faces first, -x +x -y +y -z +z.
constant uchar kBeside[26] = {4, 22, 10, 16, 12, 14, 0,  1,  2,  3,  5,  6,  7,
                              8, 9,  11, 15, 17, 18, 19, 20, 21, 23, 24, 25, 26};

// Of a front's voxels those that border on the leaf at `beside`, as one of its faces shows them.
inline ulong bordering(const int beside, const global ulong* face) {
  const int i = beside / 9, j = beside / 3 % 3, k = beside % 3;
  ulong bits = i != 1 ? face[i >> 1] : j != 1 ? face[2 + (j >> 1)] : face[4 + (k >> 1)];
  if (i != 1 && j != 1) bits &= j == 0 ? SHERD_Y0 : SHERD_Y7;
  if ((i != 1 || j != 1) && k != 1) bits &= k == 0 ? SHERD_Z0 : SHERD_Z7;
  return bits;
}

// Ask for a cache line before it is needed, where kernels are compiled straight for a CPU: PoCL's prefetch() is empty.
#if defined(__x86_64__) || defined(__aarch64__)
#define FLOOD_FETCH(address) __builtin_prefetch(address)
#define FLOOD_FETCH_TO_WRITE(address) __builtin_prefetch(address, 1)
#else
#define FLOOD_FETCH(address)
#define FLOOD_FETCH_TO_WRITE(address)
#endif
#define FLOOD_NEAR_AHEAD 3  // entries of the list ahead: what their neighbours reached
#define FLOOD_FAR_AHEAD 6   // and what they have themselves

// What a work-item queues for the next step is held back, and put on the list some at a time: an atomic exchange waits
// for all that was written before it.
#define FLOOD_HELD 64
struct next_items {
  global uint* queued;
  global uint* list;
  global uint* listCount;
  uint step;
  uint held[FLOOD_HELD];  // some of them twice
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

inline void let_go(struct next_items* next) {
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

inline void enqueue_if(const int wanted, struct next_items* next, const uint item) {
  FLOOD_FETCH_TO_WRITE(next->queued + item);
  next->held[next->count] = item;
  next->count += wanted != 0;
}

// The front of `item` in `step`, of which `ofSecond` has the second label.
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

// Make `reached` the front of `item` in `step`, and queue who can go on from it.  `arrived` is what it was reached by
// over faces: who was there before needs not be told.
inline void publish(const ulong8 reached, const ulong8 ofSecond, const ulong* arrived, const int selfLeft,
                    const uint item, const uint leaf, const uint step, const uint newTag, const global ulong* beyond,
                    const global uint* neighbour, const global uint* round27, const uint neighbours,
                    global struct front* fronts, global ulong* second, struct next_items* next) {
  write_front(reached, ofSecond, item, step, newTag, fronts, second);
  const global struct front* const front = fronts + 2 * (size_t)item + (step & 1);
  if (next->count > FLOOD_HELD - 27) let_go(next);
  enqueue_if(selfLeft, next, item);
  if (neighbours == 26) {
    for (int n = 0; n < 26; ++n) {
      const uint other = round27[(size_t)leaf * 27 + kBeside[n]];
      enqueue_if(other != SHERD_NO_LEAF && bordering(kBeside[n], front->face), next, item - leaf + other);
    }
    return;
  }
#pragma unroll
  for (int k = 0; k < SHERD_LEAF_FACES; ++k) {
    const size_t at = (size_t)leaf * SHERD_LEAF_FACES + k;
    enqueue_if((front->face[k] & ~arrived[k] & beyond[at]) != 0, next, item - leaf + neighbour[at]);
  }
}

#endif
