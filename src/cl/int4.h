// OpenCL's int4, as an element of buffers.
#pragma once

#include <cstdint>

namespace sherd {

struct alignas(16) Int4 {
  std::int32_t x = 0, y = 0, z = 0, w = 0;
};

}  // namespace sherd
