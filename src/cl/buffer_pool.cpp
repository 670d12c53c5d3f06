// A pool of device buffers.
#include "cl/buffer_pool.h"

#include <algorithm>
#include <bit>

namespace sherd {

DeviceBuffer BufferPool::take(const Allocate& allocate, std::size_t bytes,
                              const BufferLimits& limits) {
  constexpr std::size_t kMinBytes = std::size_t{1} << 16;
  std::unique_ptr<Allocation> buffer;
  std::size_t size = 0;
  const auto found = storage_->free.lower_bound(bytes);
  if (found != storage_->free.end()) {
    size = found->first;
    buffer = std::move(found->second);
    storage_->free.erase(found);
  } else {
    size = std::max(std::min(std::bit_ceil(std::max(bytes, kMinBytes)), limits.largest), bytes);
    constexpr std::size_t kRoundingShare = 4;  // buffers in use cannot shrink later
    if (storage_->bytes + size > limits.together / kRoundingShare) size = bytes;
    if (storage_->bytes + size > limits.together) clear();
    buffer = allocate(size);
    ++storage_->created;
    storage_->bytes += size;
    storage_->peakBytes = std::max(storage_->peakBytes.load(), storage_->bytes.load());
  }
  const auto release = [size, storage = std::weak_ptr(storage_)](Allocation* held) {
    std::unique_ptr<Allocation> returned(held);
    if (const auto pool = storage.lock()) pool->free.emplace(size, std::move(returned));
  };
  return DeviceBuffer(std::shared_ptr<Allocation>(buffer.release(), release));
}

void BufferPool::clear() {
  for (const auto& [size, buffer] : storage_->free) storage_->bytes -= size;
  storage_->free.clear();
}

}  // namespace sherd
