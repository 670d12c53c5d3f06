// Arrays for NumPy.
//
//     local header, name, .npy     of each array, stored or deflated
//     central header, name         of each array
//     end of the central directory
//
// source  PKWARE, APPNOTE.TXT 6.3.3, sections 4.3.7, 4.3.12, 4.3.16; NumPy, NEP 1
#include "io/npz.h"

#include <sherd/error.h>
#include <zlib.h>

#include <array>
#include <memory>
#include <new>

#include "io/little_endian.h"

namespace sherd {
namespace {

// The first day a ZIP file can tell, 1980-01-01, at midnight.
constexpr std::uint16_t kDay = 0x0021, kTime = 0;
constexpr std::uint16_t kVersion = 20;    // 2.0, as every ZIP reader has it
constexpr std::uint16_t kVersion64 = 45;  // 4.5: sizes of 64 bits
constexpr std::uint16_t kStored = 0, kDeflated = 8;
constexpr std::uint64_t kLargest32 = 0xffffffffu;

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

struct NpzWriter::Entry {
  std::string name;
  std::uint16_t method = kStored;
  std::uint32_t sum = 0;  // CRC-32 of what it unpacks to
  std::uint64_t packed = 0, size = 0;

  [[nodiscard]] bool wide() const { return size >= kLargest32; }

  // What the local and the central header have in common.
  void store(std::string& bytes) const {
    storeLittle(bytes, wide() ? kVersion64 : kVersion);
    storeLittle(bytes, std::uint16_t{0});  // flags
    storeLittle(bytes, method);
    storeLittle(bytes, kTime);
    storeLittle(bytes, kDay);
    storeLittle(bytes, sum);
    for (const std::uint64_t n : {packed, size}) {
      storeLittle(bytes, static_cast<std::uint32_t>(wide() ? kLargest32 : n));
    }
    storeLittle(bytes, static_cast<std::uint16_t>(name.size()));
    storeLittle(bytes, static_cast<std::uint16_t>(extra().size()));
  }

  // The sizes that 32 bits cannot hold.
  [[nodiscard]] std::string extra() const {
    std::string bytes;
    if (!wide()) return bytes;
    storeLittle(bytes, std::uint16_t{1});
    storeLittle(bytes, std::uint16_t{16});
    for (const std::uint64_t n : {size, packed}) storeLittle(bytes, n);
    return bytes;
  }
};

void NpzWriter::add(const Entry& entry, std::span<const std::string_view> parts) {
  std::string local("PK\x03\x04", 4);
  entry.store(local);
  local += entry.name + entry.extra();
  if (offset_ + local.size() + entry.packed > kLargest32) {
    throw Error(ErrorCode::output, "an .npz file of more than 4 GiB is not written; try .rle");
  }
  sink_(local);
  for (const std::string_view part : parts) sink_(part);

  directory_.append("PK\x01\x02", 4);
  storeLittle(directory_, kVersion);  // made by
  entry.store(directory_);
  storeLittle(directory_, std::uint16_t{0});  // comment
  storeLittle(directory_, std::uint16_t{0});  // disk
  storeLittle(directory_, std::uint16_t{0});  // internal attributes
  storeLittle(directory_, std::uint32_t{0});  // external attributes
  storeLittle(directory_, static_cast<std::uint32_t>(offset_));
  directory_ += entry.name + entry.extra();
  offset_ += local.size() + entry.packed;
  ++count_;
}

namespace {

std::uint32_t addTo(std::uint32_t sum, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Deflates what it is given, in pieces that zlib can count.
class Deflater {
 public:
  Deflater() {
    const int made = ::deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8,
                                    Z_DEFAULT_STRATEGY);
    if (made != Z_OK) throw std::bad_alloc();
  }
  ~Deflater() { ::deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void take(std::string_view bytes, bool last = false) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    do {
      stream_.next_out = block_.data();
      stream_.avail_out = static_cast<uInt>(block_.size());
      ::deflate(&stream_, last ? Z_FINISH : Z_NO_FLUSH);
      packed.append(reinterpret_cast<const char*>(block_.data()),
                    block_.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

  std::string packed;

 private:
  z_stream stream_{};
  std::array<Bytef, 1 << 15> block_;
};

}  // namespace

void NpzWriter::store(const NpyArray& array) {
  const std::string header = npyHeader(array);
  const std::uint64_t size = header.size() + array.bytes.size();
  const std::array<std::string_view, 2> parts{header, array.bytes};
  add({array.name + ".npy", kStored, addTo(addTo(0, header), array.bytes), size, size}, parts);
}

void NpzWriter::deflate(const NpyArray& array,
                        const std::function<void(const ByteSink&)>& numbers) {
  Entry entry{array.name + ".npy", kDeflated};
  Deflater deflater;
  const auto take = [&](std::string_view bytes) {
    entry.sum = addTo(entry.sum, bytes);
    entry.size += bytes.size();
    deflater.take(bytes);
  };
  take(npyHeader(array));
  numbers(take);
  deflater.take({}, true);
  entry.packed = deflater.packed.size();
  const std::string_view part = deflater.packed;
  add(entry, {&part, 1});
}

void NpzWriter::finish() {
  std::string end("PK\x05\x06", 4);
  storeLittle(end, std::uint16_t{0});  // disk
  storeLittle(end, std::uint16_t{0});  // disk of the directory
  storeLittle(end, count_);
  storeLittle(end, count_);
  storeLittle(end, static_cast<std::uint32_t>(directory_.size()));
  storeLittle(end, static_cast<std::uint32_t>(offset_));
  storeLittle(end, std::uint16_t{0});  // comment
  sink_(directory_ + end);
}

void writeNpz(const OutputFile& file, std::span<const NpyArray> arrays) {
  file.write([&](const ByteSink& sink) {
    NpzWriter writer(sink);
    for (const NpyArray& array : arrays) writer.store(array);
    writer.finish();
  });
}

}  // namespace sherd
