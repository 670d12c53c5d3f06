// Reads and writes labels as dense NumPy arrays: `.npy`, and `.npz` with the box's transform.
#include <sherd/files.h>

#include <array>
#include <bit>

#include "base/input_error.h"
#include "base/little_endian.h"
#include "formats/arrays/npy_reader.h"
#include "formats/arrays/npz.h"
#include "formats/voxels/parse_voxels.h"
#include "formats/voxels/voxel_encoders.h"
#include "formats/voxels/voxel_runs.h"

namespace sherd {
namespace {

/// Converts an `.npy` file to runs block by block, so that the whole array is never in memory.
class LabelArrayReader {
 public:
  ///   size  of the whole file, bytes
  LabelArrayReader(std::uint64_t size, std::string name, MemoryBudget& memory)
      : size_(size), name_(std::move(name)), memory_(memory), growing_(&memory) {}

  void take(std::string_view bytes) {
    constexpr std::size_t kAtATime = 4096;  // a header is short, and the rest is not copied
    while (!header_) {
      const std::size_t before = head_.size(), taken = std::min(bytes.size(), kAtATime);
      head_.append(bytes.substr(0, taken));
      header_ = npyHeaderOf(head_, size_, name_);
      if (header_) {
        checkHeader();
        head_.clear();
        bytes.remove_prefix(header_->bodyAt - before);
      } else {
        bytes.remove_prefix(taken);
        if (bytes.empty()) return;
      }
    }
    takeNumbers(bytes);
  }

  RunLengthVoxels finish() {
    if (!header_) inputError(name_, "is cut: its .npy header has no end");
    if (!header_->fortranOrder) return std::move(voxels_);
    return withAxesReversed(voxels_, name_, memory_);
  }

 private:
  void checkHeader() {
    if (header_->shape.size() != 3 || header_->kind == 'f') {
      inputError(name_, "holds " + header_->text() + "; labels are whole numbers [nx, ny, nz]");
    }
    std::array<std::uint64_t, 3> sides{header_->shape[0], header_->shape[1], header_->shape[2]};
    if (header_->fortranOrder) std::swap(sides[0], sides[2]);
    voxels_.dims = boxOf(sides, name_);
  }

  // A number may span two blocks.
  void takeNumbers(std::string_view bytes) {
    const std::size_t n = header_->itemBytes;
    if (!head_.empty()) {
      const std::size_t missing = std::min(n - head_.size(), bytes.size());
      head_.append(bytes.substr(0, missing));
      bytes.remove_prefix(missing);
      if (head_.size() < n) return;
      takeNumber(head_.data());
      head_.clear();
    }
    // Charged in batches: labels that alternate take a run each, although deflate packs them well.
    constexpr std::size_t kNumbersAtATime = std::size_t{1} << 16;
    while (bytes.size() >= n) {
      growing_.hold((voxels_.runs.size() + kNumbersAtATime) * sizeof(Run));
      for (std::size_t i = 0; i < kNumbersAtATime && bytes.size() >= n; ++i) {
        takeNumber(bytes.data());
        bytes.remove_prefix(n);
      }
    }
    head_.append(bytes);
  }

  void takeNumber(const char* bytes) {
    std::uint64_t value = 0;
    const std::size_t n = header_->itemBytes;
    for (std::size_t i = 0; i < n; ++i) {
      value = value << 8 | static_cast<unsigned char>(bytes[header_->bigEndian ? i : n - 1 - i]);
    }
    const bool negative = header_->kind == 'i' && (value >> (8 * n - 1) & 1) != 0;
    if (negative || value > 0xffff) {
      inputError(name_, "holds a label that is not in 0..65535");
    }
    appendRun(voxels_.runs, static_cast<std::uint16_t>(value), 1);
  }

