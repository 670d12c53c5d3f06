// The paper's raw cube, `.bing`.
//
//     u32 s, u32 s, u32 s | u16 label of each voxel, x slowest | little-endian
#include <sherd/files.h>

#include "base/input_error.h"
#include "base/little_endian.h"
#include "formats/voxels/parse_voxels.h"
#include "formats/voxels/voxel_encoders.h"
#include "formats/voxels/voxel_runs.h"

namespace sherd {
namespace {

constexpr std::size_t kBingHeaderBytes = 12;

}  // namespace

RunLengthVoxels parseBing(std::string_view bytes, const std::string& name,
                          const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  GrowingMemory growing(&memory);
  if (bytes.size() < kBingHeaderBytes) {
    inputError(name,
               "ends after " + std::to_string(bytes.size()) + " bytes; a .bing header has 12");
  }
  const auto side = [&](std::size_t axis) {
    return loadLittle<std::uint32_t>(bytes.data() + 4 * axis);
  };
  RunLengthVoxels voxels{boxOf({side(0), side(1), side(2)}, name), {}};
  const std::string_view body = bytes.substr(kBingHeaderBytes);
  const std::uint64_t total = voxelsIn(voxels.dims);
  if (body.size() % 2 != 0 || body.size() / 2 != total) {
    inputError(name, "is cut or damaged: its box has " + std::to_string(total) +
                         " voxels of 2 bytes, " + std::to_string(body.size()) +
                         " bytes follow the header");
  }
  constexpr std::size_t kBytesAtATime = std::size_t{1} << 16;
  for (std::size_t at = 0; at < body.size(); at += 2) {
    if (at % kBytesAtATime == 0) growing.hold((voxels.runs.size() + kBytesAtATime) * sizeof(Run));
    appendRun(voxels.runs, loadLittle<std::uint16_t>(body.data() + at), 1);
  }
  return voxels;
}

void encodeBing(const RunLengthVoxels& voxels, const ByteSink& sink) {
  const RunLengthVoxels cube = padded({voxels}, Padding::centered, "these voxels").voxels;
  std::string header;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    storeLittle(header, static_cast<std::uint32_t>(cube.dims[axis]));
  }
  sink(header);
  encodeDense(cube, sink);
}

}  // namespace sherd
