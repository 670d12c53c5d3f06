// A pool of device buffers.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>

namespace sherd {

/// Memory of a device; each kind of device has a class of its own.
struct Allocation {
  virtual ~Allocation() = default;
};

/// A device buffer from a pool, returned to it on destruction.  Commands of a device run in order,
/// so it may be returned while the device still uses it.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  explicit DeviceBuffer(std::shared_ptr<Allocation> held) : held_(std::move(held)) {}

  Allocation& operator*() const { return *held_; }

 private:
  std::shared_ptr<Allocation> held_;
};

/// Limits on the buffers of a device.
struct BufferLimits {
  std::size_t largest = 0;   ///< bytes of one buffer
  std::size_t together = 0;  ///< bytes of all buffers
};

/// Keeps returned buffers for reuse, so that only the first fracture of a solid creates buffers.
/// For one thread at a time; the counts may be read from any thread.
class BufferPool {
 public:
  using Allocate = std::function<std::unique_ptr<Allocation>(std::size_t bytes)>;

  /// Return the smallest free buffer of at least `bytes`, or a new one from `allocate`.  The size
  /// of a new buffer is rounded up to a power of two, at least 64 KiB, as fractures differ little
  /// in their needs; above a quarter of limits.together it is exact.  Where all buffers would
  /// exceed that limit, the free ones are released first; beyond that the device refuses the
  /// allocation.
  DeviceBuffer take(const Allocate& allocate, std::size_t bytes, const BufferLimits& limits);

  /// Release the free buffers.
  void clear();

  [[nodiscard]] std::size_t created() const { return storage_->created; }
  [[nodiscard]] std::size_t bytes() const { return storage_->bytes; }
  [[nodiscard]] std::size_t peakBytes() const { return storage_->peakBytes; }

 private:
  struct Storage {
    std::multimap<std::size_t, std::unique_ptr<Allocation>> free;  ///< by size
    std::atomic<std::size_t> created{0}, bytes{0}, peakBytes{0};
  };
  std::shared_ptr<Storage> storage_ = std::make_shared<Storage>();
};

}  // namespace sherd
