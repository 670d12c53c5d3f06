// What a process can do after it was forked.
//
// Neither OpenCL's drivers nor TBB's threads survive a fork.  Before one, TBB is stopped, so that
// both processes make its threads anew; if it cannot be stopped, because a fracture is under way
// on another thread, the forked process refuses to work.
#pragma once

#include <nanobind/nanobind.h>
#include <sherd/device.h>

#include <memory>
#include <string>

namespace pysherd {

/// A device for one job.  Devices are opened when a job needs one, kept for the next, and belong
/// to the process that opened them.
class LeasedDevice {
 public:
  ///   choice  as of sherd::Device
  ///   throws  Error(device) nothing matches; OpenCL was used before this process was forked
  explicit LeasedDevice(std::string choice);
  ~LeasedDevice();
  LeasedDevice(const LeasedDevice&) = delete;
  LeasedDevice& operator=(const LeasedDevice&) = delete;

  [[nodiscard]] sherd::Device& operator*() { return *device_; }

 private:
  std::string choice_;
  std::unique_ptr<sherd::Device> device_;
};

/// Checks that this process has threads, or can make them.
///   throws  Error(device) it was forked while a fracture was under way, or not by Python
void requireUsableProcess();

/// Whether requireUsableProcess() would throw.
[[nodiscard]] bool isUsableProcess();

void bindProcess(nanobind::module_& module);

}  // namespace pysherd
