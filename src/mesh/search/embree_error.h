// Translation of Embree's errors.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/error.h>

#include <new>
#include <string>

namespace sherd {

/// Throws the device's pending error.
///   device  null if it could not be created
///   throws  std::bad_alloc; Error(code) for other errors since the last check, prefixed by `task`
inline void checkEmbree(RTCDevice device, ErrorCode code, const std::string& task) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error(code, task + ": Embree failed with error " + std::to_string(static_cast<int>(error)));
}

}  // namespace sherd
