// The bytes of files in blocks of memory that are used again.
#pragma once

#include <cstddef>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "base/files/direct_io.h"

namespace sherd {

/// Blocks of memory for the bytes of files, aligned for direct I/O.  They are used again instead of
/// being returned to the system, which would clear each page anew.  Thread-safe.
class BlockPool {
 public:
  /// Bytes of a block.  What is formatted, hashed and copied by blocks stays in the processor's
  /// cache meanwhile.
  static constexpr std::size_t kBytes = std::size_t{64} << 10;
  static_assert(kBytes % kDirectBlock == 0);

  ///   mostSpare  blocks that are kept for later use
  explicit BlockPool(std::size_t mostSpare) : mostSpare_(mostSpare) { spare_.reserve(mostSpare); }

  /// Returns a block with any content.
  [[nodiscard]] DirectMemory take();
  void giveBack(DirectMemory block);

 private:
  const std::size_t mostSpare_;
  std::mutex mutex_;
  std::vector<DirectMemory> spare_;
};

/// The bytes of a file, in blocks of a pool that outlives them.
class ByteBlocks {
 public:
  explicit ByteBlocks(BlockPool& pool) : pool_(&pool) {}
  ~ByteBlocks() { clear(); }
  ByteBlocks(ByteBlocks&& other) noexcept
      : pool_(other.pool_),
        blocks_(std::move(other.blocks_)),
        size_(std::exchange(other.size_, 0)) {}
  ByteBlocks& operator=(ByteBlocks&& other) noexcept;

  void append(std::string_view bytes);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Gives the blocks back.
  void clear();

  /// Returns the bytes, one block after another.
  [[nodiscard]] std::vector<std::string_view> pieces() const;

 private:
  BlockPool* pool_;
  std::vector<DirectMemory> blocks_;  // all but the last are full
  std::size_t size_ = 0;
};

}  // namespace sherd
