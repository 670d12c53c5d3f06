// Reads NumPy arrays.
//
//     93 'NUMPY' u8 major u8 minor | u16 or u32 length | {'descr': '<u2', 'fortran_order': False,
//     'shape': (3, 4, 5), } blanks \n | numbers
//
// source  NumPy, NEP 1
#include "formats/arrays/npy_reader.h"

#include <sherd/files.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/files/file_bytes.h"
#include "base/half_float.h"
#include "base/input_error.h"
#include "base/little_endian.h"
#include "base/text/text_scan.h"

namespace sherd {
namespace {

constexpr std::size_t kLongestHeader = std::size_t{1} << 20;

/// Returns the text after a key of the header's dictionary.
std::string_view valueOf(std::string_view text, const std::string& key, const std::string& name) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + key + quote;
    std::size_t at = text.find(quoted);
    if (at == std::string_view::npos) continue;
    at = text.find_first_not_of(" \t", at + quoted.size());
    if (at == std::string_view::npos || text[at] != ':') continue;
    return trimmed(text.substr(at + 1));
  }
  inputError(name, "its .npy header has no '" + key + "'");
}

void takeType(std::string_view text, NpyHeader& header, const std::string& name) {
  const auto fail = [&] {
    inputError(name, "its .npy header names the type " + inQuotes(text.substr(0, 20)) +
                         "; plain numbers are needed");
  };
  const std::size_t end = text.size() > 1 ? text.find(text[0], 1) : std::string_view::npos;
  if (end == std::string_view::npos || (text[0] != '\'' && text[0] != '"')) fail();
  std::string_view type = text.substr(1, end - 1);
  if (type.size() < 2) fail();
  header.bigEndian = type[0] == '>';
  if (std::string_view("<>|=").find(type[0]) != std::string_view::npos) type.remove_prefix(1);
  header.kind = type.empty() ? '?' : type[0];
  header.itemBytes = parseInteger<std::size_t>(type.substr(type.empty() ? 0 : 1)).value_or(0);
  const std::size_t n = header.itemBytes;
  const bool whole = n == 1 || n == 2 || n == 4 || n == 8;
  const bool known = header.kind == 'b'   ? n == 1
                     : header.kind == 'f' ? whole && n > 1
                                          : whole && (header.kind == 'u' || header.kind == 'i');
  if (!known) fail();
}

void takeShape(std::string_view text, NpyHeader& header, const std::string& name) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) {
    inputError(name, "its .npy header has a malformed shape");
  }
  text = text.substr(1, end - 1);
  while (!isBlank(text)) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto side = parseInteger<std::uint64_t>(trimmed(text.substr(0, comma)));
    if (!side) inputError(name, "its .npy header has a malformed shape");
    header.shape.push_back(*side);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
}

double numberAt(const char* bytes, const NpyHeader& header) {
  std::uint64_t bits = 0;
  const std::size_t n = header.itemBytes;
  for (std::size_t i = 0; i < n; ++i) {
    bits = bits << 8 | static_cast<unsigned char>(bytes[header.bigEndian ? i : n - 1 - i]);
  }
  if (header.kind == 'f') {
    if (n == 8) return std::bit_cast<double>(bits);
    if (n == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    return halfValue(static_cast<std::uint16_t>(bits));
  }
  if (header.kind != 'i') return static_cast<double>(bits);
  const std::size_t unused = 64 - 8 * n;
  return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
}

}  // namespace

std::uint64_t NpyHeader::count() const {
  std::uint64_t product = 1;
  for (const std::uint64_t side : shape) {
    if (side > 0 && product > std::numeric_limits<std::uint64_t>::max() / side) {
      return std::numeric_limits<std::uint64_t>::max();
    }
    product *= side;
  }
  return product;
}

std::string NpyHeader::text() const {
  std::string text = std::string(bigEndian ? ">" : "<") + kind + std::to_string(itemBytes) + " [";
  for (const std::uint64_t side : shape) {
    if (text.back() != '[') text += ", ";
    text += std::to_string(side);
  }
  return text + "]";
}

std::optional<NpyHeader> npyHeaderOf(std::string_view bytes, std::uint64_t size,
                                     const std::string& name) {
  if (bytes.size() < 12 && bytes.size() < size) return {};
  if (bytes.size() < 12 || !bytes.starts_with("\x93NUMPY")) {
    inputError(name, "is no .npy array: its first six bytes are not NumPy's");
  }
  const bool wide = bytes[6] != 1;
  if (bytes[6] < 1 || bytes[6] > 3) inputError(name, "is an .npy array of an unknown version");
  const std::size_t begin = wide ? 12 : 10;
  const std::size_t length = wide ? loadLittle<std::uint32_t>(bytes.data() + 8)
                                  : loadLittle<std::uint16_t>(bytes.data() + 8);
  if (length > kLongestHeader || begin + length > size) {
    inputError(
        name, "is cut or damaged: its .npy header would have " + std::to_string(length) + " bytes");
  }
  if (begin + length > bytes.size()) return {};
  NpyHeader header;
  header.bodyAt = begin + length;
  const std::string_view text = bytes.substr(begin, length);
  takeType(valueOf(text, "descr", name), header, name);
  header.fortranOrder = valueOf(text, "fortran_order", name).starts_with("True");
  takeShape(valueOf(text, "shape", name), header, name);
  const std::uint64_t held = (size - header.bodyAt) / header.itemBytes;
  if (header.count() != held || (size - header.bodyAt) % header.itemBytes != 0) {
    inputError(name, "is cut or damaged: its header announces " + header.text() + ", it holds " +
                         std::to_string(size - header.bodyAt) + " bytes of numbers");
  }
  return header;
}

const ZipEntry* entryOf(const std::vector<ZipEntry>& entries, const std::string& array) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const ZipEntry& entry) {
    return entry.name == array + ".npy";
  });
  return found == entries.end() ? nullptr : &*found;
}

std::optional<NpyNumbers> numbersOf(const std::vector<ZipEntry>& entries, const std::string& array,
                                    std::uint64_t most, const std::string& name,
                                    MemoryBudget& memory) {
  const ZipEntry* entry = entryOf(entries, array);
  if (entry == nullptr) return {};
  const std::string label = name + ", array '" + array + "'";
  if (entry->size > kLongestHeader + 8 * most) {
    inputError(label, "has more than the " + std::to_string(most) + " numbers that are read");
  }
  memory.charge(entry->size);
  std::string bytes;
  bytes.reserve(entry->size);
  unpack(*entry, label, [&](std::string_view part) { bytes.append(part); });
  const std::optional<NpyHeader> header = npyHeaderOf(bytes, bytes.size(), label);
  if (!header || (header->fortranOrder && header->shape.size() > 1)) {
    inputError(label, "is in Fortran order; save it in C order");
  }
  if (header->count() > most) {
    inputError(label, "has more than the " + std::to_string(most) + " numbers that are read");
  }
  memory.charge(header->count(), sizeof(double));
  NpyNumbers numbers{header->shape, {}};
  numbers.values.reserve(header->count());
  for (std::size_t at = header->bodyAt; at < bytes.size(); at += header->itemBytes) {
    numbers.values.push_back(numberAt(bytes.data() + at, *header));
  }
  memory.release(entry->size);
  return numbers;
}

std::vector<ArrayEntry> arraysOf(const std::filesystem::path& file) {
  const std::string bytes = readFileBytes(file);
  std::vector<ArrayEntry> arrays;
  for (const ZipEntry& entry : zipEntries(bytes, file.string())) {
    arrays.push_back({entry.name, entry.size});
  }
  return arrays;
}

}  // namespace sherd
