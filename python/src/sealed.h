// States of pickles: bytes with a checksum, so that damage is found before anything is made of
// them.
//
//   8 bytes  "sherd", two zeros, and the format's number
//   8 bytes  what it is the state of, padded by zeros
//   8 bytes  the number of bytes that follow but for the last four
//   content
//   4 bytes  CRC-32 of all before
//
// CRC-32 finds every damage within four consecutive bytes, and misses others once in 2^32.  zlib
// computes it several times as fast as pickle copies bytes, where SHA-256 would double the time.
// It protects from accidents alone: content is checked as that of an untrusted file.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pysherd {

/// Arrays and texts as sherd::ByteSource reads them.  Refers to them until they are sealed.
class Pieces {
 public:
  void put(std::string_view text) {
    putCount(text.size());
    pieces_.push_back(text);
  }
  void put(const std::string& text) { put(std::string_view(text)); }

  template <class Element>
  void put(const std::vector<Element>& elements) {
    static_assert(std::is_trivially_copyable_v<Element>);
    putCount(elements.size());
    putBytes(elements.data(), elements.size() * sizeof(Element));
  }

  /// Puts an array that has one element.
  template <class Element>
  void putOne(const Element& element) {
    static_assert(std::is_trivially_copyable_v<Element>);
    putCount(1);
    putBytes(&element, sizeof element);
  }

  /// Puts the number of elements that follow.
  void putSize(std::size_t size) {
    putCount(1);
    putCount(size);
  }

  [[nodiscard]] const std::vector<std::string_view>& all() const { return pieces_; }

 private:
  void putCount(std::uint64_t count) {
    numbers_.push_back(count);
    putBytes(&numbers_.back(), sizeof count);
  }
  void putBytes(const void* bytes, std::size_t size) {
    pieces_.emplace_back(static_cast<const char*>(bytes), size);
  }

  std::vector<std::string_view> pieces_;
  std::deque<std::uint64_t> numbers_;  // which stay where they are
};

/// Returns the state of a thing.
///   kind  at most 8 letters, for messages: "solid"
[[nodiscard]] nanobind::bytes sealed(std::string_view kind,
                                     const std::vector<std::string_view>& pieces);

/// Returns the content of a state, which may be any object.
///   throws  Error(input) it is another object, damaged, of another kind or another format
[[nodiscard]] std::string_view contentOf(std::string_view kind, nanobind::handle state);

void bindSealed(nanobind::module_& module);

}  // namespace pysherd
