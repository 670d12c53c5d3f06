// Checks trees of `.vdb` files.
#include "formats/voxels/vdb_tree.h"

#include <openvdb/Exceptions.h>
#include <openvdb/io/Compression.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace sherd {
namespace {

// Nodes of the trees 5_4_3: the root's children have 32^3 entries, theirs 16^3, and leaves 8^3
// voxels.
constexpr unsigned kUpperLog2 = 5, kLowerLog2 = 4, kLeafLog2 = 3;
constexpr std::int32_t kLowerDim = 1 << (kLowerLog2 + kLeafLog2);
constexpr std::int32_t kUpperDim = kLowerDim << kUpperLog2;
constexpr unsigned kLeafVoxels = 1u << (3 * kLeafLog2);

// Farther voxels are not read: coordinates of neighbors and sizes of boxes fit in 32 bits.
constexpr std::int32_t kFarthest = 1 << 30;

constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;  // io/Compression.h
constexpr std::uint32_t kNodeMaskCompression = 222;             // version.h

// Upper bounds, allocator included.
constexpr std::uint64_t kRootEntryBytes = 160, kTreeNodeBytes = 256;

// clang-format off
constexpr std::array<VdbValues, 11> kTypes{{
    {"Tree_float_5_4_3", 4, 2, false, false},
    {"Tree_double_5_4_3", 8, 2, false, false},
    {"Tree_int32_5_4_3", 4, 0, false, false},
    {"Tree_int64_5_4_3", 8, 0, false, false},
    {"Tree_vec3i_5_4_3", 12, 0, false, false},
    {"Tree_vec3s_5_4_3", 12, 6, false, false},
    {"Tree_vec3d_5_4_3", 24, 6, false, false},
    {"Tree_bool_5_4_3", 1, 0, true, false},
    {"Tree_mask_5_4_3", 1, 0, true, false},
    {"Tree_ptidx32_5_4_3", 4, 0, false, true},
    {"Tree_ptdataidx32_5_4_3", 4, 0, false, true},
}};
// clang-format on

struct Origin {
  std::int32_t x, y, z;
  auto operator<=>(const Origin&) const = default;
};

std::uint64_t word(std::string_view mask, std::size_t i) {
  std::uint64_t bits;
  std::memcpy(&bits, mask.data() + 8 * i, sizeof bits);
  return bits;
}

unsigned countOn(std::string_view mask) {
  unsigned count = 0;
  for (std::size_t i = 0; i < mask.size() / 8; ++i)
    count += static_cast<unsigned>(std::popcount(word(mask, i)));
  return count;
}

// Calls visit(origin) for each child of a node, ascending.
template <class Visit>
void forEachChild(std::string_view mask, const Origin& node, unsigned log2, std::int32_t childDim,
                  const Visit& visit) {
  const unsigned last = (1u << log2) - 1;
  for (std::size_t i = 0; i < mask.size() / 8; ++i) {
    for (std::uint64_t bits = word(mask, i); bits != 0; bits &= bits - 1) {
      const unsigned n =
          static_cast<unsigned>(64 * i) + static_cast<unsigned>(std::countr_zero(bits));
      const auto along = [&](unsigned shift) {
        return static_cast<std::int32_t>(n >> shift & last) * childDim;
      };
      visit(Origin{node.x + along(2 * log2), node.y + along(log2), node.z + along(0)});
    }
  }
}

class TreeWalk {
 public:
  TreeWalk(VdbCursor& in, const VdbTreeFormat& format)
      : in_(in),
        format_(format),
        storesOrigins_(format.values.hasBits || format.version < kNodeMaskCompression) {}

  std::uint64_t walk() {
    topology();
    isTopology_ = false;
    if (!format_.values.hasPoints) buffers();
    return memory_;
  }

 private:
  // A child of the root, by whose origins, and not in the file's order, OpenVDB reads buffers.
  struct Branch {
    Origin origin;
    std::uint64_t firstLeaf, leaves;
  };

