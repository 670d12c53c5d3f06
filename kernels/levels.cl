// levels: grow labels over the inside in the order of their arrival cost, with any step weights.
//
// A voxel belongs to the lowest (cost, source) pair among the offers of its owned neighbors at the time it is taken, so
// the result does not depend on the schedule.  An offer over step k is
//   additive   cost[from] + weight[k]
//   chain      max(cost[from], distance from the source's seed to the voxel): the Discrete Voronoi Chain with its
//              distance check (Velic, May, Moresi 2009), as the largest distance on the path
// Voxels are taken in passes, each up to a threshold, by buckets as in delta-stepping (Meyer and Sanders 2003).  An
// additive threshold rises by `stride`, the least weight, per pass: no voxel taken in a pass can offer that little.  A
// chain's threshold rises by buckets of distance, `stride` buckets per voxel, and stays until a pass takes nothing.
// When a pass takes nothing the threshold rises to the least waiting offer.
//
// The best offer to each voxel is stored while it waits, so a pass reads only what the last one took; it computes those
// offers one row of eight voxels at a time.
//
// A pass has two launches, so that none reads what it writes: levels_take reads what neighbors took in the previous
// pass and writes what it takes; levels_publish makes those voxels owned and queues the items they can offer to.
// item = fracture * leafCount + leaf; one work-item takes list entries i, i + all, ...; any work-group size.
// Reference: tests/kernels/growths_test.cpp, bit for bit.

// Words of `control`: written in pass p at p modulo 3 (or 2), read in p + 1, cleared in between.
#define CONTROL_LIST 0       // [3] entries of the list of a pass
#define CONTROL_WAITING 3    // [3] least waiting offer
#define CONTROL_TAKEN 6      // [3] entries of `taken`
#define CONTROL_THRESHOLD 9  // [2]

#define LEVELS_STATE                                                                                  \
  const global ulong *restrict inside,      /* [leafCount*8]  voxels that may be reached */           \
  const global uint *restrict neighbors27,  /* [leafCount*27] 26-neighborhood of a leaf, x slowest */ \
  const uint leafCount,                                                                               \
  const uint items,                                                                                   \
  global ulong *restrict owned,             /* [items*8] */                                           \
  global ulong *restrict offered,           /* [items*8]      not owned, but offered */               \
  global uint *restrict source,             /* [items*512]    label, or for a chain the seed */       \
  global uint *restrict cost,               /* [items*512]    of owned or offered voxels */           \
  global ulong *restrict claim,             /* [2*items*8]    taken voxels, by pass parity */         \
  global uint *restrict claimed,            /* [2*items]      the pass that wrote `claim` */          \
  global uint *restrict wake,               /* [items]        least waiting offer of the item */      \
  volatile global uint *dirty,              /* [items]        1: a neighbor took a voxel */           \
  volatile global uint *queued,             /* [items]        last pass queued for */                 \
  global uint *restrict list,               /* [2*items]      items to visit, by pass parity */       \
  global uint *restrict taken,              /* [items]        items that took a voxel */              \
  volatile global uint *control             /* [11] */

// The members of LEVELS_STATE that functions take, and the item at hand.  (No arrays: PoCL keeps a struct with an array in
// memory, and reads all of it again after each store.)
struct levels {
  const global ulong* inside;
  const global uint* neighbors27;
  uint items;
  const global ulong* owned;
  global ulong* offered;
  global uint* source;
  global uint* cost;
  global ulong* claim;
  const global uint* claimed;
  uint item, leaf;
};
#define LEVELS_MEMBERS inside, neighbors27, items, owned, offered, source, cost, claim, claimed

inline void enqueue(volatile global uint* queued, global uint* list, volatile global uint* control, const uint items,
                    const uint item, const uint pass) {
  if (atomic_xchg(&queued[item], pass) == pass) return;
  const uint at = atomic_inc(&control[CONTROL_LIST + pass % 3]);
  list[(size_t)(pass & 1) * items + at] = item;
}

// Returns whether an item has inside voxels that are not owned.
inline int is_open(const global ulong* inside, const global ulong* owned, const uint leaf, const size_t item) {
  ulong open = 0;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    open |= inside[(size_t)leaf * SHERD_LEAF_WORDS + x] & ~owned[item * SHERD_LEAF_WORDS + x];
  }
  return open != 0;
}

