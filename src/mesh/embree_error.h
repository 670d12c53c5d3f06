// Embree's errors as ours.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/error.h>

#include <new>
#include <string>

namespace sherd {

///   device  null where none could be made
///   throws  bad_alloc; Error(code) what else went wrong since it was last asked, beginning with
///           `task`
inline void checkEmbree(RTCDevice device, ErrorCode code, const std::string& task) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error(code, task + ": Embree failed with error " + std::to_string(static_cast<int>(error)));
}

}  // namespace sherd
