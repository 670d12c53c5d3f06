// Checks the structure of `.vdb` files.
#include "formats/voxels/vdb_structure.h"

#include <openvdb/Metadata.h>
#include <openvdb/math/Maps.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "formats/voxels/vdb_cursor.h"
#include "formats/voxels/vdb_tree.h"

namespace sherd {
namespace {

constexpr std::uint32_t kOldest = 220, kNewest = 225;
constexpr std::uint32_t kFloatFrustum = 221, kGridCompression = 222, kHalfGrid = 225;
constexpr std::size_t kVersionAt = 8;
constexpr std::string_view kHalfSuffix = "_HalfFloat";
constexpr std::string_view kDelayedLoad = "__delayedload", kSkipped = "__not_loaded_";
static_assert(kDelayedLoad.size() == kSkipped.size());

// OpenVDB copies the metadata of a grid twice while it reads the grid.
constexpr std::uint64_t kMetadataCopies = 4, kMetadataBytes = 512, kGridBytes = 65536;

// What the check itself notes of names stays small; Sherd writes up to 131,069 grids.
constexpr std::int32_t kMostGrids = 1 << 18;
constexpr std::uint32_t kMostMetadata = 1 << 16;

class StructureWalk {
 public:
  StructureWalk(const std::filesystem::path& file, std::span<char> bytes)
      : bytes_(bytes), in_(file, {bytes.data(), bytes.size()}) {}

  VdbStructure walk() {
    header();
    VdbStructure found;
    found.memory = metadata().memory;
    const auto count = in_.number<std::int32_t>();
    constexpr std::uint64_t kLeastGrid = 36;
    if (count < 0 || count > kMostGrids ||
        !in_.mayHold(static_cast<std::uint64_t>(count), kLeastGrid))
      in_.fail("the file says that it has " + std::to_string(count) + " grids");
    for (std::int32_t i = 0; i < count; ++i) found.grids.push_back(grid());
    connectInstances(found.grids);
    return found;
  }

 private:
  struct Metadata {
    bool isHalf = false;
    std::uint64_t memory = 0;
  };

  void header() {
    if (in_.left() < 8 || in_.number<std::int64_t>() != openvdb::OPENVDB_MAGIC)
      inputError(in_.file(), "is no .vdb file");
    version_ = in_.number<std::uint32_t>();
    if (version_ < kOldest || version_ > kNewest) {
      inputError(in_.file(), "has the file version " + std::to_string(version_) +
                                 " of OpenVDB; 220 to 225 can be read");
    }
    if (version_ == kHalfGrid) replace(kVersionAt, std::string("\xe0\0\0\0", 4));
    in_.take(8);  // the version of the library
    hasOffsets_ = in_.number<std::int8_t>() != 0;
    if (version_ < kGridCompression) fileCompression_ = in_.number<std::int8_t>() != 0 ? 1 : 0;
    const std::string_view uuid = in_.take(36);
    for (std::size_t i = 0; i < uuid.size(); ++i) {
      const bool isHyphen = i == 8 || i == 13 || i == 18 || i == 23;
      if (isHyphen ? uuid[i] != '-' : std::isxdigit(static_cast<unsigned char>(uuid[i])) == 0)
        in_.fail("the identifier of the file is none");
    }
  }

  void replace(std::size_t at, std::string_view by) {
    std::copy(by.begin(), by.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
  }

  Metadata metadata() {
    const auto count = in_.number<std::uint32_t>();
    constexpr std::uint64_t kLeast = 12;
    if (count > kMostMetadata || !in_.mayHold(count, kLeast))
      in_.fail("it says that there are " + std::to_string(count) + " metadata");
    const std::size_t begin = in_.at();
    Metadata found;
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string name = in_.text();
      if (name.empty() || !names.insert(name).second)
        in_.fail("the name '" + name + "' of metadata is empty or there twice");
      metadataValue(name, found);
    }
    found.memory = count * kMetadataBytes + kMetadataCopies * (in_.at() - begin);
    return found;
  }

  void metadataValue(const std::string& name, Metadata& found) {
    const std::string type = in_.text();
    if (type == kDelayedLoad) replace(in_.at() - type.size(), kSkipped);
    const auto size = in_.number<std::uint32_t>();
    const bool isSkipped = type == kDelayedLoad || !openvdb::Metadata::isRegisteredType(type);
    if (!isSkipped && type != "string") {
      const openvdb::Index32 expected = openvdb::Metadata::createMetadata(type)->size();
      if (size != expected) {
        in_.fail("metadata '" + name + "' of type " + type + " has " + std::to_string(size) +
                 " bytes");
      }
    }
    const bool decidesHalf = name == openvdb::GridBase::META_SAVE_HALF_FLOAT;
    if (decidesHalf && type != "bool") in_.fail("metadata '" + name + "' is no truth value");
    if (type == "bool") {
      const bool value = in_.flag();
      if (decidesHalf) found.isHalf = value;
    } else {
      in_.take(size);
    }
  }

