// A position in the bytes of a `.vdb` file that never leaves them.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/input_error.h"
#include "formats/voxels/vdb_text.h"

namespace sherd {

/// Reads numbers and strings one after another.  Numbers have the machine's byte order, as OpenVDB
/// reads them.
class VdbCursor {
 public:
  ///   file   name for messages
  ///   bytes  kept by reference
  VdbCursor(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  /// Returns the next bytes and moves behind them.
  ///   throws  Error(input) there are fewer
  std::string_view take(std::uint64_t count) {
    if (count > left()) failCut();
    const std::string_view taken = bytes_.substr(at_, static_cast<std::size_t>(count));
    at_ += taken.size();
    return taken;
  }

  template <class T>
  T number() {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }

  /// Reads a truth value, which OpenVDB reads into a C++ bool.
  ///   throws  Error(input) neither 0 nor 1
  bool flag() {
    const auto value = number<std::uint8_t>();
    if (value > 1) fail("a truth value is " + std::to_string(value));
    return value != 0;
  }

  /// Reads a name or a type behind its length.  Readers copy these several times before anything is
  /// charged.
  ///   throws  Error(input) it has more than 64 KiB
  std::string text() {
    constexpr std::uint32_t kLongest = 1 << 16;
    const auto length = number<std::uint32_t>();
    if (length > kLongest && length <= left())
      fail("a name has " + std::to_string(length) + " bytes");
    return std::string(take(length));
  }

  /// Moves forward.
  ///   throws  Error(input) to an earlier position, or behind the end
  void moveTo(std::int64_t position) {
    const auto unsignedPosition = static_cast<std::uint64_t>(position);
    if (position < 0 || unsignedPosition < at_ || unsignedPosition > bytes_.size()) {
      fail("a grid says that it ends at byte " + std::to_string(position));
    }
    at_ = static_cast<std::size_t>(unsignedPosition);
  }

  /// Returns whether `count` items of `bytesEach` or more may follow.
  [[nodiscard]] bool mayHold(std::uint64_t count, std::uint64_t bytesEach) const {
    return count <= left() / bytesEach;
  }

  ///   throws  Error(input) "FILE: is damaged at byte N: what"
  [[noreturn]] void fail(const std::string& what) const {
    inputError(file_, "is damaged near byte " + std::to_string(at_) + ": " + vdbText(what));
  }

  [[noreturn]] void failCut() const {
    inputError(file_, "ends too early; the file is cut, damaged or no .vdb file");
  }

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace sherd