// Starts from the owned voxels: queues every item with open voxels for pass 1.
kernel void levels_begin(LEVELS_STATE)
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    if (!is_open(inside, owned, (uint)(item % leafCount), item)) continue;
    atomic_xchg(&dirty[item], 1u);
    enqueue(queued, list, control, items, (uint)item, 1);
  }
}

// Owns voxels at the start; they are the claim of pass 0.
inline void own(global ulong* owned, global ulong* claim, const size_t word, const ulong mask) {
  owned[word] |= mask;
  claim[word] = owned[word];
}

// Owns the kept voxels of existing labels.
kernel void levels_keep(LEVELS_STATE, const global ulong* restrict kept)  // [items*8]
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const size_t word = item * SHERD_LEAF_WORDS + x;
      own(owned, claim, word, kept[word]);
    }
  }
}

// Gives owned voxels cost 0 and their label as source.
kernel void levels_load(LEVELS_STATE, const global ushort* restrict label)  // [items*512]
{
  for (size_t item = get_global_id(0); item < items; item += get_global_size(0)) {
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      for (ulong bits = owned[item * SHERD_LEAF_WORDS + x]; bits; bits &= bits - 1) {
        const size_t v = item * SHERD_LEAF_SIZE + (x << 6) + lowest_bit(bits);
        source[v] = label[v];
        cost[v] = 0;
      }
    }
  }
}

// Writes the reached voxels into the loaded labels, and 0 for voxels that were not reached.
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

// Owns the seeds at cost 0.  One work-item per item with seeds.
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

// A leaf with a halo of two voxels, one bit per voxel: 12 x 12 rows along z.
#define HALO 2
#define HALO_SIDE 12

inline void clear_halo(ushort* halo) {
  for (int i = 0; i < HALO_SIDE * HALO_SIDE; ++i) halo[i] = 0;
}

// Adds the voxels of neighbor k's mask that lie in the halo.
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

// Returns the eight bits of the row at x, y, shifted by z.
inline uint halo_row(const ushort* halo, const int x, const int y, const int z) {
  return (uint)halo[(x + HALO) * HALO_SIDE + y + HALO] >> (z + HALO) & 0xff;
}

// Returns the rows of slab x, one bit each, with a voxel of the halo at most two rows away.
inline uint rows_near(const ushort* halo, const int x) {
  uint rows = 0;
  for (int y = 0; y < HALO_SIDE; ++y) {
    uint any = 0;
    for (int dx = 0; dx <= 2 * HALO; ++dx) any |= halo[(x + dx) * HALO_SIDE + y];
    if (any) rows |= 0x1fu << y;
  }
  return (rows >> 4) & 0xff;
}

// Returns whether steps lead out of a leaf to neighbor k; 6 steps lead over faces only.
inline int leads_to(const int k, const uint steps) {
  return steps > 6 || (k % 3 != 1) + (k / 3 % 3 != 1) + (k / 9 != 1) <= 1;
}

// Returns the least bucket bound of a chain that is not below a distance.
inline uint bucket_above(const uint distance, const int kind, const uint stride) {
  if (kind != SHERD_EUCLIDEAN) return distance;  // the bounds are whole voxels
  // The least n with (n / stride)^2 >= distance, found bit by bit.
  ulong n = 0;
  for (int bit = 20; bit >= 0; --bit) {
    const ulong higher = n | (1ul << bit);
    if (higher * higher < (ulong)distance * stride * stride) n = higher;
  }
  ++n;
  return (uint)(n * n / ((ulong)stride * stride));
}

// What an offer costs; the members are the arguments of levels_take.
struct growth_rule {
  const global int4* step;
  const global int* within;
  uint steps;
  uint chain;
  uint stride;
  const struct sherd_metric* metric;
  const global int4* seed;
  const global int4* origin;
};

// The voxels around an item.
struct surroundings {
  uint neighbor[27];                    // leaves
  ushort fresh[HALO_SIDE * HALO_SIDE];  // voxels that the last pass took
  ushort solid[HALO_SIDE * HALO_SIDE];  // inside voxels; set for long steps only
};

// Returns the threshold of a pass, from that of the last pass and what it took.
inline uint threshold_of(volatile global uint* control, const uint pass, const struct growth_rule* rule) {
  const uint last = (pass + 2) % 3;
  const uint before = control[CONTROL_THRESHOLD + ((pass + 1) & 1)];
  if (control[CONTROL_TAKEN + last]) return rule->chain ? before : before + rule->stride;
  const uint least = control[CONTROL_WAITING + last];
  if (least == 0xffffffffu) return before;  // no offer waits: the first pass
  return rule->chain ? bucket_above(least, rule->metric->kind, rule->stride) : least + rule->stride - 1;
}