  VdbEntry grid() {
    VdbEntry entry;
    entry.begin = in_.at();
    entry.name = in_.text();
    entry.type = in_.text();
    if (entry.type.ends_with(kHalfSuffix))
      entry.type.resize(entry.type.size() - kHalfSuffix.size());
    entry.parent = in_.text();
    in_.take(16);  // where its nodes and values begin
    const auto end = in_.number<std::int64_t>();
    const std::optional<VdbValues> values = vdbValuesOf(entry.type);
    if (values) {
      gridContent(entry, *values);
    } else {
      entry.content = VdbContent::none;
    }
    const bool isSkipped = entry.content == VdbContent::none ||
                           (entry.content == VdbContent::topology && entry.parent.empty());
    if (isSkipped) {
      if (!hasOffsets_) {
        inputError(in_.file(), "has a grid of type " + vdbText(entry.type) +
                                   ", which is not read, and does not say where that ends");
      }
      in_.moveTo(end);
    }
    entry.end = in_.at();
    return entry;
  }

  void gridContent(VdbEntry& entry, const VdbValues& values) {
    VdbTreeFormat format{values, version_, fileCompression_, false};
    if (version_ >= kGridCompression) {
      format.compression = in_.number<std::uint32_t>();
      constexpr std::uint32_t kKnownFlags = 7;
      if (format.compression > kKnownFlags) {
        in_.fail("a grid is compressed in the unknown way " + std::to_string(format.compression));
      }
    }
    const Metadata found = metadata();
    format.isHalf = found.isHalf;
    transform();
    entry.memory = kGridBytes + found.memory;
    if (values.hasPoints) entry.content = VdbContent::topology;
    if (entry.parent.empty()) entry.memory += checkVdbTree(in_, format);
  }

  // ---- Transforms

  std::vector<double> numbers(std::size_t count) {
    constexpr double kLargest = 1e100;  // products of three do not overflow
    std::vector<double> found(count);
    for (double& number : found) {
      number = in_.number<double>();
      if (!(std::abs(number) < kLargest)) {
        in_.fail("a number of a transform is not finite, or above 1e100");
      }
    }
    return found;
  }

  void transform() {
    const std::string type = in_.text();
    if (type != "NonlinearFrustumMap") return linearMap(type);
    if (version_ < kFloatFrustum) {
      in_.take(24);
    } else {
      numbers(6);
    }
    for (const double number : numbers(2)) {  // taper and depth
      if (number == 0.0) in_.fail("the frustum of a transform is flat");
    }
    linearMap(in_.text());
  }

  void linearMap(const std::string& type) {
    if (type == "AffineMap" || type == "UnitaryMap") return affineMap();
    if (type == "TranslationMap") {
      numbers(3);
    } else if (type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap") {
      numbers(3);
      scales();
    } else if (type == "ScaleMap" || type == "UniformScaleMap") {
      scales();
    } else {
      in_.fail("a grid has a transform of the unknown type '" + type + "'");
    }
  }

  // Row vectors are multiplied from the left: the last column is (0, 0, 0, 1).
  void affineMap() {
    const std::vector<double> m = numbers(16);
    if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0)
      in_.fail("the matrix of a transform is not affine");
    const double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) -
                               m[1] * (m[4] * m[10] - m[6] * m[8]) +
                               m[2] * (m[4] * m[9] - m[5] * m[8]);
    if (!(std::abs(determinant) > 0.0 && std::isfinite(determinant)))
      in_.fail("the matrix of a transform has no inverse");
  }

  // Files repeat the scales in four forms: sizes of voxels, 1/s, 1/s^2 and 1/2s.
  void scales() {
    const std::vector<double> s = numbers(15);
    constexpr double kTolerance = 1e-6;
    const auto isNear = [&](double a, double b) {
      return std::abs(a - b) <= kTolerance * std::abs(b);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const double scale = s[i];
      if (scale == 0.0 || !isNear(s[3 + i], std::abs(scale)) || !isNear(s[6 + i], 1.0 / scale) ||
          !isNear(s[9 + i], 1.0 / (scale * scale)) || !isNear(s[12 + i], 0.5 / scale))
        in_.fail("the scales of a transform contradict each other");
    }
  }

  // ---- Instances

  // Each instance gets a copy of the tree.
  void connectInstances(std::vector<VdbEntry>& grids) const {
    std::map<std::string, const VdbEntry*> parents;
    for (const VdbEntry& entry : grids) {
      if (entry.parent.empty()) parents[entry.name] = &entry;
    }
    for (VdbEntry& entry : grids) {
      if (entry.parent.empty() || entry.content == VdbContent::none) continue;
      const auto parent = parents.find(entry.parent);
      if (parent == parents.end() || parent->second->type != entry.type) {
        inputError(in_.file(), "is damaged: a grid has the nodes of '" + vdbText(entry.parent) +
                                   "', and there is no such grid of its type");
      }
      entry.memory += parent->second->memory;
    }
  }

  std::span<char> bytes_;
  VdbCursor in_;
  std::uint32_t version_ = 0, fileCompression_ = 0;
  bool hasOffsets_ = false;
};

}  // namespace

VdbStructure checkedVdb(const std::filesystem::path& file, std::span<char> bytes) {
  openvdb::initialize();
  return StructureWalk(file, bytes).walk();
}

}  // namespace sherd
