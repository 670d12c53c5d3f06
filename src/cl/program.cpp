// Building the embedded kernels: all in one program, once for a device.  PoCL and GPU drivers keep
// the result on disk; to find it there PoCL runs its preprocessor over its own headers for each
// program.
#include <algorithm>
#include <string>

#include "cl/device_impl.h"
#include "cl/kernel_sources.h"

namespace sherd {
namespace {

cl::Program built(const Device::Impl& impl) {
  std::string text;
  for (const std::string_view source : kernels::sources()) text += source;
  cl::Program program(impl.context, text);
  try {
    program.build(impl.device, "-cl-std=CL1.2");
  } catch (const cl::Error&) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(impl.device);
    throw Error(ErrorCode::device,
                impl.info.name + ": the kernels do not build: " + log.substr(0, 500));
  }
  return program;
}

}  // namespace

cl::Kernel Device::Impl::kernel(const char* name) {
  return withDevice(*this, name, [&] {
    if (!program) program = built(*this);
    return cl::Kernel(*program, name);
  });
}

void Device::Impl::launch(cl::Kernel& kernel, std::size_t work, std::size_t group) {
  const std::size_t items = std::clamp<std::size_t>(work, 1, std::max(workItems(), group));
  queue.enqueueNDRangeKernel(kernel, cl::NullRange,
                             cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
}

}  // namespace sherd
