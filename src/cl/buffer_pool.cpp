// Device memory that is used again.
#include "cl/buffer_pool.h"

#include <algorithm>
#include <bit>

namespace sherd {

DeviceBuffer BufferPool::take(const cl::Context& context, std::size_t bytes,
                              const BufferLimits& limits) {
  constexpr std::size_t kLeast = std::size_t{1} << 16;
  cl::Buffer buffer;
  std::size_t size = 0;
  const auto found = shelf_->free.lower_bound(bytes);
  if (found != shelf_->free.end()) {
    size = found->first;
    buffer = std::move(found->second);
    shelf_->free.erase(found);
  } else {
    size = std::max(std::min(std::bit_ceil(std::max(bytes, kLeast)), limits.largest), bytes);
    constexpr std::size_t kPlenty = 4;  // what is in use cannot be made smaller later
    if (shelf_->bytes + size > limits.together / kPlenty) size = bytes;
    if (shelf_->bytes + size > limits.together) clear();
    buffer = cl::Buffer(context, CL_MEM_READ_WRITE, size);
    ++shelf_->created;
    shelf_->bytes += size;
    shelf_->peakBytes = std::max(shelf_->peakBytes.load(), shelf_->bytes.load());
  }
  const auto giveBack = [size, shelf = std::weak_ptr(shelf_)](const cl::Buffer* held) {
    if (const auto to = shelf.lock()) to->free.emplace(size, *held);
    delete held;
  };
  return DeviceBuffer(std::shared_ptr<const cl::Buffer>(new cl::Buffer(buffer), giveBack));
}

void BufferPool::clear() {
  for (const auto& [size, buffer] : shelf_->free) shelf_->bytes -= size;
  shelf_->free.clear();
}

}  // namespace sherd
