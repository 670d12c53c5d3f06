// levels: grow labels over the inside in the order of their arrival cost, with any step weights.
//
// A voxel belongs to the (cost, source) pair that is lowest among what its owned neighbours offer when its turn comes:
// one answer, whatever the order of work.  An offer over step k is
//   additive   cost[from] + weight[k]
//   chain      max(cost[from], distance from the source's seed to the voxel): the Discrete Voronoi Chain with its
//              distance check (Velic, May, Moresi 2009), as the largest distance met on the way
// Voxels are taken in rounds, each up to a threshold.  An additive round may reach `stride` further than the last, the
// least weight: nothing taken in it can offer that little.  A chain's threshold rises on a ladder of distances, `stride`
// rungs a voxel, and stays until a round takes nothing.  When a round takes nothing the threshold goes on to the least
// offer that waits.
//
// The best offer to each voxel is kept while it waits, so a round looks only at what the last one took: its offers are
// found a row of eight voxels at a time.
//
// A round has two launches, so that none reads what the same launch writes: levels_take reads what neighbours took in the
// round before and writes what it takes; levels_publish makes that owned and queues who can go on.
// item = fracture * leafCount + leaf; one work-item takes list entries i, i + all, ...; any work-group size.
// Reference: tests/kernels/levels_test.cpp, bit for bit.

// Words of `control`: written in round r at r modulo 3 (or 2), read in r + 1, cleared in between.
#define CONTROL_LIST 0       // [3] entries of the list of a round
#define CONTROL_WAITING 3    // [3] the least offer that waits
#define CONTROL_TAKEN 6      // [3] items that took something: entries of `taken`
#define CONTROL_THRESHOLD 9  // [2]

#define LEVELS_STATE                                                                                  \
  const global ulong *restrict inside,      /* [leafCount*8]  voxels that may be reached */           \
  const global uint *restrict round27,      /* [leafCount*27] leaves round a leaf, x slowest */       \
  const uint leafCount,                                                                               \
  const uint items,                                                                                   \
  global ulong *restrict owned,             /* [items*8] */                                           \
  global ulong *restrict offered,           /* [items*8]      not owned, but offered */               \
  global uint *restrict source,             /* [items*512]    label, or for a chain the seed */       \
  global uint *restrict cost,               /* [items*512]    of what is owned or offered */          \
  global ulong *restrict claim,             /* [2*items*8]    taken, by round parity */               \
  global uint *restrict claimed,            /* [2*items]      the round `claim` is of */              \
  global uint *restrict wake,               /* [items]        the least offer that waits here */      \
  volatile global uint *dirty,              /* [items]        1: a neighbour took something */        \
  volatile global uint *queued,             /* [items]        last round queued for */                \
  global uint *restrict list,               /* [2*items]      items to visit, by round parity */      \
  global uint *restrict taken,              /* [items]        items that took something */            \
  volatile global uint *control             /* [11] */

inline void enqueue(volatile global uint* queued, global uint* list, volatile global uint* control, const uint items,
                    const uint item, const uint round) {
  if (atomic_xchg(&queued[item], round) == round) return;
  const uint at = atomic_inc(&control[CONTROL_LIST + round % 3]);
  list[(size_t)(round & 1) * items + at] = item;
}

// Has an item voxels that are not owned?
inline int is_open(const global ulong* inside, const global ulong* owned, const uint leaf, const size_t item) {
  ulong open = 0;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    open |= inside[(size_t)leaf * SHERD_LEAF_WORDS + x] & ~owned[item * SHERD_LEAF_WORDS + x];
  }
  return open != 0;
}

// Begin from what is owned: queue every item that has something left to reach for round 1.
kernel void levels_begin(LEVELS_STATE)
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    if (!is_open(inside, owned, (uint)(item % leafCount), item)) continue;
    atomic_xchg(&dirty[item], 1u);
    enqueue(queued, list, control, items, (uint)item, 1);
  }
}

// What round 0 took is what the beginning owns.
inline void own(global ulong* owned, global ulong* claim, const size_t word, const ulong mask) {
  owned[word] |= mask;
  claim[word] = owned[word];
}

// Own what is kept of labels that exist.
kernel void levels_keep(LEVELS_STATE, const global ulong* restrict kept)  // [items*8]
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const size_t word = item * SHERD_LEAF_WORDS + x;
      own(owned, claim, word, kept[word]);
    }
  }
}

