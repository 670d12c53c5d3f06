// Building the embedded kernels.  A program is built once for a device; PoCL and GPU drivers keep
// the result on disk.
#include <algorithm>

#include "cl/device_impl.h"
#include "cl/kernel_sources.h"

namespace sherd {

cl::Kernel Device::Impl::kernel(const std::string& file, const char* name,
                                const std::string& options) {
  return withDevice(*this, name, [&] {
    const std::string key = file + ' ' + options;
    auto program = programs.find(key);
    if (program == programs.end()) {
      std::string text;
      for (const kernels::Source& source : kernels::sources()) {
        if (source.file.ends_with(".h") || source.file == file) text += source.text;
      }
      cl::Program built(context, text);
      try {
        built.build(device, ("-cl-std=CL1.2 " + options).c_str());
      } catch (const cl::Error&) {
        std::string log = built.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
        throw Error(ErrorCode::device,
                    info.name + ": " + file + " does not build: " + log.substr(0, 500));
      }
      program = programs.emplace(key, std::move(built)).first;
    }
    return cl::Kernel(program->second, name);
  });
}

void Device::Impl::launch(cl::Kernel& kernel, std::size_t work, std::size_t group) {
  const std::size_t items = std::clamp<std::size_t>(work, 1, std::max(workItems(), group));
  queue.enqueueNDRangeKernel(kernel, cl::NullRange,
                             cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
}

}  // namespace sherd
