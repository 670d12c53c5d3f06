// Labels as a dense array for NumPy.
#include <sherd/io.h>

#include <algorithm>

#include "io/atomic_file.h"
#include "io/little_endian.h"
#include "io/npz.h"

namespace sherd {

void writeNpyLabels(const std::filesystem::path& file, const RunLengthVoxels& voxels) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;  // bytes handed over at once
  const openvdb::Coord& dims = voxels.dims;
  const auto side = [&](int axis) { return static_cast<std::size_t>(dims[axis]); };
  AtomicFile out(file);
  std::string block = npyHeader({"labels", "<u2", {side(0), side(1), side(2)}, {}});
  for (const Run& run : voxels.runs) {
    for (std::uint32_t i = 0; i < run.length; ++i) {
      storeLittle(block, run.label);
      if (block.size() < kBlock) continue;
      out.write(block);
      block.clear();
    }
  }
  out.write(block);
  out.commit();
}

}  // namespace sherd