// Finds the voxels around an item that the last pass took; returns whether there are any.
inline int find_fresh(const struct levels* state, const uint pass, const uint steps, struct surroundings* around) {
  const size_t lastItems = (size_t)((pass + 1) & 1) * state->items + state->item - state->leaf;
  int any = 0;
  for (int k = 0; k < 27; ++k) {
    const uint leaf = state->neighbors27[(size_t)state->leaf * 27 + k];
    around->neighbor[k] = leaf;
    if (leaf == SHERD_NO_LEAF || !leads_to(k, steps)) continue;
    if (state->claimed[lastItems + leaf] != pass - 1) continue;
    if (!any) clear_halo(around->fresh);
    any = 1;
    add_to_halo(state->claim + (lastItems + leaf) * SHERD_LEAF_WORDS, k, around->fresh);
  }
  if (!any || steps <= 26) return any;
  clear_halo(around->solid);
  for (int k = 0; k < 27; ++k) {
    const uint leaf = around->neighbor[k];
    if (leaf != SHERD_NO_LEAF) add_to_halo(state->inside + (size_t)leaf * SHERD_LEAF_WORDS, k, around->solid);
  }
  return any;
}

// Returns the voxels of the row at x, y that step k reaches from voxels taken in the last pass, of those in `open`.
inline uint reached_by(const struct growth_rule* rule, const uint k, const struct surroundings* around, const int x,
                       const int y, const uint open) {
  const int4 s = rule->step[k];
  uint reached = open & halo_row(around->fresh, x - s.x, y - s.y, -s.z);
  if (!reached || k < 26) return reached;
  for (int j = 0; j < 2; ++j) {  // a long step: the voxels it crosses must be inside
    const int packed = rule->within[2 * k + j];
    const int px = ((packed >> 8) & 15) - 4, py = ((packed >> 4) & 15) - 4, pz = (packed & 15) - 4;
    reached &= halo_row(around->solid, x - s.x + px, y - s.y + py, pz - s.z);
  }
  return reached;
}

// Offers over a step to the voxel `at`.  The better offer stays.
inline void offer_over(const struct levels* state, const struct growth_rule* rule, const struct surroundings* around,
                       const int4 step, const int4 at, ulong* offered, uint* least) {
  const int4 from = at - step;
  const uint leaf = around->neighbor[((from.x >> 3) + 1) * 9 + ((from.y >> 3) + 1) * 3 + (from.z >> 3) + 1];
  const size_t there = (size_t)(state->item - state->leaf + leaf) * SHERD_LEAF_SIZE +
                       (((from.x & 7) << 6) | ((from.y & 7) << 3) | (from.z & 7));
  uint cost = state->cost[there];
  const uint source = state->source[there];
  if (rule->chain) {
    const int4 p = rule->origin[state->leaf] + at - rule->seed[source];
    cost = max(cost, (uint)(sherd_distance(rule->metric, p.x, p.y, p.z) >> rule->metric->shift));
  } else {
    cost += (uint)step.w;
  }
  const ulong bit = 1ul << (8 * at.y + at.z);
  const size_t here = (size_t)state->item * SHERD_LEAF_SIZE + (at.x << 6) + 8 * at.y + at.z;
  if (!(*offered & bit) || cost < state->cost[here] || (cost == state->cost[here] && source < state->source[here])) {
    *offered |= bit;
    state->cost[here] = cost;
    state->source[here] = source;
    *least = min(*least, cost);
  }
}

// Makes the offers of the voxels that the last pass took to an item's open voxels.
inline void make_offers(const struct levels* state, const struct growth_rule* rule, const struct surroundings* around,
                        uint* least) {
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    const size_t word = (size_t)state->item * SHERD_LEAF_WORDS + x;
    const ulong openSlab = state->inside[(size_t)state->leaf * SHERD_LEAF_WORDS + x] & ~state->owned[word];
    ulong offered = state->offered[word];
    for (uint rows = openSlab ? rows_near(around->fresh, x) : 0; rows; rows &= rows - 1) {
      const int y = lowest_bit(rows);
      const uint open = (uint)(openSlab >> (8 * y)) & 0xff;
      for (uint k = 0; open && k < rule->steps; ++k) {
        for (uint reached = reached_by(rule, k, around, x, y, open); reached; reached &= reached - 1) {
          offer_over(state, rule, around, rule->step[k], (int4)(x, y, lowest_bit(reached), 0), &offered, least);
        }
      }
    }
    state->offered[word] = offered;
  }
}