// What is owned offers from cost 0 on.  Only what lies by something open is ever asked, so that memory of all else is
// not touched.
kernel void levels_load(LEVELS_STATE, const global ushort* restrict label)  // [items*512]
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    const uint leaf = (uint)(item % leafCount);
    int near = 0;
    for (int k = 0; k < 27 && !near; ++k) {
      const uint other = round27[(size_t)leaf * 27 + k];
      near = other != SHERD_NO_LEAF && is_open(inside, owned, other, item - leaf + other);
    }
    if (!near) continue;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      for (ulong bits = owned[item * SHERD_LEAF_WORDS + x]; bits; bits &= bits - 1) {
        const size_t v = item * SHERD_LEAF_SIZE + (x << 6) + lowest_bit(bits);
        source[v] = label[v];
        cost[v] = 0;
      }
    }
  }
}

// Write what was reached into the labels that were loaded, and 0 where nothing was.
kernel void levels_save(
    LEVELS_STATE,
    const global ulong* restrict kept,  // [items*8]
    global ushort* restrict label)      // [items*512]  in, out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const size_t word = item * SHERD_LEAF_WORDS + x;
      for (ulong bits = inside[(item % leafCount) * SHERD_LEAF_WORDS + x] & ~kept[word]; bits; bits &= bits - 1) {
        const int bit = lowest_bit(bits);
        const size_t v = item * SHERD_LEAF_SIZE + (x << 6) + bit;
        label[v] = (owned[word] >> bit) & 1 ? (ushort)source[v] : (ushort)0;
      }
    }
  }
}

// Own the seeds, at cost 0.  One work-item per item that holds seeds.
kernel void levels_seed(
    LEVELS_STATE,
    const global uint* restrict seedItem,      // [seedItems]    distinct
    const global uint* restrict firstSeed,     // [seedItems+1]
    const global ushort* restrict seedOffset,  // [seeds]
    const global uint* restrict seedSource,    // [seeds]
    const uint seedItems)
{
  for (size_t i = get_global_id(0); i < seedItems; i += get_global_size(0)) {
    const size_t item = seedItem[i];
    for (uint s = firstSeed[i]; s < firstSeed[i + 1]; ++s) {
      const uint offset = seedOffset[s];
      own(owned, claim, item * SHERD_LEAF_WORDS + (offset >> 6), 1ul << (offset & 63));
      source[item * SHERD_LEAF_SIZE + offset] = seedSource[s];
      cost[item * SHERD_LEAF_SIZE + offset] = 0;
    }
  }
}

// A leaf and what lies up to two voxels round it, a bit per voxel: rows along z, 12 by 12 of them.
#define HALO 2
#define HALO_SIDE 12

inline void clear_halo(ushort* halo) {
  for (int i = 0; i < HALO_SIDE * HALO_SIDE; ++i) halo[i] = 0;
}

// Add what neighbour k's mask has within the halo.
inline void add_to_halo(const global ulong* mask, const int k, ushort* halo) {
  const int dx = k / 9 - 1, dy = k / 3 % 3 - 1, dz = k % 3 - 1;
  for (int x = dx < 0 ? 8 - HALO : 0; x < (dx > 0 ? HALO : 8); ++x) {
    const ulong word = mask[x];
    if (!word) continue;
    for (int y = dy < 0 ? 8 - HALO : 0; y < (dy > 0 ? HALO : 8); ++y) {
      const uint bits = (uint)(word >> (8 * y)) & 0xff;
      const uint row = dz < 0 ? bits >> (8 - HALO) : (dz == 0 ? bits << HALO : (bits << (8 + HALO)) & 0xfff);
      halo[(x + 8 * dx + HALO) * HALO_SIDE + y + 8 * dy + HALO] |= (ushort)row;
    }
  }
}

// The eight bits of the row at x, y that lie z beyond the leaf's own.
inline uint halo_row(const ushort* halo, const int x, const int y, const int z) {
  return (uint)halo[(x + HALO) * HALO_SIDE + y + HALO] >> (z + HALO) & 0xff;
}

// The rows of slab x, a bit each, that have something of the halo at most two rows away.
inline uint rows_near(const ushort* halo, const int x) {
  uint rows = 0;
  for (int y = 0; y < HALO_SIDE; ++y) {
    uint any = 0;
    for (int dx = 0; dx <= 2 * HALO; ++dx) any |= halo[(x + dx) * HALO_SIDE + y];
    if (any) rows |= 0x1fu << y;
  }
  return (rows >> 4) & 0xff;
}

// Do steps lead out of a leaf to neighbour k?  Six lead over faces only.
inline int leads_to(const int k, const uint steps) {
  return steps > 6 || (k % 3 != 1) + (k / 3 % 3 != 1) + (k / 9 != 1) <= 1;
}

