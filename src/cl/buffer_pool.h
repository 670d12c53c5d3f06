// Device memory that is used again.
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>

#include "cl/open_cl.h"

namespace sherd {

/// Device memory out of a pool, to which it goes back.  Commands of one queue run in order, so it
/// may go back while the device still works on it.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  explicit DeviceBuffer(std::shared_ptr<const cl::Buffer> held) : held_(std::move(held)) {}

  operator const cl::Buffer&() const { return *held_; }

 private:
  std::shared_ptr<const cl::Buffer> held_;
};

/// What kernels are given: of a DeviceBuffer the buffer, all else as it is.
inline const cl::Buffer& argument(const DeviceBuffer& buffer) { return buffer; }
template <class T>
const T& argument(const T& value) {
  return value;
}

/// What a device's buffers may have.
struct BufferLimits {
  std::size_t largest = 0;   ///< bytes of one
  std::size_t together = 0;  ///< bytes of all
};

/// Keeps what is given back, so that fractures of one solid create buffers for the first of them
/// only.  For one thread at a time, but the counts may be read from any.
class BufferPool {
 public:
  /// A buffer of so many bytes or more, of what was given back the smallest.  New ones are of a
  /// power of two, 64 KiB at least: what a fracture needs differs little from what the last did.
  /// With more than a quarter of the limit held they are as large as they must be, and where all
  /// would pass it, what was given back is freed first.  What does not fit even so is left for the
  /// driver to refuse.
  DeviceBuffer take(const cl::Context& context, std::size_t bytes, const BufferLimits& limits);

  /// Free what was given back.
  void clear();

  [[nodiscard]] std::size_t created() const { return shelf_->created; }
  [[nodiscard]] std::size_t bytes() const { return shelf_->bytes; }
  [[nodiscard]] std::size_t peakBytes() const { return shelf_->peakBytes; }

 private:
  struct Shelf {
    std::multimap<std::size_t, cl::Buffer> free;  ///< by size
    std::atomic<std::size_t> created{0}, bytes{0}, peakBytes{0};
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace sherd