  std::uint64_t size_;
  std::string name_;
  MemoryBudget& memory_;
  GrowingMemory growing_;  // runs
  std::optional<NpyHeader> header_;
  std::string head_;  // the file's first bytes until the header is complete, then a number's
  RunLengthVoxels voxels_;
};

std::string bytesOf(std::span<const double> values) {
  std::string bytes;
  for (const double value : values) storeLittle(bytes, std::bit_cast<std::uint64_t>(value));
  return bytes;
}

NpyArray labelArray(const RunLengthVoxels& voxels) {
  const auto side = [&](int axis) { return static_cast<std::size_t>(voxels.dims[axis]); };
  return {"labels", "<u2", {side(0), side(1), side(2)}, {}};
}

std::optional<VoxelTransform> transformOf(const std::vector<ZipEntry>& entries,
                                          const std::string& name, MemoryBudget& memory) {
  const auto origin = numbersOf(entries, "origin", 3, name, memory);
  const auto voxelSize = numbersOf(entries, "voxel_size", 1, name, memory);
  const auto indexMin = numbersOf(entries, "index_min", 3, name, memory);
  if (!origin && !voxelSize) return {};
  const bool good = origin && voxelSize && origin->values.size() == 3 &&
                    voxelSize->values.size() == 1 && voxelSize->values[0] > 0.0 &&
                    std::isfinite(voxelSize->values[0]) &&
                    std::all_of(origin->values.begin(), origin->values.end(),
                                [](double v) { return std::isfinite(v); });
  if (!good) inputError(name, "needs an origin of three numbers and a voxel_size above 0");
  const std::vector<double>& at = origin->values;
  VoxelTransform transform{{{at[0], at[1], at[2]}, voxelSize->values[0]}};
  if (!indexMin) return transform;
  constexpr double kFar = 2147483647.0;
  const bool whole = indexMin->values.size() == 3 &&
                     std::all_of(indexMin->values.begin(), indexMin->values.end(), [](double v) {
                       return std::abs(v) <= kFar && v == std::floor(v);
                     });
  if (!whole) inputError(name, "needs an index_min of three whole numbers");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    transform.indexMin[axis] = static_cast<std::int32_t>(indexMin->values[axis]);
  }
  return transform;
}

}  // namespace

RunLengthVoxels parseNpyLabels(std::string_view bytes, const std::string& name,
                               const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  LabelArrayReader reader(bytes.size(), name, memory);
  reader.take(bytes);
  return reader.finish();
}

PlacedVoxels parseNpzLabels(std::string_view bytes, const std::string& name,
                            const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  const std::vector<ZipEntry> entries = zipEntries(bytes, name, &memory);
  const ZipEntry* labels = entryOf(entries, "labels");
  if (labels == nullptr) inputError(name, "has no array 'labels'");
  PlacedVoxels voxels{{}, transformOf(entries, name, memory)};
  LabelArrayReader reader(labels->size, name + ", array 'labels'", memory);
  unpack(*labels, name, [&](std::string_view part) { reader.take(part); });
  voxels.voxels = reader.finish();
  return voxels;
}

void encodeNpyLabels(const RunLengthVoxels& voxels, const ByteSink& sink) {
  sink(npyHeader(labelArray(voxels)));
  encodeDense(voxels, sink);
}

void encodeNpzLabels(const PlacedVoxels& voxels, const ByteSink& sink) {
  NpzWriter writer(sink);
  writer.deflate(labelArray(voxels.voxels),
                 [&](const ByteSink& numbers) { encodeDense(voxels.voxels, numbers); });
  if (voxels.transform) {
    const GridFrame& frame = voxels.transform->frame;
    const glm::dvec3& at = frame.origin;
    writer.store({"origin", "<f8", {3}, bytesOf(std::array{at.x, at.y, at.z})});
    writer.store({"voxel_size", "<f8", {}, bytesOf(std::array{frame.voxelSize})});
    NpyArray indexMin{"index_min", "<i4", {3}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      storeLittle(indexMin.bytes, static_cast<std::uint32_t>(voxels.transform->indexMin[axis]));
    }
    writer.store(indexMin);
  }
  writer.finish();
}

}  // namespace sherd
