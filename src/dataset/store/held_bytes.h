// The bytes of a file that is not stored yet: in memory, or in a temporary file if it is large.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>

#include "base/files/atomic_file.h"
#include "dataset/store/byte_blocks.h"

namespace sherd {

class HeldBytes {
 public:
  /// The most bytes of one file that are held in memory.
  static constexpr std::size_t kMost = std::size_t{16} << 20;

  ///   pool  outlives this
  ///   file  that a large one may become; its folder has the temporary file, and is made for it
  HeldBytes(BlockPool& pool, std::filesystem::path file) : file_(std::move(file)), bytes_(pool) {}

  ///   throws  Error(output)
  void append(std::string_view bytes);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] bool isInMemory() const { return temporary_ == nullptr; }

  /// Keeps the bytes in a temporary file from now on.
  ///   throws  Error(output)
  void moveToFile();

  /// The bytes, if they are in memory.
  [[nodiscard]] ByteBlocks& inMemory() { return bytes_; }

  /// Gives the temporary file its name, if the bytes are not in memory.
  void commit() { temporary_->commit(); }

  /// Calls visit(bytes) for all bytes in order.
  ///   throws  Error(output) the temporary file cannot be read
  void forEach(const std::function<void(std::string_view)>& visit) const;

  void clear();

 private:
  std::filesystem::path file_;
  ByteBlocks bytes_;
  std::unique_ptr<AtomicFile> temporary_{};
  std::uint64_t size_ = 0;
};

}  // namespace sherd
