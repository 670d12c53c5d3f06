// States of pickles: bytes with a checksum.
#include "sealed.h"

#include <sherd/error.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "text.h"

namespace pysherd {

namespace nb = nanobind;

namespace {

// Its last byte is the format's number: 3 since solids have a unit and an upward axis.
constexpr std::string_view kBegin{"sherd\0\0\3", 8};
constexpr std::size_t kKind = 8, kHead = kBegin.size() + kKind + sizeof(std::uint64_t);
constexpr std::size_t kSum = sizeof(std::uint32_t);

std::string paddedKind(std::string_view kind) {
  std::string padded(kind);
  padded.resize(kKind, '\0');
  return padded;
}

uLong sumOf(uLong sum, std::string_view bytes) {
  return ::crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
}

// Copies bytes block by block, which are still in the processor's cache when they are summed.
class Copy {
 public:
  explicit Copy(char* to) : to_(to) {}
  void add(std::string_view bytes) {
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    while (!bytes.empty()) {
      const std::string_view block = bytes.substr(0, kBlock);
      std::memcpy(to_, block.data(), block.size());
      sum_ = sumOf(sum_, {to_, block.size()});
      to_ += block.size();
      bytes.remove_prefix(block.size());
    }
  }
  void end() const {
    const auto sum = static_cast<std::uint32_t>(sum_);
    std::memcpy(to_, &sum, kSum);
  }

 private:
  char* to_;
  uLong sum_ = ::crc32_z(0, nullptr, 0);
};

[[noreturn]] void damaged(std::string_view kind, const std::string& what) {
  throw sherd::Error(sherd::ErrorCode::input, "this pickle of " +
                                                  std::string(kind == "options" ? "" : "a ") +
                                                  std::string(kind) + " " + what);
}

std::string_view bytesOf(std::string_view kind, nb::handle state) {
  if (!nb::isinstance<nb::bytes>(state)) {
    damaged(kind,
            "holds an object of another type than bytes; it is damaged, or of another "
            "version of pysherd");
  }
  const auto bytes = nb::borrow<nb::bytes>(state);
  return {bytes.c_str(), bytes.size()};
}

}  // namespace

nb::bytes sealed(std::string_view kind, const std::vector<std::string_view>& pieces) {
  std::uint64_t size = 0;
  for (const std::string_view piece : pieces) size += piece.size();
  const auto all = static_cast<Py_ssize_t>(kHead + size + kSum);
  PyObject* const made = PyBytes_FromStringAndSize(nullptr, all);
  if (made == nullptr) throw nb::python_error();
  const auto bytes = nb::steal<nb::bytes>(made);
  Copy copy(PyBytes_AsString(made));
  copy.add(kBegin);
  copy.add(paddedKind(kind));
  copy.add({reinterpret_cast<const char*>(&size), sizeof size});
  for (const std::string_view piece : pieces) copy.add(piece);
  copy.end();
  return bytes;
}

std::string_view contentOf(std::string_view kind, nb::handle state) {
  const std::string_view all = bytesOf(kind, state);
  const std::size_t same = kBegin.size() - 1;
  if (all.substr(0, same) != kBegin.substr(0, same) || all.size() < kHead + kSum) {
    damaged(kind, "is damaged: its state is cut short or none of pysherd");
  }
  if (all[same] != kBegin[same]) {
    damaged(kind, "is of another version of pysherd or damaged: its state has format " +
                      std::to_string(static_cast<unsigned char>(all[same])) + ", and format " +
                      std::to_string(static_cast<int>(kBegin[same])) + " is read; make it again");
  }
  std::uint64_t size = 0;
  std::memcpy(&size, all.data() + kHead - sizeof size, sizeof size);
  if (size != all.size() - kHead - kSum) {
    damaged(kind, "is damaged: its state has " + std::to_string(all.size()) +
                      " bytes, and another number by its head");
  }
  std::uint32_t sum = 0;
  std::memcpy(&sum, all.data() + all.size() - kSum, kSum);
  if (sumOf(::crc32_z(0, nullptr, 0), all.substr(0, all.size() - kSum)) != sum) {
    damaged(kind, "is damaged: its checksum differs from that of its bytes");
  }
  if (all.substr(kBegin.size(), kKind) != paddedKind(kind)) {
    damaged(kind, "is damaged: it holds the state of another kind of object");
  }
  return all.substr(kHead, size);
}

void bindSealed(nb::module_& module) {
  module.def("sealed", [](const std::string& kind, const nb::bytes& content) {
    return sealed(kind, {std::string_view(content.c_str(), content.size())});
  });
  module.def("content_of", [](const std::string& kind, nb::handle state) {
    const std::string_view content = contentOf(kind, state);
    return nb::bytes(content.data(), content.size());
  });
}

}  // namespace pysherd