// The least rung of the chain's ladder that is not below a distance.
inline uint rung_above(const uint distance, const int kind, const uint stride) {
  if (kind != SHERD_EUCLIDEAN) return distance;  // whole voxels are the ladder
  // The least n with (n / stride)^2 >= distance, found bit by bit.
  ulong n = 0;
  for (int bit = 20; bit >= 0; --bit) {
    const ulong higher = n | (1ul << bit);
    if (higher * higher < (ulong)distance * stride * stride) n = higher;
  }
  ++n;
  return (uint)(n * n / ((ulong)stride * stride));
}

kernel void levels_take(
    LEVELS_STATE,
    const uint round,                        // 1, 2, ...
    const global int4* restrict step,        // [steps]     x, y, z to the voxel that is reached, w the weight
    const global int* restrict within,       // [steps*2]   voxels between, as offsets from the one left; 0: none
    const uint steps,
    const uint chain,                        // 1: the chain's rule
    const uint stride,
    const struct sherd_metric metric,
    const global int4* restrict seed,        // [seeds]     voxel
    const global int4* restrict origin)      // [leafCount]
{
  const uint now = round % 3, last = (round + 2) % 3;
  const uint before = control[CONTROL_THRESHOLD + ((round + 1) & 1)];
  uint threshold;
  if (control[CONTROL_TAKEN + last]) {
    threshold = chain ? before : before + stride;
  } else {
    const uint least = control[CONTROL_WAITING + last];
    threshold = chain ? rung_above(least, metric.kind, stride) : least + stride - 1;
    if (least == 0xffffffffu) threshold = before;  // nothing waits: the first round
  }
  if (get_global_id(0) == 0) {
    control[CONTROL_THRESHOLD + (round & 1)] = threshold;
    control[CONTROL_LIST + (round + 2) % 3] = 0;
    control[CONTROL_WAITING + (round + 1) % 3] = 0xffffffffu;
    control[CONTROL_TAKEN + (round + 1) % 3] = 0;
  }
  const uint entries = control[CONTROL_LIST + now];
  for (size_t i = get_global_id(0); i < entries; i += get_global_size(0)) {
    const uint item = list[(size_t)(round & 1) * items + i];
    const uint leaf = item % leafCount;
    const uint base = item - leaf;
    if (!atomic_xchg(&dirty[item], 0u) && wake[item] > threshold) {
      atomic_min(&control[CONTROL_WAITING + now], wake[item]);
      enqueue(queued, list, control, items, item, round + 1);
      continue;
    }
    const global ulong* solid = inside + (size_t)leaf * SHERD_LEAF_WORDS;
    const global ulong* own = owned + (size_t)item * SHERD_LEAF_WORDS;
    global ulong* waiting = offered + (size_t)item * SHERD_LEAF_WORDS;
    uint least = wake[item];

    // Offers of what the last round took.
    uint around[27];
    ushort fresh[HALO_SIDE * HALO_SIDE], inSolid[HALO_SIDE * HALO_SIDE];
    const size_t lastItems = (size_t)((round + 1) & 1) * items;
    int anyFresh = 0;
    for (int k = 0; k < 27; ++k) {
      around[k] = round27[(size_t)leaf * 27 + k];
      if (around[k] == SHERD_NO_LEAF || !leads_to(k, steps)) continue;
      const size_t other = lastItems + base + around[k];
      if (claimed[other] != round - 1) continue;
      if (!anyFresh) clear_halo(fresh);
      anyFresh = 1;
      add_to_halo(claim + other * SHERD_LEAF_WORDS, k, fresh);
    }
    if (anyFresh && steps > 26) {
      clear_halo(inSolid);
      for (int k = 0; k < 27; ++k) {
        if (around[k] != SHERD_NO_LEAF) add_to_halo(inside + (size_t)around[k] * SHERD_LEAF_WORDS, k, inSolid);
      }
    }
    for (int x = 0; anyFresh && x < SHERD_LEAF_WORDS; ++x) {
      const ulong openSlab = solid[x] & ~own[x];
      ulong offeredSlab = waiting[x];
      for (uint rows = openSlab ? rows_near(fresh, x) : 0; rows; rows &= rows - 1) {
        const int y = lowest_bit(rows);
        const uint open = (uint)(openSlab >> (8 * y)) & 0xff;
        if (!open) continue;
        for (uint k = 0; k < steps; ++k) {
          const int4 s = step[k];
          uint reached = open & halo_row(fresh, x - s.x, y - s.y, -s.z);
          if (!reached) continue;
          if (k >= 26) {  // a long step: the voxels it passes over belong to the solid
            for (int j = 0; j < 2; ++j) {
              const int packed = within[2 * k + j];
              const int px = ((packed >> 8) & 15) - 4, py = ((packed >> 4) & 15) - 4, pz = (packed & 15) - 4;
              reached &= halo_row(inSolid, x - s.x + px, y - s.y + py, pz - s.z);
            }
          }
          for (; reached; reached &= reached - 1) {
            const int z = lowest_bit(reached);
            const int4 from = (int4)(x, y, z, 0) - s;
            const uint other = around[((from.x >> 3) + 1) * 9 + ((from.y >> 3) + 1) * 3 + (from.z >> 3) + 1];
            const size_t there = (size_t)(base + other) * SHERD_LEAF_SIZE +
                                 (((from.x & 7) << 6) | ((from.y & 7) << 3) | (from.z & 7));
            uint offer = cost[there];
            const uint offers = source[there];
            if (chain) {
              const int4 p = origin[leaf] + (int4)(x, y, z, 0) - seed[offers];
              offer = max(offer, (uint)(sherd_distance(&metric, p.x, p.y, p.z) >> metric.shift));
            } else {
              offer += (uint)s.w;
            }
            const ulong bit = 1ul << (8 * y + z);
            const size_t here = (size_t)item * SHERD_LEAF_SIZE + (x << 6) + 8 * y + z;
            if (!(offeredSlab & bit) || offer < cost[here] || (offer == cost[here] && offers < source[here])) {
              offeredSlab |= bit;
              cost[here] = offer;
              source[here] = offers;
              least = min(least, offer);
            }
          }
        }
      }
      waiting[x] = offeredSlab;
    }

    // Take what is within the threshold; `least` becomes the least that still waits.
    ulong took = 0;
    if (least <= threshold) {
      least = 0xffffffffu;
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        ulong taking = 0;
        for (ulong bits = waiting[x]; bits; bits &= bits - 1) {
          const int bit = lowest_bit(bits);
          const uint offer = cost[(size_t)item * SHERD_LEAF_SIZE + (x << 6) + bit];
          if (offer <= threshold) {
            taking |= 1ul << bit;
          } else {
            least = min(least, offer);
          }
        }
        claim[((size_t)(round & 1) * items + item) * SHERD_LEAF_WORDS + x] = taking;
        waiting[x] &= ~taking;
        took |= taking;
      }
    }
    wake[item] = least;
    if (least != 0xffffffffu) {
      atomic_min(&control[CONTROL_WAITING + now], least);
      enqueue(queued, list, control, items, item, round + 1);
    }
    if (took) {
      claimed[(size_t)(round & 1) * items + item] = round;
      taken[atomic_inc(&control[CONTROL_TAKEN + now])] = item;
    }
  }
}

