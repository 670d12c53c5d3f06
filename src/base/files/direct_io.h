// Writing past the system's cache.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace sherd {

/// Direct I/O needs memory, sizes and positions that are multiples of it.
inline constexpr std::size_t kDirectBlock = 4096;

struct FreeDirectMemory {
  void operator()(char* memory) const {
    ::operator delete[](memory, std::align_val_t(kDirectBlock));
  }
};

/// Memory that is aligned for direct I/O.
using DirectMemory = std::unique_ptr<char[], FreeDirectMemory>;

[[nodiscard]] inline DirectMemory directMemory(std::size_t bytes) {
  return DirectMemory(static_cast<char*>(::operator new[](bytes, std::align_val_t(kDirectBlock))));
}

/// Enables or disables direct I/O for a file; without effect on file systems that lack it.
void setDirect(int descriptor, bool direct);

}  // namespace sherd
