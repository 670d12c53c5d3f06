// Building the embedded kernels: all in one program, once for a device.  PoCL and GPU drivers keep
// the result on disk; to find it there PoCL runs its preprocessor over its own headers for each
// program.
#include <algorithm>
#include <string>

#include "cl/device_impl.h"
#include "cl/kernel_sources.h"

namespace sherd {
namespace {

cl::Program built(const cl::Context& context, const cl::Device& device, const std::string& name) {
  std::string text;
  for (const std::string_view source : kernels::sources()) text += source;
  cl::Program program(context, text);
  try {
    program.build(device, "-cl-std=CL1.2");
  } catch (const cl::Error&) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    throw Error(ErrorCode::device, name + ": the kernels do not build: " + log.substr(0, 500));
  }
  return program;
}

}  // namespace

void Device::Impl::buildKernels() {
  if (!program.valid()) program = std::async(std::launch::async, built, context, device, info.name);
}

cl::Kernel Device::Impl::kernel(const char* name) {
  buildKernels();
  return withDevice(*this, name, [&] { return cl::Kernel(program.get(), name); });
}

void Device::Impl::launch(cl::Kernel& kernel, std::size_t work, std::size_t group) {
  const std::size_t items = std::clamp<std::size_t>(work, 1, std::max(workItems(), group));
  queue.enqueueNDRangeKernel(kernel, cl::NullRange,
                             cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
}

}  // namespace sherd
