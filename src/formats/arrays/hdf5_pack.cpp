// Packs arrays as HDF5's filters shuffle and deflate do.
//
// source  The HDF Group, HDF5 File Format Specification 3.0, IV.A.2.l (filter pipeline)
#include <sherd/error.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "formats/arrays/hdf5_file.h"

namespace sherd {
namespace {

// On shuffled meshes level 1 takes 0.85 of the time, for 2 % more bytes; level 6 takes 1.25 times
// as long, for 0.4 % less.
constexpr int kLevel = 4;

std::size_t bytesOf(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::float32:
    case Hdf5Type::int32:
      return 4;
    case Hdf5Type::int64:
      return 8;
    case Hdf5Type::int16:
      return 2;
    case Hdf5Type::boolean:
    case Hdf5Type::text:
      return 1;
  }
  return 1;
}

// All first bytes of items, then all second ones.
std::string shuffled(std::string_view bytes, std::size_t itemBytes) {
  std::string out(bytes.size(), '\0');
  const std::size_t items = bytes.size() / itemBytes;
  for (std::size_t k = 0; k < itemBytes; ++k) {
    for (std::size_t i = 0; i < items; ++i) out[k * items + i] = bytes[i * itemBytes + k];
  }
  return out;
}

std::string deflated(std::string_view bytes) {
  std::string out(::compressBound(bytes.size()), '\0');
  uLongf size = out.size();
  const int result =
      ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), kLevel);
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result != Z_OK) throw Error(ErrorCode::internal, "zlib cannot deflate an array");
  out.resize(size);
  return out;
}

}  // namespace

Hdf5Array packedHdf5(Hdf5Type type, std::vector<std::uint64_t> shape, std::string_view bytes) {
  Hdf5Array array{type, bytesOf(type), std::move(shape), {}};
  if (bytes.empty()) return array;
  // The size of a chunk has 32 bits, packed or not.
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() - (1U << 24);
  if (bytes.size() > kMost) {
    throw Error(ErrorCode::output, "an array of an HDF5 file holds at most 4 GiB");
  }
  array.packed =
      deflated(array.itemBytes == 1 ? std::string(bytes) : shuffled(bytes, array.itemBytes));
  return array;
}

Hdf5Array packedHdf5(const std::vector<std::string>& texts, std::size_t columns) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string bytes(texts.size() * length, '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(&bytes[i * length], length);
  std::vector<std::uint64_t> shape{texts.size()};
  if (columns > 0) shape = {texts.size() / columns, columns};
  Hdf5Array array = packedHdf5(Hdf5Type::text, std::move(shape), bytes);
  array.itemBytes = length;
  return array;
}

}  // namespace sherd
