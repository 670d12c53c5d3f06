// Reads ZIP files.
//
// source  PKWARE, APPNOTE.TXT 6.3.3, sections 4.3.7, 4.3.12, 4.3.14 to 4.3.16, 4.5.3
#include "formats/arrays/zip_reader.h"

#include <zlib.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "base/input_error.h"
#include "base/little_endian.h"

namespace sherd {
namespace {

constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kLocalHeaderBytes = 30;
constexpr std::size_t kLocatorBytes = 20, kEnd64Bytes = 56;
constexpr std::uint64_t kMostInflated = 1032;  // largest ratio of inflated to deflated bytes

/// A range of the file; at() reads a number at an offset within it.
class Record {
 public:
  Record(std::string_view file, std::uint64_t at, std::uint64_t bytes, const std::string& name) {
    if (at > file.size() || bytes > file.size() - at) {
      inputError(name, "is cut or damaged: its directory points beyond its end");
    }
    bytes_ = file.substr(at, bytes);
  }
  template <class T>
  [[nodiscard]] T at(std::size_t offset) const {
    return loadLittle<T>(bytes_.data() + offset);
  }
  [[nodiscard]] std::string_view text() const { return bytes_; }
  [[nodiscard]] bool is(std::string_view signature) const { return bytes_.starts_with(signature); }

