// Commands of an OpenCL device.
#include "cl/open_cl_device.h"

#include "base/threads.h"
#include "cl/error_name.h"
#include "cl/kernel_cache.h"

namespace sherd {
namespace {

cl::Buffer& bufferOf(Allocation& memory) { return static_cast<OpenClAllocation&>(memory).buffer; }

// Gives a kernel one argument.  A driver that keeps no types of parameters may know their sizes.
void setArgument(cl::Kernel& kernel, const KernelLaunch& launch, std::size_t index) {
  const KernelArgument& argument = launch.arguments[index];
  const auto number = static_cast<cl_uint>(index);
  const cl_int failed =
      argument.buffer != nullptr
          ? ::clSetKernelArg(kernel(), number, sizeof(cl_mem), &bufferOf(*argument.buffer)())
          : ::clSetKernelArg(kernel(), number, argument.type.bytes, argument.value);
  if (failed == CL_INVALID_ARG_SIZE || failed == CL_INVALID_ARG_VALUE ||
      failed == CL_INVALID_MEM_OBJECT) {
    throw argumentError(launch, index,
                        "does not take its argument, " + nameOf(argument.type) +
                            ", with OpenCL error " + errorName(failed));
  }
  if (failed != CL_SUCCESS) throw cl::Error(failed, "clSetKernelArg");
}

// Runs `body`; errors of the OpenCL bindings become Error(device).
template <class Body>
auto translated(const DeviceInfo& device, const char* doing, Body&& body) {
  try {
    return body();
  } catch (const cl::Error& e) {
    throw Error(ErrorCode::device,
                device.name + ": " + doing + " failed in " + e.what() + " with OpenCL error " +
                    errorName(e.err()) + "; try another device",
                OptionNames{"device"});
  }
}

}  // namespace

OpenClDevice::OpenClDevice(DeviceInfo described, cl::Device opened, std::string source,
                           std::span<const NativeKernels::Entry> compiled)
    : device(std::move(opened)), source_(std::move(source)), compiled_(compiled) {
  info = std::move(described);
  if (info.platform == kPocl) {  // its compiler ends the process if it cannot write
    const KernelCache cache = poclCache();
    if (!cache.fault.empty()) throw Error(ErrorCode::device, cacheFaultMessage(cache));
    if (const std::string fault = linkerFault(); !fault.empty())
      throw Error(ErrorCode::device, fault);
  }
  translated(info, "opening the device", [&] {
    context = cl::Context(device);
    queue = cl::CommandQueue(context, device);
    hasHostMemory = device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>() != 0;
  });
}

void OpenClDevice::buildKernels() {
  if (!program_.valid()) program_ = startedTask(builtProgram, context, device, info, source_);
}

OpenClDevice::BuiltKernel& OpenClDevice::kernel(const char* name) {
  const auto found = kernels_.find(name);
  if (found != kernels_.end()) return found->second;
  buildKernels();
  cl_int failed = CL_SUCCESS;
  const cl_kernel made = ::clCreateKernel(program_.get()(), name, &failed);
  if (failed == CL_INVALID_KERNEL_NAME)
    throw Error(ErrorCode::internal, std::string("there is no kernel ") + name);
  if (failed != CL_SUCCESS) throw cl::Error(failed, "clCreateKernel");
  BuiltKernel built{cl::Kernel(made), {}};
  const auto entry = std::find_if(compiled_.begin(), compiled_.end(),
                                  [&](const auto& each) { return each.name == name; });
  if (entry != compiled_.end())
    built.parameters.assign(entry->parameters.begin(), entry->parameters.end());
  else
    built.parameters = parametersOf(built.kernel);
  return kernels_.emplace(name, std::move(built)).first->second;
}

void OpenClDevice::launch(const KernelLaunch& launch) {
  // As many work-items as saturate the device when each takes many leaves; where loops end early,
  // one for each leaf.
  const std::size_t most = std::max(
      info.computeUnits * (info.gpu ? std::size_t{1024} : 8 * workGroupSize()), launch.group);
  const std::size_t items =
      std::max<std::size_t>(info.caveat.empty() ? std::min(launch.work, most) : launch.work, 1);
  translated(info, launch.kernel, [&] {
    BuiltKernel& built = kernel(launch.kernel);
    checkArguments(launch, built.parameters);
    for (std::size_t i = 0; i < launch.arguments.size(); ++i) setArgument(built.kernel, launch, i);
    queue.enqueueNDRangeKernel(
        built.kernel, cl::NullRange,
        cl::NDRange((items + launch.group - 1) / launch.group * launch.group),
        cl::NDRange(launch.group));
  });
}

std::unique_ptr<Allocation> OpenClDevice::allocate(std::size_t bytes) {
  return translated(info, "allocating a buffer", [&] {
    return std::make_unique<OpenClAllocation>(cl::Buffer(context, CL_MEM_READ_WRITE, bytes));
  });
}

// (No CL_MEM_USE_HOST_PTR: oclgrind reports false errors for it.)
void OpenClDevice::write(Allocation& to, const void* from, std::size_t bytes) {
  translated(info, "writing a buffer",
             [&] { queue.enqueueWriteBuffer(bufferOf(to), CL_TRUE, 0, bytes, from); });
}

void OpenClDevice::read(Allocation& from, std::size_t offset, std::size_t bytes, void* to) {
  translated(info, "reading a buffer",
             [&] { queue.enqueueReadBuffer(bufferOf(from), CL_TRUE, offset, bytes, to); });
}

void OpenClDevice::fill(Allocation& to, const void* pattern, std::size_t patternBytes,
                        std::size_t bytes) {
  translated(info, "filling a buffer", [&] {
    const cl_int error = ::clEnqueueFillBuffer(queue(), bufferOf(to)(), pattern, patternBytes, 0,
                                               bytes, 0, nullptr, nullptr);
    if (error != CL_SUCCESS) throw cl::Error(error, "clEnqueueFillBuffer");
  });
}

void OpenClDevice::copy(Allocation& from, Allocation& to, std::size_t toOffset, std::size_t bytes) {
  translated(info, "copying a buffer",
             [&] { queue.enqueueCopyBuffer(bufferOf(from), bufferOf(to), 0, toOffset, bytes); });
}

// Maps bytes of a buffer until the pointer is gone.
std::shared_ptr<void> OpenClDevice::mapped(const cl::Buffer& buffer, cl_map_flags use,
                                           std::size_t offset, std::size_t bytes) {
  void* const data = queue.enqueueMapBuffer(buffer, CL_TRUE, use, offset, bytes);
  return {data, [this, buffer](void* held) {
            ::clEnqueueUnmapMemObject(queue(), buffer(), held, 0, nullptr, nullptr);
          }};
}

// One of two pieces of page-locked memory, which a GPU writes at the speed of its bus.
std::byte* OpenClDevice::stage(std::size_t index) {
  std::shared_ptr<void>& memory = stages_[index];
  if (!memory) {
    const cl::Buffer buffer(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, kViewedBytes);
    memory = mapped(buffer, CL_MAP_READ | CL_MAP_WRITE, 0, kViewedBytes);
  }
  return static_cast<std::byte*>(memory.get());
}

void OpenClDevice::view(Allocation& from, std::size_t offset, std::size_t bytes,
                        const ViewedBytes& use) {
  translated(info, "reading a buffer", [&] {
    if (hasHostMemory) {
      const std::shared_ptr<void> data = mapped(bufferOf(from), CL_MAP_READ, offset, bytes);
      use({static_cast<const std::byte*>(data.get()), bytes});
      return;
    }
    // The device writes a part while the one before is used.
    std::array<cl::Event, 2> written;
    const auto fetch = [&](std::size_t part) {
      const std::size_t at = part * kViewedBytes;
      if (at < bytes)
        queue.enqueueReadBuffer(bufferOf(from), CL_FALSE, offset + at,
                                std::min(kViewedBytes, bytes - at), stage(part % 2), nullptr,
                                &written[part % 2]);
    };
    fetch(0);
    for (std::size_t part = 0; part * kViewedBytes < bytes; ++part) {
      fetch(part + 1);
      written[part % 2].wait();
      use({stage(part % 2), std::min(kViewedBytes, bytes - part * kViewedBytes)});
    }
  });
}

void OpenClDevice::finish() {
  translated(info, "waiting for the device", [&] { queue.finish(); });
}

}  // namespace sherd
