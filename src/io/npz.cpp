// Arrays for NumPy.
//
//     local header, name, .npy     of each array
//     central header, name         of each array
//     end of the central directory
//
// source  PKWARE, APPNOTE.TXT 6.3.3, sections 4.3.7, 4.3.12, 4.3.16; NumPy, NEP 1
#include "io/npz.h"

#include <zlib.h>

#include <cassert>
#include <cstdint>

#include "io/atomic_file.h"
#include "io/little_endian.h"

namespace sherd {
namespace {

// The first day a ZIP file can tell, 1980-01-01, at midnight.
constexpr std::uint16_t kDay = 0x0021, kTime = 0;
constexpr std::uint16_t kVersion = 20;  // 2.0, as every ZIP reader has it

}  // namespace

std::string npyHeader(const NpyArray& array) {
  std::string text = "{'descr': '";
  text.append(array.type).append("', 'fortran_order': False, 'shape': (");
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    if (axis > 0) text.append(" ");
    text.append(std::to_string(array.shape[axis])).append(",");  // Python reads "(n, m,)" too
  }
  text.append("), }");
  // Magic, version, length and text are a multiple of 64 bytes together, the text ends its line.
  constexpr std::size_t kBefore = 10;
  text.append(63 - (kBefore + text.size()) % 64, ' ').push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  storeLittle(header, static_cast<std::uint16_t>(text.size()));
  return header + text;
}

namespace {

std::uint32_t checksum(std::string_view first, std::string_view second) {
  uLong sum = ::crc32_z(0, nullptr, 0);
  for (const std::string_view part : {first, second}) {
    sum = ::crc32_z(sum, reinterpret_cast<const Bytef*>(part.data()), part.size());
  }
  return static_cast<std::uint32_t>(sum);
}

// What the local and the central header have in common.
void storeEntry(std::string& bytes, const std::string& name, std::uint32_t sum, std::size_t size) {
  storeLittle(bytes, kVersion);
  storeLittle(bytes, std::uint16_t{0});  // flags
  storeLittle(bytes, std::uint16_t{0});  // stored
  storeLittle(bytes, kTime);
  storeLittle(bytes, kDay);
  storeLittle(bytes, sum);
  for (int k = 0; k < 2; ++k) storeLittle(bytes, static_cast<std::uint32_t>(size));
  storeLittle(bytes, static_cast<std::uint16_t>(name.size()));
  storeLittle(bytes, std::uint16_t{0});  // extra field
}

}  // namespace

void writeNpz(const std::filesystem::path& file, std::span<const NpyArray> arrays) {
  AtomicFile out(file);
  std::string directory;
  std::size_t offset = 0;
  for (const NpyArray& array : arrays) {
    const std::string name = array.name + ".npy", header = npyHeader(array);
    const std::uint32_t sum = checksum(header, array.bytes);
    const std::size_t size = header.size() + array.bytes.size();

    std::string local("PK\x03\x04", 4);
    storeEntry(local, name, sum, size);
    local += name + header;
    out.write(local);
    out.write(array.bytes);

    directory.append("PK\x01\x02", 4);
    storeLittle(directory, kVersion);  // made by
    storeEntry(directory, name, sum, size);
    storeLittle(directory, std::uint16_t{0});  // comment
    storeLittle(directory, std::uint16_t{0});  // disk
    storeLittle(directory, std::uint16_t{0});  // internal attributes
    storeLittle(directory, std::uint32_t{0});  // external attributes
    storeLittle(directory, static_cast<std::uint32_t>(offset));
    directory += name;
    offset += local.size() + array.bytes.size();
    assert(offset <= 0xffffffffu);
  }
  const auto count = static_cast<std::uint16_t>(arrays.size());
  std::string end("PK\x05\x06", 4);
  storeLittle(end, std::uint16_t{0});  // disk
  storeLittle(end, std::uint16_t{0});  // disk of the directory
  storeLittle(end, count);
  storeLittle(end, count);
  storeLittle(end, static_cast<std::uint32_t>(directory.size()));
  storeLittle(end, static_cast<std::uint32_t>(offset));
  storeLittle(end, std::uint16_t{0});  // comment
  out.write(directory + end);
  out.commit();
}

}  // namespace sherd
