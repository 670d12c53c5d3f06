// A device of an OpenCL driver.
#pragma once

#include <array>
#include <future>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "cl/builtin_device.h"
#include "cl/device_impl.h"
#include "cl/open_cl.h"

namespace sherd {

struct OpenClAllocation : Allocation {
  explicit OpenClAllocation(cl::Buffer made) : buffer(std::move(made)) {}
  cl::Buffer buffer;
};

class OpenClDevice : public DeviceImpl {
 public:
  ///   source    of the kernels; empty for those that are embedded
  ///   compiled  the same kernels, with their parameters; empty where these are not known but from
  ///             the driver, which has no sizes of structures
  ///   throws    Error(device) it cannot be opened
  OpenClDevice(DeviceInfo described, cl::Device opened, std::string source,
               std::span<const NativeKernels::Entry> compiled);

  void buildKernels() override;
  void launch(const KernelLaunch& launch) override;
  std::unique_ptr<Allocation> allocate(std::size_t bytes) override;
  void write(Allocation& to, const void* from, std::size_t bytes) override;
  void read(Allocation& from, std::size_t offset, std::size_t bytes, void* to) override;
  void fill(Allocation& to, const void* pattern, std::size_t patternBytes,
            std::size_t bytes) override;
  void copy(Allocation& from, Allocation& to, std::size_t toOffset, std::size_t bytes) override;
  void view(Allocation& from, std::size_t offset, std::size_t bytes,
            const ViewedBytes& use) override;
  void finish() override;

  cl::Device device;
  cl::Context context;
  cl::CommandQueue queue;

  /// Whether buffers are memory of the host, so that `view` maps them.  Otherwise it copies them,
  /// part after part, to memory that the device writes fastest.
  bool hasHostMemory = true;

 private:
  struct BuiltKernel {
    cl::Kernel kernel;
    std::vector<ArgumentType> parameters;
  };
  BuiltKernel& kernel(const char* name);
  std::shared_ptr<void> mapped(const cl::Buffer& buffer, cl_map_flags use, std::size_t offset,
                               std::size_t bytes);
  std::byte* stage(std::size_t index);

  std::string source_;
  std::span<const NativeKernels::Entry> compiled_;
  std::array<std::shared_ptr<void>, 2> stages_;
  std::shared_future<cl::Program> program_;  // contains all kernels
  std::map<std::string, BuiltKernel, std::less<>> kernels_;
};

/// Returns the parameters of a built kernel, of unknown types where the driver keeps none.
[[nodiscard]] std::vector<ArgumentType> parametersOf(const cl::Kernel& kernel);

/// Builds the kernels as one program.
///   source  empty for those that are embedded
///   throws  Error(device) with the build log's first lines
[[nodiscard]] cl::Program builtProgram(const cl::Context& context, const cl::Device& device,
                                       const DeviceInfo& info, std::string source);

}  // namespace sherd
