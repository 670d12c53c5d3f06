// Little-endian numbers, independent of the machine's byte order.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace sherd {

/// Reads the number at `bytes`.
template <class T>
requires std::is_unsigned_v<T> T loadLittle(const char* bytes) {
  T value = 0;
  for (std::size_t i = sizeof(T); i-- > 0;) {
    value = static_cast<T>((std::uint64_t{value} << 8) | static_cast<unsigned char>(bytes[i]));
  }
  return value;
}

/// Writes a number to `bytes`, which has room for it.
template <class T>
requires std::is_unsigned_v<T>
void keepLittle(char* bytes, T value) {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(bytes, &value, sizeof(T));  // the loop below is no single store to some compilers
    return;
  }
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[i] = static_cast<char>((std::uint64_t{value} >> (8 * i)) & 0xff);
  }
}

inline void keepLittle(char* bytes, float value) {
  keepLittle(bytes, std::bit_cast<std::uint32_t>(value));
}

inline void keepLittle(char* bytes, double value) {
  keepLittle(bytes, std::bit_cast<std::uint64_t>(value));
}

/// Appends a number to `bytes`.
template <class T>
requires std::is_unsigned_v<T>
void storeLittle(std::string& bytes, T value) {
  char little[sizeof(T)];
  keepLittle(little, value);
  bytes.append(little, sizeof(T));
}

inline void storeLittle(std::string& bytes, float value) {
  storeLittle(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace sherd