// Own what was taken, and queue every item that may be offered something by it.
kernel void levels_publish(LEVELS_STATE, const uint round, const uint steps)
{
  const uint entries = control[CONTROL_TAKEN + round % 3];
  for (size_t i = get_global_id(0); i < entries; i += get_global_size(0)) {
    const uint item = taken[i];
    const uint leaf = item % leafCount;
    ulong any = 0, lowX = 0, highX = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong taking = claim[((size_t)(round & 1) * items + item) * SHERD_LEAF_WORDS + x];
      owned[(size_t)item * SHERD_LEAF_WORDS + x] |= taking;
      any |= taking;
      if (x < HALO) lowX |= taking;
      if (x >= 8 - HALO) highX |= taking;
    }
    for (int k = 0; k < 27; ++k) {
      if (!leads_to(k, steps)) continue;
      const int dx = k / 9 - 1, dy = k / 3 % 3 - 1, dz = k % 3 - 1;
      ulong near = dx < 0 ? lowX : (dx > 0 ? highX : any);
      if (dy) near &= dy < 0 ? 0x000000000000fffful : 0xffff000000000000ul;
      if (dz) near &= dz < 0 ? 0x0303030303030303ul : 0xc0c0c0c0c0c0c0c0ul;
      const uint other = round27[(size_t)leaf * 27 + k];
      if (!near || other == SHERD_NO_LEAF) continue;
      ulong reachable = 0;
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        reachable |= inside[(size_t)other * SHERD_LEAF_WORDS + x];
      }
      if (!reachable) continue;
      atomic_xchg(&dirty[item - leaf + other], 1u);
      enqueue(queued, list, control, items, item - leaf + other, round + 1);
    }
  }
}

// The label of every voxel that is owned, and 0 elsewhere.
kernel void levels_finish(
    LEVELS_STATE,
    const global ushort* restrict labelOfSource,  // [seeds]  read when a chain
    const uint chain,
    global ushort* restrict owner)                // [items*512]  out
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      const int isOwned = (int)((owned[item * SHERD_LEAF_WORDS + (v >> 6)] >> (v & 63)) & 1);
      const size_t at = item * SHERD_LEAF_SIZE + v;
      uint label = 0;
      if (isOwned) label = chain ? labelOfSource[source[at]] : source[at];
      owner[at] = (ushort)label;
    }
  }
}
