// The bytes of files in blocks of memory that are used again.
#include "dataset/store/byte_blocks.h"

#include <algorithm>
#include <cstring>

namespace sherd {

DirectMemory BlockPool::take() {
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      DirectMemory block = std::move(spare_.back());
      spare_.pop_back();
      return block;
    }
  }
  return directMemory(kBytes);
}

void BlockPool::giveBack(DirectMemory block) {
  const std::lock_guard lock(mutex_);
  if (spare_.size() < mostSpare_) spare_.push_back(std::move(block));
}

ByteBlocks& ByteBlocks::operator=(ByteBlocks&& other) noexcept {
  std::swap(pool_, other.pool_);
  std::swap(blocks_, other.blocks_);
  std::swap(size_, other.size_);
  return *this;
}

void ByteBlocks::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t used = size_ % BlockPool::kBytes;
    if (used == 0) blocks_.push_back(pool_->take());
    const std::size_t some = std::min(bytes.size(), BlockPool::kBytes - used);
    std::memcpy(blocks_.back().get() + used, bytes.data(), some);
    bytes.remove_prefix(some);
    size_ += some;
  }
}

void ByteBlocks::clear() {
  for (DirectMemory& block : blocks_) pool_->giveBack(std::move(block));
  blocks_.clear();
  size_ = 0;
}

std::vector<std::string_view> ByteBlocks::pieces() const {
  std::vector<std::string_view> pieces;
  pieces.reserve(blocks_.size());
  for (std::size_t i = 0, left = size_; i < blocks_.size(); ++i) {
    pieces.emplace_back(blocks_[i].get(), std::min(left, BlockPool::kBytes));
    left -= pieces.back().size();
  }
  return pieces;
}

}  // namespace sherd
