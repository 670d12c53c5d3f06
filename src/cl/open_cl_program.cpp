// Builds the embedded kernels as one program, once per device.  PoCL and GPU drivers cache the
// result on disk; to look it up PoCL preprocesses its own headers for each program.
#include <algorithm>
#include <sstream>
#include <string>

#include "base/text/lower_case.h"
#include "cl/error_name.h"
#include "cl/kernel_cache.h"
#include "cl/kernel_sources.h"
#include "cl/open_cl_device.h"

namespace sherd {
namespace {

// Joins the first lines of a compiler's log that contain a word.
std::string firstLines(const std::string& log, const char* word) {
  constexpr int kMaxLines = 3;
  constexpr std::size_t kMaxLength = 500;
  std::istringstream lines(log);
  std::string text;
  int count = 0;
  for (std::string line; count < kMaxLines && std::getline(lines, line);) {
    std::erase_if(line, [](unsigned char c) { return std::iscntrl(c) != 0; });
    if (line.empty() || lowerCase(line).find(word) == std::string::npos) continue;
    text += (text.empty() ? "" : "; ") + line;
    ++count;
  }
  text = text.substr(0, kMaxLength);
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

std::string buildLog(const cl::Program& program, const cl::Device& device) {
  try {
    return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
  } catch (const cl::Error&) {  // the driver keeps none
    return {};
  }
}

// Returns the error for a failed build.  Compiler errors name our file and line; other failures are
// the driver's.
Error buildError(const DeviceInfo& device, const std::string& log, int number) {
  const std::string errors = firstLines(log, "error"), lines = firstLines(log, "");
  std::string sentence =
      device.name + ": the kernels do not build, the driver's compiler failed with OpenCL error " +
      errorName(number);
  if (!errors.empty()) return Error(ErrorCode::device, sentence + " and reports: " + errors);
  sentence +=
      (lines.empty() ? " and gave no reason" : " and reports: " + lines) + "; try another device";
  if (device.platform == kPocl)
    sentence += ", or an empty folder as POCL_CACHE_DIR in place of " + poclCache().folder.string();
  return Error(ErrorCode::device, sentence, OptionNames{"device"});
}

}  // namespace

cl::Program builtProgram(const cl::Context& context, const cl::Device& device,
                         const DeviceInfo& info, std::string source) {
  if (source.empty()) {
    for (const std::string_view file : kernelSources()) source += file;
  }
  try {
    cl::Program program(context, source);
    // The bindings' build() queries the log at once and throws the error of that query.  -w: PoCL
    // prints the number of warnings.  -cl-kernel-arg-info: parametersOf.
    const cl_device_id id = device();
    const cl_int failed = ::clBuildProgram(
        program(), 1, &id, "-cl-std=CL1.2 -w -cl-kernel-arg-info", nullptr, nullptr);
    if (failed != CL_SUCCESS) throw buildError(info, buildLog(program, device), failed);
    return program;
  } catch (const cl::Error& e) {
    throw buildError(info, {}, e.err());
  }
}

}  // namespace sherd
