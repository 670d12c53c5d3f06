// Commands of the built-in device.  A launch returns when it is done, so commands run in order.
#include "cl/builtin_device.h"

#include <sanitizer/asan_interface.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <new>

namespace sherd {
namespace {

constexpr std::size_t kItemsPerThread = 8;  // work-items differ in how much they find to do
constexpr std::size_t kMostArguments = 32;

struct WorkItem {
  std::size_t id = 0, size = 1;
};
thread_local WorkItem workItem;

struct HostAllocation : Allocation {
  struct Free {
    void operator()(std::byte* memory) const { std::free(memory); }
  };
  std::unique_ptr<std::byte, Free> bytes;
  std::size_t size = 0;
};

std::byte* bytesOf(Allocation& memory) { return static_cast<HostAllocation&>(memory).bytes.get(); }

// An error in other work of the process does not cancel the launch, half of whose work-items would
// then never run, and this thread takes up no other work while it waits for the last of them.
void onThreadsOfTbb(std::size_t items, const std::function<void(std::size_t)>& item) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate(
      [&] { tbb::parallel_for(std::size_t{0}, items, item, tbb::simple_partitioner(), own); });
}

class BuiltinDevice : public DeviceImpl {
 public:
  BuiltinDevice(DeviceInfo described, const NativeKernels& kernels, ForEachItem forEachItem)
      : kernels_(kernels), forEachItem_(std::move(forEachItem)) {
    info = std::move(described);
  }

  void launch(const KernelLaunch& launch) override {
    const auto entry = std::find_if(kernels_.entries.begin(), kernels_.entries.end(),
                                    [&](const auto& each) { return each.name == launch.kernel; });
    if (entry == kernels_.entries.end())
      throw Error(ErrorCode::internal, std::string("there is no kernel ") + launch.kernel);
    checkArguments(launch, entry->parameters);
    if (launch.arguments.size() > kMostArguments)
      throw Error(ErrorCode::internal, std::string("the kernel ") + launch.kernel + " has " +
                                           std::to_string(launch.arguments.size()) +
                                           " parameters, at most " +
                                           std::to_string(kMostArguments) + " are passed");
    std::array<void*, kMostArguments> arguments{};
    for (std::size_t i = 0; i < launch.arguments.size(); ++i) {
      const KernelArgument& argument = launch.arguments[i];
      arguments[i] = argument.buffer != nullptr ? static_cast<void*>(bytesOf(*argument.buffer))
                                                : const_cast<void*>(argument.value);
    }
    const std::size_t items =
        std::clamp<std::size_t>(launch.work, 1, info.computeUnits * kItemsPerThread);
    forEachItem_(items, [&](std::size_t item) {
      workItem = {item, items};
      launch.call(entry->function, arguments.data());
    });
  }

  std::unique_ptr<Allocation> allocate(std::size_t bytes) override {
    constexpr std::size_t kLine = 64;  // of the cache
    auto memory = std::make_unique<HostAllocation>();
    memory->bytes.reset(
        static_cast<std::byte*>(std::aligned_alloc(kLine, (bytes + kLine - 1) / kLine * kLine)));
    if (!memory->bytes) throw std::bad_alloc();
    memory->size = bytes;
    return memory;
  }

  void bound(Allocation& memory, std::size_t bytes) override {
    auto& all = static_cast<HostAllocation&>(memory);
    ASAN_UNPOISON_MEMORY_REGION(all.bytes.get(), all.size);
    ASAN_POISON_MEMORY_REGION(all.bytes.get() + bytes, all.size - bytes);
  }

  void write(Allocation& to, const void* from, std::size_t bytes) override {
    std::memcpy(bytesOf(to), from, bytes);
  }

  void read(Allocation& from, std::size_t offset, std::size_t bytes, void* to) override {
    std::memcpy(to, bytesOf(from) + offset, bytes);
  }

  void fill(Allocation& to, const void* pattern, std::size_t patternBytes,
            std::size_t bytes) override {
    std::byte* const first = bytesOf(to);
    std::memcpy(first, pattern, std::min(patternBytes, bytes));
    for (std::size_t done = patternBytes; done < bytes; done *= 2)
      std::memcpy(first + done, first, std::min(done, bytes - done));
  }

  void copy(Allocation& from, Allocation& to, std::size_t toOffset, std::size_t bytes) override {
    std::memcpy(bytesOf(to) + toOffset, bytesOf(from), bytes);
  }

  void view(Allocation& from, std::size_t offset, std::size_t bytes,
            const ViewedBytes& use) override {
    use({bytesOf(from) + offset, bytes});
  }

 private:
  const NativeKernels& kernels_;
  ForEachItem forEachItem_;
};

}  // namespace

// What kernels/built_ins.h declares; hidden, since another copy of the library has work-items of
// its own.
extern "C" {
__attribute__((visibility("hidden"))) std::size_t sherd_global_id() { return workItem.id; }
__attribute__((visibility("hidden"))) std::size_t sherd_global_size() { return workItem.size; }
}

std::unique_ptr<DeviceImpl> builtinDevice(DeviceInfo described, const NativeKernels& kernels,
                                          ForEachItem forEachItem) {
  return std::make_unique<BuiltinDevice>(std::move(described), kernels, std::move(forEachItem));
}

DeviceFound describedBuiltin(const NativeKernels& kernels, std::uint64_t memory) {
  DeviceFound found;
  found.info.platform = kBuiltin;
  found.info.name = kernels.instructions;
  found.info.version = "OpenCL C 1.2 compiled by " + std::string(kernels.compiler);
  found.info.computeUnits = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
  found.info.memoryBytes = found.info.largestBufferBytes = memory;
  found.fault = instructionsFault(kernels.instructions);
  found.open = [info = found.info, &kernels] {
    return builtinDevice(info, kernels, onThreadsOfTbb);
  };
  return found;
}

}  // namespace sherd
