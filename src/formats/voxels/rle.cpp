// The paper's run-length voxel file, `.rle`.
//
//     u32 nx, u32 ny, u32 nz | u16 label, u32 length | u16 label, u32 length | ... little-endian
//
// Until 18 February 2024 its authors wrote runs of 16 bytes: u16 label, 6 unspecified bytes, u64
// length.
#include <sherd/files.h>

#include <algorithm>
#include <string>

#include "base/files/file_bytes.h"
#include "base/input_error.h"
#include "base/little_endian.h"
#include "base/memory_budget.h"
#include "formats/voxels/parse_voxels.h"
#include "formats/voxels/voxel_encoders.h"
#include "formats/voxels/voxel_runs.h"

namespace sherd {
namespace {

constexpr std::size_t kRleHeaderBytes = 12;
constexpr std::size_t kRunBytes = 6;
constexpr std::size_t kOldRunBytes = 16;

// Appends the runs. Returns what is wrong with them; empty if they fill the box.
std::string takeRuns(std::string_view body, bool old, RunLengthVoxels& voxels,
                     MemoryBudget& memory) {
  const std::size_t bytes = old ? kOldRunBytes : kRunBytes;
  if (body.size() % bytes != 0) {
    return "is cut: " + std::to_string(body.size() % bytes) +
           " bytes follow the last whole run of " + std::to_string(bytes) + " bytes";
  }
  const std::uint64_t total = voxelsIn(voxels.dims);
  // A 64-bit run becomes several 32-bit runs; a limit on the box limits their number.
  constexpr std::uint64_t kLargestOldBox = std::uint64_t{1} << 40;
  if (old && total > kLargestOldBox) return "its box has more than 2^40 voxels";
  std::uint64_t sum = 0;
  memory.charge(body.size() / bytes, sizeof(Run));
  voxels.runs.reserve(body.size() / bytes);
  for (std::size_t at = 0; at < body.size(); at += bytes) {
    const char* run = body.data() + at;
    const auto label = loadLittle<std::uint16_t>(run);
    const std::uint64_t length =
        old ? loadLittle<std::uint64_t>(run + 8) : loadLittle<std::uint32_t>(run + 2);
    const auto number = [&] { return std::to_string(at / bytes + 1); };
    if (length == 0) return "run " + number() + " has length 0";
    if (length > total - sum) {
      return "its runs pass the " + std::to_string(total) + " voxels of its box at run " + number();
    }
    sum += length;
    appendRun(voxels.runs, label, length);
  }
  if (sum == total) return {};
  return "its runs hold " + std::to_string(sum) + " of the " + std::to_string(total) +
         " voxels of its box; the file is cut or damaged";
}

}  // namespace

RunLengthVoxels parseRle(std::string_view bytes, const std::string& name,
                         const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  if (bytes.size() < kRleHeaderBytes) {
    inputError(name,
               "ends after " + std::to_string(bytes.size()) + " bytes; an .rle header has 12");
  }
  const auto side = [&](std::size_t axis) {
    return loadLittle<std::uint32_t>(bytes.data() + 4 * axis);
  };
  const openvdb::Coord dims = boxOf({side(0), side(1), side(2)}, name);
  const std::string_view body = bytes.substr(kRleHeaderBytes);
  RunLengthVoxels voxels{dims, {}};
  const std::string problem = takeRuns(body, false, voxels, memory);
  if (problem.empty()) return voxels;
  // Old runs whose lengths add up to exactly the box are no accident.
  RunLengthVoxels old{dims, {}};
  if (takeRuns(body, true, old, memory).empty()) return old;
  inputError(name, problem);
}

void encodeRle(const RunLengthVoxels& voxels, const ByteSink& sink) {
  constexpr std::size_t kMost = 10'000;  // runs per call of the sink, 60 kB
  std::string header;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    storeLittle(header, static_cast<std::uint32_t>(voxels.dims[axis]));
  }
  sink(header);
  std::string block(std::min(voxels.runs.size(), kMost) * kRunBytes, '\0');
  for (std::size_t first = 0; first < voxels.runs.size(); first += kMost) {
    const std::size_t end = std::min(voxels.runs.size(), first + kMost);
    char* at = block.data();
    for (std::size_t i = first; i < end; ++i, at += kRunBytes) {
      keepLittle(at, voxels.runs[i].label);
      keepLittle(at + 2, voxels.runs[i].length);
    }
    sink(std::string_view(block).substr(0, (end - first) * kRunBytes));
  }
}

RunLengthVoxels readRle(const std::filesystem::path& file) {
  return parseRle(readFileBytes(file), file.string());
}

void writeRle(const OutputFile& file, const RunLengthVoxels& voxels) {
  writeVoxels(file, {voxels}, VoxelFormat::rle);
}

}  // namespace sherd
