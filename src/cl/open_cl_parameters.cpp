// What an OpenCL driver reports of a kernel's parameters.
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "cl/open_cl_device.h"

namespace sherd {
namespace {

struct Scalar {
  std::string_view name;
  ArgumentType type;
};
constexpr std::array<Scalar, 11> kScalars{{{"char", {ArgumentKind::integer, 1}},
                                           {"uchar", {ArgumentKind::integer, 1}},
                                           {"short", {ArgumentKind::integer, 2}},
                                           {"ushort", {ArgumentKind::integer, 2}},
                                           {"int", {ArgumentKind::integer, 4}},
                                           {"uint", {ArgumentKind::integer, 4}},
                                           {"long", {ArgumentKind::integer, 8}},
                                           {"ulong", {ArgumentKind::integer, 8}},
                                           {"half", {ArgumentKind::real, 2}},
                                           {"float", {ArgumentKind::real, 4}},
                                           {"double", {ArgumentKind::real, 8}}}};

// The size of a structure is not reported: the driver compares it.
ArgumentType typeNamed(std::string_view name) {
  if (name.starts_with("struct ")) return {ArgumentKind::structure, 0};
  const auto found = std::find_if(kScalars.begin(), kScalars.end(),
                                  [&](const Scalar& each) { return each.name == name; });
  if (found != kScalars.end()) return found->type;
  const std::size_t digits = name.find_first_of("0123456789");
  if (digits != std::string_view::npos && typeNamed(name.substr(0, digits)).bytes > 0)
    return {ArgumentKind::vector, 0};
  return {};
}

ArgumentType parameterAt(const cl::Kernel& kernel, cl_uint index) {
  try {
    if (kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(index) != CL_KERNEL_ARG_ADDRESS_PRIVATE)
      return {ArgumentKind::buffer, sizeof(cl_mem)};
    std::string name = kernel.getArgInfo<CL_KERNEL_ARG_TYPE_NAME>(index);
    while (!name.empty() && name.back() == '\0') name.pop_back();  // older bindings keep it
    return typeNamed(name);
  } catch (const cl::Error&) {  // the driver keeps none
    return {};
  }
}

}  // namespace

std::vector<ArgumentType> parametersOf(const cl::Kernel& kernel) {
  std::vector<ArgumentType> all(kernel.getInfo<CL_KERNEL_NUM_ARGS>());
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = parameterAt(kernel, static_cast<cl_uint>(i));
  return all;
}

}  // namespace sherd