// Takes an item's offers within the threshold; returns whether there were any.  `least`: of the offers that still wait.
inline int take_offers(const struct levels* state, const uint pass, const uint threshold, uint* least) {
  ulong took = 0;
  *least = 0xffffffffu;
  for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
    const size_t word = (size_t)state->item * SHERD_LEAF_WORDS + x;
    const ulong offered = state->offered[word];
    ulong taking = 0;
    for (ulong bits = offered; bits; bits &= bits - 1) {
      const int bit = lowest_bit(bits);
      const uint cost = state->cost[(size_t)state->item * SHERD_LEAF_SIZE + (x << 6) + bit];
      if (cost <= threshold) {
        taking |= 1ul << bit;
      } else {
        *least = min(*least, cost);
      }
    }
    state->claim[(size_t)(pass & 1) * state->items * SHERD_LEAF_WORDS + word] = taking;
    state->offered[word] = offered & ~taking;
    took |= taking;
  }
  return took != 0;
}

// Takes the offers within the pass's threshold, of the listed items.
kernel void levels_take(
    LEVELS_STATE,
    const uint pass,                         // 1, 2, ...
    const global int4* restrict step,        // [steps]     x, y, z of the step, w its weight
    const global int* restrict within,       // [steps*2]   offsets from the start of the voxels between, packed
    const uint steps,
    const uint chain,                        // 1: the chain's rule
    const uint stride,
    const struct sherd_metric metric,
    const global int4* restrict seed,        // [seeds]     voxel
    const global int4* restrict origin)      // [leafCount]
{
  struct levels state = {LEVELS_MEMBERS, 0, 0};
  const struct growth_rule rule = {step, within, steps, chain, stride, &metric, seed, origin};
  const uint now = pass % 3;
  const uint threshold = threshold_of(control, pass, &rule);
  if (get_global_id(0) == 0) {
    control[CONTROL_THRESHOLD + (pass & 1)] = threshold;
    control[CONTROL_LIST + (pass + 2) % 3] = 0;
    control[CONTROL_WAITING + (pass + 1) % 3] = 0xffffffffu;
    control[CONTROL_TAKEN + (pass + 1) % 3] = 0;
  }
  const uint entries = control[CONTROL_LIST + now];
  for (size_t i = get_global_id(0); i < entries; i += get_global_size(0)) {
    const uint item = list[(size_t)(pass & 1) * items + i];
    uint least = wake[item];
    int took = 0;
    if (atomic_xchg(&dirty[item], 0u) || least <= threshold) {
      struct surroundings around;
      state.item = item;
      state.leaf = item % leafCount;
      if (find_fresh(&state, pass, steps, &around)) make_offers(&state, &rule, &around, &least);
      if (least <= threshold) took = take_offers(&state, pass, threshold, &least);
      wake[item] = least;
    }
    if (least != 0xffffffffu) {
      atomic_min(&control[CONTROL_WAITING + now], least);
      enqueue(queued, list, control, items, item, pass + 1);
    }
    if (took) {
      claimed[(size_t)(pass & 1) * items + item] = pass;
      taken[atomic_inc(&control[CONTROL_TAKEN + now])] = item;
    }
  }
}

// Owns the taken voxels and queues every item that they can offer to.
kernel void levels_publish(LEVELS_STATE, const uint pass, const uint steps)
{
  const uint entries = control[CONTROL_TAKEN + pass % 3];
  for (size_t i = get_global_id(0); i < entries; i += get_global_size(0)) {
    const uint item = taken[i];
    const uint leaf = item % leafCount;
    ulong any = 0, lowX = 0, highX = 0;
    for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
      const ulong taking = claim[((size_t)(pass & 1) * items + item) * SHERD_LEAF_WORDS + x];
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
      const uint other = neighbors27[(size_t)leaf * 27 + k];
      if (!near || other == SHERD_NO_LEAF) continue;
      ulong reachable = 0;
      for (int x = 0; x < SHERD_LEAF_WORDS; ++x) {
        reachable |= inside[(size_t)other * SHERD_LEAF_WORDS + x];
      }
      if (!reachable) continue;
      atomic_xchg(&dirty[item - leaf + other], 1u);
      enqueue(queued, list, control, items, item - leaf + other, pass + 1);
    }
  }
}

// Writes the label of every owned voxel, and 0 elsewhere.
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
