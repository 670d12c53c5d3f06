// A kernel with a deliberate data race.  tools/release/check_kernels.sh runs it under oclgrind and
// fails if no race is reported: a checker that misses this one proves nothing about the real
// kernels.
#include <sherd/device.h>

#include <iostream>

#include "cl/open_cl_device.h"

int main() {
  sherd::Device device("oclgrind");
  auto& impl = dynamic_cast<sherd::OpenClDevice&>(implOf(device));
  cl::Program program(impl.context,
                      "kernel void race(global uint* sum) { sum[0] += (uint)get_global_id(0); }");
  program.build(impl.device);
  const cl::Buffer sum(impl.context, CL_MEM_READ_WRITE, sizeof(cl_uint));
  impl.queue.enqueueFillBuffer<cl_uint>(sum, cl_uint{0}, 0, sizeof(cl_uint));
  cl::Kernel kernel(program, "race");
  kernel.setArg(0, sum);
  impl.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(64), cl::NDRange(8));
  impl.queue.finish();
  std::cout << "ran on " << impl.info.name << '\n';
}
