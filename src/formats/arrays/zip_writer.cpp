// Writes ZIP files.
//
//     local header, name, bytes    of each file, stored or deflated
//     central header, name         of each file
//     end of the central directory
//
// source  PKWARE, APPNOTE.TXT 6.3.3, sections 4.3.7, 4.3.12, 4.3.14 to 4.3.16, 4.5.3
#include "formats/arrays/zip_writer.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <new>
#include <optional>
#include <string_view>

#include "base/little_endian.h"

namespace sherd {
namespace {

// The earliest timestamp of the format: 1980-01-01, midnight.
constexpr std::uint16_t kDay = 0x0021, kTime = 0;
constexpr std::uint16_t kVersion = 20;    // 2.0, which every reader supports
constexpr std::uint16_t kVersion64 = 45;  // 4.5: 64-bit sizes and offsets
constexpr std::uint16_t kStored = 0, kDeflated = 8;
constexpr std::uint16_t kUtf8 = 1 << 11;  // of names, which are else code page 437
constexpr std::uint64_t kLargest32 = 0xffffffffu, kLargest16 = 0xffffu;

std::uint32_t in32(std::uint64_t n, bool wide) {
  return static_cast<std::uint32_t>(wide ? kLargest32 : n);
}

std::uint32_t addTo(std::uint32_t sum, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Deflates bytes in blocks that fit zlib's 32-bit counter.
class Deflater {
 public:
  explicit Deflater(const ByteSink& out) : out_(out) {
    const int made = ::deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8,
                                    Z_DEFAULT_STRATEGY);
    if (made != Z_OK) throw std::bad_alloc();
  }
  ~Deflater() { ::deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void take(std::string_view bytes) {
    constexpr std::size_t kMost = std::size_t{1} << 30;
    for (; bytes.size() > kMost; bytes.remove_prefix(kMost)) run(bytes.substr(0, kMost), false);
    run(bytes, false);
  }
  void finish() { run({}, true); }

 private:
  void run(std::string_view bytes, bool last) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    do {
      stream_.next_out = block_.data();
      stream_.avail_out = static_cast<uInt>(block_.size());
      ::deflate(&stream_, last ? Z_FINISH : Z_NO_FLUSH);
      out_({reinterpret_cast<const char*>(block_.data()), block_.size() - stream_.avail_out});
    } while (stream_.avail_out == 0);
  }

  const ByteSink& out_;
  z_stream stream_{};
  std::array<Bytef, 1 << 15> block_;
};

// Returns the ZIP64 extra field.
std::string extraField(std::initializer_list<std::uint64_t> wide) {
  std::string bytes;
  if (wide.size() == 0) return bytes;
  storeLittle(bytes, std::uint16_t{1});
  storeLittle(bytes, static_cast<std::uint16_t>(8 * wide.size()));
  for (const std::uint64_t n : wide) storeLittle(bytes, n);
  return bytes;
}

constexpr std::uint64_t kLocalBytes = 30;  // of a local header without name and extra fields

// Returns an extra field of padding, so that what follows it begins at a multiple of `alignment`.
//   at  offset of what would follow without it
std::string paddingField(std::uint64_t at, std::uint64_t alignment) {
  constexpr std::uint16_t kPadding = 0x1986;  // as Pixar's own writer of USDZ names it
  constexpr std::uint64_t kHeader = 4;
  if (at % alignment == 0) return {};
  const std::uint64_t zeros = (alignment - (at + kHeader) % alignment) % alignment;
  std::string bytes;
  storeLittle(bytes, kPadding);
  storeLittle(bytes, static_cast<std::uint16_t>(zeros));
  return bytes.append(zeros, '\0');
}

bool isAscii(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// Stores the fields that the local and the central header share.
void storeHeader(std::string& to, const PackedFile& file, std::uint64_t bytes, bool wideSizes,
                 bool wide, std::size_t extra) {
  storeLittle(to, wide ? kVersion64 : kVersion);
  storeLittle(to, isAscii(file.name) ? std::uint16_t{0} : kUtf8);  // flags
  storeLittle(to, file.deflated ? kDeflated : kStored);
  storeLittle(to, kTime);
  storeLittle(to, kDay);
  storeLittle(to, file.sum);
  storeLittle(to, in32(bytes, wideSizes));
  storeLittle(to, in32(file.size, wideSizes));
  storeLittle(to, static_cast<std::uint16_t>(file.name.size()));
  storeLittle(to, static_cast<std::uint16_t>(extra));
}

}  // namespace

PackedFile packed(std::string name, bool deflate, const Content& content) {
  std::string bytes;
  PackedFile file =
      packed(std::move(name), deflate, content, [&bytes](std::string_view more) { bytes += more; });
  file.bytes = std::move(bytes);
  return file;
}

PackedFile packed(std::string name, bool deflate, const Content& content, const ByteSink& to) {
  PackedFile file{std::move(name), deflate, 0, 0, {}};
  std::optional<Deflater> deflater;
  if (deflate) deflater.emplace(to);
  content([&](std::string_view bytes) {
    addStored(file, bytes);
    if (deflater) {
      deflater->take(bytes);
    } else {
      to(bytes);
    }
  });
  if (deflater) deflater->finish();
  return file;
}

void addStored(PackedFile& file, std::string_view bytes) {
  file.sum = addTo(file.sum, bytes);
  file.size += bytes.size();
}

void ZipWriter::add(const PackedFile& file) {
  begin(file, file.bytes.size());
  sink_(file.bytes);
}

void ZipWriter::begin(const PackedFile& file, std::uint64_t size) {
  const bool wide = std::max(file.size, size) >= kLargest32;
  std::string extra = wide ? extraField({file.size, size}) : std::string();
  extra += paddingField(offset_ + kLocalBytes + file.name.size() + extra.size(), alignment_);
  std::string local("PK\x03\x04", 4);
  storeHeader(local, file, size, wide, wide, extra.size());
  local += file.name + extra;
  sink_(local);
  note(file, size, extra.size());
}

void ZipWriter::note(const PackedFile& file, std::uint64_t size) {
  note(file, size, std::max(file.size, size) >= kLargest32 ? 20 : 0);
}

void ZipWriter::note(const PackedFile& file, std::uint64_t size, std::size_t localExtra) {
  const bool wideSizes = std::max(file.size, size) >= kLargest32;
  const bool wideOffset = offset_ >= kLargest32;
  const std::string extra = wideSizes && wideOffset ? extraField({file.size, size, offset_})
                            : wideSizes             ? extraField({file.size, size})
                            : wideOffset            ? extraField({offset_})
                                                    : std::string();
  directory_.append("PK\x01\x02", 4);
  storeLittle(directory_, kVersion);  // made by
  storeHeader(directory_, file, size, wideSizes, wideSizes || wideOffset, extra.size());
  storeLittle(directory_, std::uint16_t{0});  // comment
  storeLittle(directory_, std::uint16_t{0});  // disk
  storeLittle(directory_, std::uint16_t{0});  // internal attributes
  storeLittle(directory_, std::uint32_t{0});  // external attributes
  storeLittle(directory_, in32(offset_, wideOffset));
  directory_ += file.name + extra;
  offset_ += kLocalBytes + file.name.size() + localExtra + size;
  ++count_;
}

void ZipWriter::finish() {
  std::string end;
  const bool wide =
      count_ >= kLargest16 || offset_ >= kLargest32 || directory_.size() >= kLargest32;
  if (wide) {
    end.append("PK\x06\x06", 4);
    storeLittle(end, std::uint64_t{44});  // bytes of this record that follow
    storeLittle(end, kVersion64);
    storeLittle(end, kVersion64);
    storeLittle(end, std::uint32_t{0});  // disk
    storeLittle(end, std::uint32_t{0});  // disk of the directory
    storeLittle(end, count_);
    storeLittle(end, count_);
    storeLittle(end, std::uint64_t{directory_.size()});
    storeLittle(end, offset_);
    end.append("PK\x06\x07", 4);
    storeLittle(end, std::uint32_t{0});  // disk of that record
    storeLittle(end, offset_ + directory_.size());
    storeLittle(end, std::uint32_t{1});  // disks
  }
  end.append("PK\x05\x06", 4);
  storeLittle(end, std::uint16_t{0});  // disk
  storeLittle(end, std::uint16_t{0});  // disk of the directory
  for (int k = 0; k < 2; ++k) {
    storeLittle(end, static_cast<std::uint16_t>(wide ? kLargest16 : count_));
  }
  storeLittle(end, in32(directory_.size(), wide));
  storeLittle(end, in32(offset_, wide));
  storeLittle(end, std::uint16_t{0});  // comment
  sink_(directory_ + end);
}

}  // namespace sherd
