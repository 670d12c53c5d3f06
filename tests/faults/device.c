// The device: an OpenCL call that fails.
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include "faults.h"

static cl_int failed(cl_int* reported) {
  if (reported) *reported = faultError();
  return faultError();
}

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count,
                           const cl_device_id* devices,
                           void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*),
                           void* data, cl_int* error) {
  __typeof__(&clCreateContext) real = faultReal("clCreateContext");
  if (faultNow("device")) return failed(error), NULL;
  return real(properties, count, devices, notify, data, error);
}

cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device,
                                      cl_command_queue_properties properties, cl_int* error) {
  __typeof__(&clCreateCommandQueue) real = faultReal("clCreateCommandQueue");
  if (faultNow("device")) return failed(error), NULL;
  return real(context, device, properties, error);
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host,
                      cl_int* error) {
  __typeof__(&clCreateBuffer) real = faultReal("clCreateBuffer");
  if (faultNow("device")) return failed(error), NULL;
  return real(context, flags, size, host, error);
}

// Source that does not compile: its log names the file and line.
cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** strings,
                                     const size_t* lengths, cl_int* error) {
  __typeof__(&clCreateProgramWithSource) real = faultReal("clCreateProgramWithSource");
  if (!faultNow("source")) return real(context, count, strings, lengths, error);
  const char* broken = "#line 7 \"broken.cl\"\nkernel void broken() { missing(); }\n";
  return real(context, 1, &broken, NULL, error);
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices,
                      const char* options, void(CL_CALLBACK* notify)(cl_program, void*),
                      void* data) {
  __typeof__(&clBuildProgram) real = faultReal("clBuildProgram");
  if (faultNow("device")) return failed(NULL);
  return real(program, count, devices, options, notify, data);
}

cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* error) {
  __typeof__(&clCreateKernel) real = faultReal("clCreateKernel");
  if (faultNow("device")) return failed(error), NULL;
  return real(program, name, error);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local,
                              cl_uint count, const cl_event* waits, cl_event* event) {
  __typeof__(&clEnqueueNDRangeKernel) real = faultReal("clEnqueueNDRangeKernel");
  if (faultNow("device")) return failed(NULL);
  return real(queue, kernel, dimensions, offset, global, local, count, waits, event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                           size_t size, void* to, cl_uint count, const cl_event* waits,
                           cl_event* event) {
  __typeof__(&clEnqueueReadBuffer) real = faultReal("clEnqueueReadBuffer");
  if (faultNow("device")) return failed(NULL);
  return real(queue, buffer, blocking, offset, size, to, count, waits, event);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                            size_t size, const void* from, cl_uint count, const cl_event* waits,
                            cl_event* event) {
  __typeof__(&clEnqueueWriteBuffer) real = faultReal("clEnqueueWriteBuffer");
  if (faultNow("device")) return failed(NULL);
  return real(queue, buffer, blocking, offset, size, from, count, waits, event);
}

void* clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                         cl_map_flags flags, size_t offset, size_t size, cl_uint count,
                         const cl_event* waits, cl_event* event, cl_int* error) {
  __typeof__(&clEnqueueMapBuffer) real = faultReal("clEnqueueMapBuffer");
  if (faultNow("device")) return failed(error), NULL;
  return real(queue, buffer, blocking, flags, offset, size, count, waits, event, error);
}

cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern,
                           size_t length, size_t offset, size_t size, cl_uint count,
                           const cl_event* waits, cl_event* event) {
  __typeof__(&clEnqueueFillBuffer) real = faultReal("clEnqueueFillBuffer");
  if (faultNow("device")) return failed(NULL);
  return real(queue, buffer, pattern, length, offset, size, count, waits, event);
}

cl_int clFinish(cl_command_queue queue) {
  __typeof__(&clFinish) real = faultReal("clFinish");
  return faultNow("device") ? failed(NULL) : real(queue);
}
