// Reads and writes voxel files of every format.
#include <sherd/files.h>

#include <array>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/input_error.h"
#include "base/text/lower_case.h"
#include "base/text/option_names.h"
#include "formats/voxels/parse_voxels.h"
#include "formats/voxels/voxel_encoders.h"
#include "formats/voxels/voxel_runs.h"

namespace sherd {
namespace {

// Whether labels other than 0 reach all six sides of the box.
bool isTight(const RunLengthVoxels& voxels) {
  std::array<bool, 6> reached{};
  const openvdb::Coord& dims = voxels.dims;
  walkRows(voxels, [&](int x, int y, int z, int length, std::uint16_t label) {
    if (label == 0) return;
    const std::array<bool, 6> here{x == 0, x == dims.x() - 1,     y == 0, y == dims.y() - 1,
                                   z == 0, z + length == dims.z()};
    for (std::size_t i = 0; i < 6; ++i) reached[i] |= here[i];
  });
  return std::find(reached.begin(), reached.end(), false) == reached.end();
}

}  // namespace

std::optional<VoxelFormat> voxelFormatOf(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  for (std::size_t i = 0; i < std::size(names::kVoxelFormat); ++i) {
    if (extension == std::string(".") + names::kVoxelFormat[i]) return static_cast<VoxelFormat>(i);
  }
  return {};
}

PlacedVoxels readVoxels(const std::filesystem::path& file, const ReadOptions& options) {
  const std::optional<VoxelFormat> format = voxelFormatOf(file);
  if (!format) {
    inputError(file, "is no voxel file; supported are .rle .npy .npz .vox .qstack .bing");
  }
  const std::string name = file.string();
  MemoryBudget memory(name, options.maxMemory);
  const std::string bytes = readFileBytes(file, &memory);
  const ReadOptions rest{.maxMemory = memory.left()};
  switch (*format) {
    case VoxelFormat::rle:
      return {parseRle(bytes, name, rest)};
    case VoxelFormat::npy:
      return {parseNpyLabels(bytes, name, rest)};
    case VoxelFormat::npz:
      return parseNpzLabels(bytes, name, rest);
    case VoxelFormat::vox:
      return {parseMagicaVoxel(bytes, name, rest)};
    case VoxelFormat::qstack:
      return {parseQuadStack(bytes, name, rest)};
    case VoxelFormat::bing:
      return {parseBing(bytes, name, rest)};
  }
  return {};
}

void encodeVoxels(const PlacedVoxels& voxels, VoxelFormat format, const ByteSink& sink) {
  const bool dense = format == VoxelFormat::npy || format == VoxelFormat::npz;
  if (dense && voxelsIn(voxels.voxels.dims) > kMostDenseVoxels) {
    throw Error(ErrorCode::output, "a dense array holds up to 2^34 voxels, not " +
                                       std::to_string(voxelsIn(voxels.voxels.dims)) + "; try .rle");
  }
  switch (format) {
    case VoxelFormat::rle:
      return encodeRle(voxels.voxels, sink);
    case VoxelFormat::npy:
      return encodeNpyLabels(voxels.voxels, sink);
    case VoxelFormat::npz:
      return encodeNpzLabels(voxels, sink);
    case VoxelFormat::vox:
      return encodeMagicaVoxel(voxels.voxels, sink);
    case VoxelFormat::qstack:
      return encodeQuadStack(voxels.voxels, sink);
    case VoxelFormat::bing:
      return encodeBing(voxels.voxels, sink);
  }
}

void writeVoxels(const OutputFile& file, const PlacedVoxels& voxels, VoxelFormat format) {
  try {
    file.write([&](const ByteSink& sink) { encodeVoxels(voxels, format, sink); });
  } catch (const Error& e) {
    const std::string what = e.what();  // only errors of the disk name the file
    if (what.starts_with(file.string())) throw;
    throw Error(e.code(), file.string() + ": " + what, e.options());
  }
}

std::vector<std::string> lossesOf(const PlacedVoxels& voxels, VoxelFormat format) {
  std::vector<std::string> losses;
  if (voxels.transform && format != VoxelFormat::npz) {
    losses.push_back("origin and voxel size are left out; only .npz holds them");
  }
  if (format != VoxelFormat::vox) return losses;
  if (sharesColors(voxels.voxels)) {
    losses.push_back("its fragments share the 255 colors of a .vox, so their ids are lost");
  }
  if (!isTight(voxels.voxels)) {
    losses.push_back("the empty margin around its voxels is left out; a .vox has no box");
  }
  return losses;
}

}  // namespace sherd
