// Arguments of a launch against the parameters of its kernel.
#include "cl/kernel_launch.h"

namespace sherd {
namespace {

bool agree(const ArgumentType& parameter, const ArgumentType& argument) {
  if (parameter.kind == ArgumentKind::unknown) return true;
  return parameter.kind == argument.kind &&
         (parameter.bytes == 0 || parameter.bytes == argument.bytes);
}

std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// What both are followed by: the next step.
constexpr const char* kMakeTheSame = "; declare in kernels/ what the launch in src/ gives";

}  // namespace

std::string nameOf(const ArgumentType& type) {
  const std::string bytes = type.bytes > 0 ? " of " + counted(type.bytes, "byte") : "";
  switch (type.kind) {
    case ArgumentKind::buffer:
      return "a buffer";
    case ArgumentKind::integer:
      return "an integer" + bytes;
    case ArgumentKind::real:
      return "a floating-point number" + bytes;
    case ArgumentKind::structure:
      return "a structure" + bytes;
    case ArgumentKind::vector:
      return "a vector" + bytes;
    case ArgumentKind::unknown:
      break;
  }
  return "of an unknown type";
}

Error argumentError(const KernelLaunch& launch, std::size_t index, const std::string& reason) {
  return Error(ErrorCode::internal, "parameter " + std::to_string(index + 1) + " of the kernel " +
                                        launch.kernel + " " + reason + kMakeTheSame);
}

void checkArguments(const KernelLaunch& launch, std::span<const ArgumentType> parameters) {
  if (parameters.size() != launch.arguments.size()) {
    throw Error(ErrorCode::internal, std::string("the kernel ") + launch.kernel + " has " +
                                         counted(parameters.size(), "parameter") + ", its launch " +
                                         counted(launch.arguments.size(), "argument") +
                                         kMakeTheSame);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ArgumentType& given = launch.arguments[i].type;
    if (!agree(parameters[i], given))
      throw argumentError(launch, i,
                          "is " + nameOf(parameters[i]) + ", its argument " + nameOf(given));
  }
}

}  // namespace sherd