 private:
  std::string_view bytes_;
};

/// Returns the offset of the end record of the central directory; a comment may follow it.
std::optional<std::size_t> findEnd(std::string_view file) {
  if (file.size() < kEndBytes) return {};
  const std::size_t last = file.size() - kEndBytes;
  const std::size_t first = last > 0xffff ? last - 0xffff : 0;
  for (std::size_t at = last + 1; at-- > first;) {
    const bool found = file.substr(at, 4) == std::string_view("PK\x05\x06", 4) &&
                       loadLittle<std::uint16_t>(file.data() + at + 20) == last - at;
    if (found) return at;
  }
  return {};
}

struct Directory {
  std::uint64_t offset = 0;
  std::uint64_t entries = 0;
};

Directory findDirectory(std::string_view file, const std::string& name) {
  const std::optional<std::size_t> at = findEnd(file);
  if (!at) inputError(name, "is no ZIP file, or its end is cut off");
  const Record end(file, *at, kEndBytes, name);
  Directory directory{end.at<std::uint32_t>(16), end.at<std::uint16_t>(10)};
  if (*at < kLocatorBytes) return directory;
  const Record locator(file, *at - kLocatorBytes, kLocatorBytes, name);
  if (!locator.is(std::string_view("PK\x06\x07", 4))) return directory;
  const Record end64(file, locator.at<std::uint64_t>(8), kEnd64Bytes, name);
  if (!end64.is(std::string_view("PK\x06\x06", 4))) inputError(name, "is a damaged ZIP file");
  return {end64.at<std::uint64_t>(48), end64.at<std::uint64_t>(32)};
}

/// Reads sizes and offsets above 32 bits from the ZIP64 extra field, in this order.
void widen(std::string_view extra, std::initializer_list<std::uint64_t*> values,
           const std::string& name) {
  while (extra.size() >= 4) {
    const auto id = loadLittle<std::uint16_t>(extra.data());
    const auto bytes = loadLittle<std::uint16_t>(extra.data() + 2);
    extra.remove_prefix(4);
    if (bytes > extra.size()) break;
    std::string_view field = extra.substr(0, bytes);
    extra.remove_prefix(bytes);
    if (id != 1) continue;
    for (std::uint64_t* value : values) {
      if (*value != 0xffffffffu) continue;
      if (field.size() < 8) inputError(name, "is a damaged ZIP file");
      *value = loadLittle<std::uint64_t>(field.data());
      field.remove_prefix(8);
    }
    return;
  }
}

}  // namespace

std::vector<ZipEntry> zipEntries(std::string_view file, const std::string& name,
                                 MemoryBudget* memory) {
  const Directory directory = findDirectory(file, name);
  std::vector<ZipEntry> entries;
  GrowingMemory growing(memory);
  std::uint64_t at = directory.offset;
  for (std::uint64_t i = 0; i < directory.entries; ++i) {
    const Record head(file, at, kEntryBytes, name);
    if (!head.is(std::string_view("PK\x01\x02", 4))) inputError(name, "is a damaged ZIP file");
    const std::size_t nameBytes = head.at<std::uint16_t>(28), extra = head.at<std::uint16_t>(30),
                      comment = head.at<std::uint16_t>(32);
    const Record rest(file, at + kEntryBytes, nameBytes + extra + comment, name);
    at += kEntryBytes + nameBytes + extra + comment;

    ZipEntry entry;
    growing.hold((i + 1) * sizeof(ZipEntry));
    if (memory != nullptr) memory->charge(nameBytes);
    entry.name = rest.text().substr(0, nameBytes);
    entry.method = head.at<std::uint16_t>(10);
    if ((head.at<std::uint16_t>(8) & 1) != 0)
      inputError(name, "is encrypted; save it without encryption");
    entry.sum = head.at<std::uint32_t>(16);
    std::uint64_t packed = head.at<std::uint32_t>(20), offset = head.at<std::uint32_t>(42);
    entry.size = head.at<std::uint32_t>(24);
    widen(rest.text().substr(nameBytes, extra), {&entry.size, &packed, &offset}, name);

    const Record local(file, offset, kLocalHeaderBytes, name);
    if (!local.is(std::string_view("PK\x03\x04", 4))) inputError(name, "is a damaged ZIP file");
    const std::uint64_t begin =
        offset + kLocalHeaderBytes + local.at<std::uint16_t>(26) + local.at<std::uint16_t>(28);
    entry.packed = Record(file, begin, packed, name).text();
    const bool fits =
        entry.method == 0 ? entry.size == packed : entry.size / kMostInflated <= packed;
    if (!fits) inputError(name, "is a damaged ZIP file: a size in it is impossible");
    entries.push_back(std::move(entry));
  }
  return entries;
}

void unpack(const ZipEntry& entry, const std::string& name,
            const std::function<void(std::string_view)>& take) {
  std::uint64_t size = 0;
  uLong sum = ::crc32_z(0, nullptr, 0);
  const auto pass = [&](std::string_view bytes) {
    size += bytes.size();
    if (size > entry.size) inputError(name, "is damaged: it unpacks to more bytes than announced");
    sum = ::crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    take(bytes);
  };
  if (entry.method == 0) {
    pass(entry.packed);
  } else if (entry.method == 8) {
    z_stream stream{};
    if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, ::inflateEnd);
    std::string_view rest = entry.packed;
    std::string block(std::size_t{1} << 18, '\0');
    for (int status = Z_OK; status != Z_STREAM_END;) {
      if (stream.avail_in == 0) {  // zlib counts in 32 bits
        const std::string_view give = rest.substr(0, std::size_t{1} << 30);
        rest.remove_prefix(give.size());
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(give.data()));
        stream.avail_in = static_cast<uInt>(give.size());
      }
      stream.next_out = reinterpret_cast<Bytef*>(block.data());
      stream.avail_out = static_cast<uInt>(block.size());
      status = ::inflate(&stream, Z_NO_FLUSH);
      if (status != Z_OK && status != Z_STREAM_END) inputError(name, "is cut or damaged");
      pass(std::string_view(block).substr(0, block.size() - stream.avail_out));
    }
  } else {
    inputError(name, "is packed by method " + std::to_string(entry.method) +
                         "; stored and deflated are read");
  }
  if (size != entry.size || sum != entry.sum) {
    inputError(name, "is damaged: its unpacked bytes do not match their length and CRC-32");
  }
}

}  // namespace sherd
