// Writes NumPy arrays.
//
// source  NumPy, NEP 1
#include "formats/arrays/npz.h"

#include <sherd/error.h>

#include "base/little_endian.h"

namespace sherd {
std::string npyHeader(const NpyArray& array) {
  std::string text = "{'descr': '";
  text.append(array.type).append("', 'fortran_order': False, 'shape': (");
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    if (axis > 0) text.append(" ");
    text.append(std::to_string(array.shape[axis])).append(",");  // Python reads "(n, m,)" too
  }
  text.append("), }");
  // Magic, version, length and text together are a multiple of 64 bytes; the text ends its line.
  constexpr std::size_t kBefore = 10;
  text.append(63 - (kBefore + text.size()) % 64, ' ').push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  storeLittle(header, static_cast<std::uint16_t>(text.size()));
  return header + text;
}

namespace {

// Keeps the .npz below 4 GiB, which every ZIP reader supports.
void requireRoom(const ZipWriter& zip, const PackedFile& file, std::uint64_t bytes) {
  if (zip.offset() + bytes + file.name.size() > 0xffffff00u) {
    throw Error(ErrorCode::output, "an .npz file holds at most 4 GiB; try .rle");
  }
}

}  // namespace

void NpzWriter::store(const NpyArray& array) {
  add(packed(array.name + ".npy", false, [&](const ByteSink& sink) {
    sink(npyHeader(array));
    sink(array.bytes);
  }));
}

PackedFile storedFile(const NpyArray& array) {
  PackedFile file{array.name + ".npy", false, 0, 0, {}};
  addStored(file, npyHeader(array));
  return file;
}

void NpzWriter::store(const NpyArray& array, const Content& numbers, const PackedFile& summed) {
  requireRoom(zip_, summed, summed.size);
  zip_.begin(summed, summed.size);
  sink_(npyHeader(array));
  numbers(sink_);
}

void NpzWriter::deflate(const NpyArray& array, const Content& numbers) {
  add(packed(array.name + ".npy", true, [&](const ByteSink& sink) {
    sink(npyHeader(array));
    numbers(sink);
  }));
}

void NpzWriter::add(const PackedFile& file) {
  requireRoom(zip_, file, file.bytes.size());
  zip_.add(file);
}

void writeNpz(const OutputFile& file, std::span<const NpyArray> arrays) {
  file.write([&](const ByteSink& sink) {
    NpzWriter writer(sink);
    for (const NpyArray& array : arrays) writer.store(array);
    writer.finish();
  });
}

}  // namespace sherd
