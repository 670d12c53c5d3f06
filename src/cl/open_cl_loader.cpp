// OpenCL's functions, found when they are first called: the program runs where there is no loader
// (libOpenCL), and finds what a checker has put before it (LD_PRELOAD).  The bindings of
// <CL/opencl.hpp> call these.
#include <dlfcn.h>

#include "cl/open_cl.h"

namespace sherd {
namespace {

// Returns a function of the loader; null if there is none.
void* found(const char* name) {
  static void* const loader = ::dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_GLOBAL);  // never closed
  static_cast<void>(loader);
  return ::dlsym(RTLD_DEFAULT, name);
}

template <class Function>
Function* real(Function*, const char* name) {
  return reinterpret_cast<Function*>(found(name));
}

}  // namespace

std::string loaderFault() {
  if (found("clGetPlatformIDs") != nullptr) return {};
  return "its loader libOpenCL.so.1 cannot be opened (Debian's ocl-icd-libopencl1)";
}

}  // namespace sherd

// Hidden, so that no library of the process calls these in place of the loader's.
#define SHERD_CL_HIDDEN extern "C" __attribute__((visibility("hidden")))

#define SHERD_CL(result, name, parameters, arguments)         \
  SHERD_CL_HIDDEN result CL_API_CALL name parameters {        \
    static const auto function = sherd::real(&::name, #name); \
    return function arguments;                                \
  }

SHERD_CL(cl_int, clGetPlatformIDs, (cl_uint a, cl_platform_id* b, cl_uint* c), (a, b, c))
SHERD_CL(cl_int, clGetPlatformInfo,
         (cl_platform_id a, cl_platform_info b, size_t c, void* d, size_t* e), (a, b, c, d, e))
SHERD_CL(cl_int, clGetDeviceIDs,
         (cl_platform_id a, cl_device_type b, cl_uint c, cl_device_id* d, cl_uint* e),
         (a, b, c, d, e))
SHERD_CL(cl_int, clGetDeviceInfo, (cl_device_id a, cl_device_info b, size_t c, void* d, size_t* e),
         (a, b, c, d, e))
SHERD_CL(cl_int, clRetainDevice, (cl_device_id a), (a))
SHERD_CL(cl_int, clReleaseDevice, (cl_device_id a), (a))
SHERD_CL(cl_context, clCreateContext,
         (const cl_context_properties* a, cl_uint b, const cl_device_id* c,
          void(CL_CALLBACK* d)(const char*, const void*, size_t, void*), void* e, cl_int* f),
         (a, b, c, d, e, f))
SHERD_CL(cl_int, clRetainContext, (cl_context a), (a))
SHERD_CL(cl_int, clReleaseContext, (cl_context a), (a))
SHERD_CL(cl_int, clGetContextInfo, (cl_context a, cl_context_info b, size_t c, void* d, size_t* e),
         (a, b, c, d, e))
SHERD_CL(cl_command_queue, clCreateCommandQueue,
         (cl_context a, cl_device_id b, cl_command_queue_properties c, cl_int* d), (a, b, c, d))
SHERD_CL(cl_int, clRetainCommandQueue, (cl_command_queue a), (a))
SHERD_CL(cl_int, clReleaseCommandQueue, (cl_command_queue a), (a))
SHERD_CL(cl_program, clCreateProgramWithSource,
         (cl_context a, cl_uint b, const char** c, const size_t* d, cl_int* e), (a, b, c, d, e))
SHERD_CL(cl_int, clBuildProgram,
         (cl_program a, cl_uint b, const cl_device_id* c, const char* d,
          void(CL_CALLBACK* e)(cl_program, void*), void* f),
         (a, b, c, d, e, f))
SHERD_CL(cl_int, clGetProgramBuildInfo,
         (cl_program a, cl_device_id b, cl_program_build_info c, size_t d, void* e, size_t* f),
         (a, b, c, d, e, f))
SHERD_CL(cl_int, clRetainProgram, (cl_program a), (a))
SHERD_CL(cl_int, clReleaseProgram, (cl_program a), (a))
SHERD_CL(cl_kernel, clCreateKernel, (cl_program a, const char* b, cl_int* c), (a, b, c))
SHERD_CL(cl_int, clGetKernelArgInfo,
         (cl_kernel a, cl_uint b, cl_kernel_arg_info c, size_t d, void* e, size_t* f),
         (a, b, c, d, e, f))
SHERD_CL(cl_int, clSetKernelArg, (cl_kernel a, cl_uint b, size_t c, const void* d), (a, b, c, d))
SHERD_CL(cl_int, clRetainKernel, (cl_kernel a), (a))
SHERD_CL(cl_int, clReleaseKernel, (cl_kernel a), (a))
SHERD_CL(cl_mem, clCreateBuffer, (cl_context a, cl_mem_flags b, size_t c, void* d, cl_int* e),
         (a, b, c, d, e))
SHERD_CL(cl_int, clRetainMemObject, (cl_mem a), (a))
SHERD_CL(cl_int, clReleaseMemObject, (cl_mem a), (a))
SHERD_CL(cl_int, clEnqueueNDRangeKernel,
         (cl_command_queue a, cl_kernel b, cl_uint c, const size_t* d, const size_t* e,
          const size_t* f, cl_uint g, const cl_event* h, cl_event* i),
         (a, b, c, d, e, f, g, h, i))
SHERD_CL(cl_int, clEnqueueReadBuffer,
         (cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, void* f, cl_uint g,
          const cl_event* h, cl_event* i),
         (a, b, c, d, e, f, g, h, i))
SHERD_CL(cl_int, clEnqueueWriteBuffer,
         (cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, const void* f, cl_uint g,
          const cl_event* h, cl_event* i),
         (a, b, c, d, e, f, g, h, i))
SHERD_CL(cl_int, clEnqueueCopyBuffer,
         (cl_command_queue a, cl_mem b, cl_mem c, size_t d, size_t e, size_t f, cl_uint g,
          const cl_event* h, cl_event* i),
         (a, b, c, d, e, f, g, h, i))
SHERD_CL(cl_int, clEnqueueFillBuffer,
         (cl_command_queue a, cl_mem b, const void* c, size_t d, size_t e, size_t f, cl_uint g,
          const cl_event* h, cl_event* i),
         (a, b, c, d, e, f, g, h, i))
SHERD_CL(void*, clEnqueueMapBuffer,
         (cl_command_queue a, cl_mem b, cl_bool c, cl_map_flags d, size_t e, size_t f, cl_uint g,
          const cl_event* h, cl_event* i, cl_int* j),
         (a, b, c, d, e, f, g, h, i, j))
SHERD_CL(cl_int, clEnqueueUnmapMemObject,
         (cl_command_queue a, cl_mem b, void* c, cl_uint d, const cl_event* e, cl_event* f),
         (a, b, c, d, e, f))
SHERD_CL(cl_int, clFinish, (cl_command_queue a), (a))
SHERD_CL(cl_int, clRetainEvent, (cl_event a), (a))
SHERD_CL(cl_int, clReleaseEvent, (cl_event a), (a))
SHERD_CL(cl_int, clGetCommandQueueInfo,
         (cl_command_queue a, cl_command_queue_info b, size_t c, void* d, size_t* e),
         (a, b, c, d, e))
SHERD_CL(cl_int, clGetKernelInfo, (cl_kernel a, cl_kernel_info b, size_t c, void* d, size_t* e),
         (a, b, c, d, e))
SHERD_CL(cl_int, clGetProgramInfo, (cl_program a, cl_program_info b, size_t c, void* d, size_t* e),
         (a, b, c, d, e))
SHERD_CL(cl_int, clWaitForEvents, (cl_uint a, const cl_event* b), (a, b))
SHERD_CL(cl_int, clGetMemObjectInfo, (cl_mem a, cl_mem_info b, size_t c, void* d, size_t* e),
         (a, b, c, d, e))