  void topology() {
    if (in_.number<std::int32_t>() != 1) in_.fail("a tree says that it has several buffers");
    value();  // the background
    const auto tiles = in_.number<std::uint32_t>(), children = in_.number<std::uint32_t>();
    constexpr std::uint64_t kLeastChild = 12 + 2 * (1 << (3 * kUpperLog2)) / 8;
    if (!in_.mayHold(tiles, 13 + format_.values.bytes) || !in_.mayHold(children, kLeastChild)) {
      in_.fail("a tree says that it has " + std::to_string(tiles) + " tiles and " +
               std::to_string(children) + " nodes");
    }
    memory_ += (std::uint64_t{tiles} + children) * kRootEntryBytes;
    std::vector<Origin> origins;
    for (std::uint32_t i = 0; i < tiles; ++i) {
      origins.push_back(rootOrigin());
      value();
      in_.flag();
    }
    for (std::uint32_t i = 0; i < children; ++i) {
      origins.push_back(rootOrigin());
      const std::uint64_t before = leaves_;
      upperNode(origins.back());
      branches_.push_back({origins.back(), before, leaves_ - before});
    }
    std::sort(origins.begin(), origins.end());
    if (std::adjacent_find(origins.begin(), origins.end()) != origins.end()) {
      in_.fail("a tree has two nodes at one position");
    }
  }

  Origin rootOrigin() {
    const auto x = in_.number<std::int32_t>(), y = in_.number<std::int32_t>(),
               z = in_.number<std::int32_t>();
    for (const std::int32_t along : {x, y, z}) {
      if (along % kUpperDim != 0) in_.fail("the position of a node is no multiple of 4096");
      if (along < -kFarthest || along >= kFarthest) {
        inputError(in_.file(), "has a node at voxel " + std::to_string(along) +
                                   "; voxels farther than 2^30 from the origin are not read");
      }
    }
    return {x, y, z};
  }

  void upperNode(const Origin& origin) {
    const std::string_view children = internalNode(kUpperLog2);
    forEachChild(children, origin, kUpperLog2, kLowerDim,
                 [&](const Origin& child) { lowerNode(child); });
  }

  void lowerNode(const Origin& origin) {
    const std::string_view children = internalNode(kLowerLog2);
    const unsigned count = countOn(children);
    in_.take(std::uint64_t{kLeafVoxels / 8} * count);  // the leaves' value masks
    leaves_ += count;
    memory_ += count * (kTreeNodeBytes + (format_.values.hasBits
                                              ? kLeafVoxels / 8
                                              : std::uint64_t{kLeafVoxels} * format_.values.bytes));
    if (!storesOrigins_) return;
    forEachChild(children, origin, kLowerLog2, 1 << kLeafLog2,
                 [&](const Origin& leaf) { origins_.push_back(leaf); });
    memory_ += count * sizeof(Origin) * 3;  // of this check, as a vector grows
  }

  // Walks masks and values of a node, and returns its mask of children.
  std::string_view internalNode(unsigned log2) {
    const unsigned entries = 1u << (3 * log2);
    const std::string_view children = in_.take(entries / 8), values = in_.take(entries / 8);
    for (std::size_t i = 0; i < entries / 64; ++i) {
      // OpenVDB would take the pointer to the child for an active tile's value.
      if ((word(children, i) & word(values, i)) != 0)
        in_.fail("an entry of a node is a child and an active tile");
    }
    const bool isOld = format_.version < kNodeMaskCompression;
    valuesOf(isOld ? entries - countOn(children) : entries, entries, values);
    // A child's pointer or a value, in steps of 8 bytes.
    const std::uint64_t entryBytes = std::max(8u, (format_.values.bytes + 7) / 8 * 8);
    memory_ += kTreeNodeBytes + entries / 4 + entries * entryBytes;
    return children;
  }

  void buffers() {
    std::sort(branches_.begin(), branches_.end(),
              [](const Branch& a, const Branch& b) { return a.origin < b.origin; });
    for (const Branch& branch : branches_) {
      for (std::uint64_t i = 0; i < branch.leaves; ++i) {
        const std::string_view active = in_.take(kLeafVoxels / 8);
        if (storesOrigins_) leafOrigin(origins_[static_cast<std::size_t>(branch.firstLeaf + i)]);
        if (format_.values.hasBits) {
          leafBits();
        } else {
          if (format_.version < kNodeMaskCompression && in_.number<std::int8_t>() != 1)
            in_.fail("a leaf says that it has several buffers");
          valuesOf(kLeafVoxels, kLeafVoxels, active);
        }
      }
    }
  }

  void leafOrigin(const Origin& expected) {
    const auto x = in_.number<std::int32_t>(), y = in_.number<std::int32_t>(),
               z = in_.number<std::int32_t>();
    if (Origin{x, y, z} != expected) in_.fail("a leaf is not at its place in the tree");
  }

  void leafBits() {
    if (format_.values.treeType == "Tree_bool_5_4_3") in_.take(kLeafVoxels / 8);
  }

  // The values of a node, of which those of the active entries may be all that is stored.
  //   count    of the values without that
  //   entries  of the node
  void valuesOf(unsigned count, unsigned entries, std::string_view active) {
    constexpr std::int8_t kAll = 6;  // of the choices 0 to 6 in io/Compression.h
    std::int8_t inactive = kAll;
    if (format_.version >= kNodeMaskCompression) {
      inactive = in_.number<std::int8_t>();
      if (inactive < 0 || inactive > kAll) {
        in_.fail("inactive values are stored in the unknown way " + std::to_string(inactive));
      }
    }
    if (inactive == 2 || inactive == 4 || inactive == 5) value();
    if (inactive == 5) value();
    if (inactive >= 3 && inactive <= 5) in_.take(entries / 8);
    const bool hasOnlyActive = (format_.compression & kActiveMask) != 0 && inactive != kAll;
    block(hasOnlyActive ? countOn(active) : count);
  }

  void value() {
    if (format_.values.hasBits) {
      in_.flag();
    } else {
      in_.take(format_.values.bytes);
    }
  }

  // Values behind one another, perhaps compressed.
  void block(unsigned count) {
    const bool isHalf = format_.isHalf && format_.values.halfBytes > 0;
    if (isHalf && count == 0) return;
    const auto bytes =
        std::int64_t{count} * (isHalf ? format_.values.halfBytes : format_.values.bytes);
    if ((format_.compression & (kBlosc | kZip)) == 0) {
      in_.take(static_cast<std::uint64_t>(bytes));
      return;
    }
    constexpr std::int64_t kLargestOverhead = 1024;  // OpenVDB stores what would grow as it is
    const auto stored = in_.number<std::int64_t>();
    if (stored > bytes + kLargestOverhead) failBlock(stored, bytes);
    if (stored <= 0) {
      if (stored != -bytes) failBlock(stored, bytes);
      in_.take(static_cast<std::uint64_t>(bytes));
      return;
    }
    const std::string_view packed = in_.take(static_cast<std::uint64_t>(stored));
    if ((format_.compression & kBlosc) != 0 && !isBloscBlock(packed, bytes))
      failBlock(stored, bytes);
    if (isTopology_) unpack(packed, bytes);
  }

  // Decompresses a block of an inner node: where that fails while OpenVDB reads the topology, it
  // loses the branch that it has made.
  void unpack(std::string_view packed, std::int64_t bytes) {
    unpacked_.resize(static_cast<std::size_t>(bytes));
    const auto stored = static_cast<std::int64_t>(packed.size());
    std::string text(sizeof stored, '\0');
    std::memcpy(text.data(), &stored, sizeof stored);
    std::istringstream in(text.append(packed));
    try {
      const auto read = (format_.compression & kBlosc) != 0 ? openvdb::io::bloscFromStream
                                                            : openvdb::io::unzipFromStream;
      read(in, unpacked_.data(), unpacked_.size());
    } catch (const openvdb::Exception&) {
      failBlock(stored, bytes);
    }
  }

  // Whether Blosc decompresses that many bytes, or finds by itself that the block is damaged.  Its
  // header is, by bytes: version, version of the codec, flags, size of a value, then as 32-bit
  // numbers: bytes before compression, bytes of a part, bytes of the block.
  static bool isBloscBlock(std::string_view packed, std::int64_t bytes) {
    constexpr std::size_t kHeader = 16;
    if (packed.size() < kHeader) return false;
    const auto number = [&](std::size_t at) {
      std::int32_t value;
      std::memcpy(&value, packed.data() + at, sizeof value);
      return std::int64_t{value};
    };
    const std::int64_t part = number(8);
    if (number(4) != bytes || number(12) != static_cast<std::int64_t>(packed.size())) return false;
    return bytes == 0 || (part > 0 && part <= bytes && packed[3] != 0);
  }

  [[noreturn]] void failBlock(std::int64_t stored, std::int64_t bytes) const {
    in_.fail("a block of " + std::to_string(stored) + " bytes does not hold " +
             std::to_string(bytes) + " bytes of values");
  }

  VdbCursor& in_;
  const VdbTreeFormat& format_;
  const bool storesOrigins_;
  bool isTopology_ = true;  // not leaves' values
  std::string unpacked_;
  std::vector<Branch> branches_;
  std::vector<Origin> origins_;  // [leaves_] in the order of the topology, if leaves store them
  std::uint64_t leaves_ = 0, memory_ = 0;
};

}  // namespace

std::optional<VdbValues> vdbValuesOf(std::string_view treeType) {
  for (const VdbValues& values : kTypes) {
    if (values.treeType == treeType) return values;
  }
  return std::nullopt;
}

std::uint64_t checkVdbTree(VdbCursor& in, const VdbTreeFormat& format) {
  return TreeWalk(in, format).walk();
}

}  // namespace sherd
