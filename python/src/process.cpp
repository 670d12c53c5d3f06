// What a process can do after it was forked.
#include "process.h"

#include <sherd/error.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "job.h"

namespace pysherd {
namespace {

using sherd::Error;
using sherd::ErrorCode;

// The devices of one process.  Never destroyed, since its threads may outlive main().
struct Devices {
  std::mutex mutex;
  std::map<std::string, std::vector<std::unique_ptr<sherd::Device>>> idle;
  bool hasOpenCl = false;   // a device of this process may have loaded OpenCL's drivers
  bool lostOpenCl = false;  // a device of the process that this one was forked from had
};
Devices* devices = new Devices;

pid_t process = ::getpid();     // that `devices` and TBB's threads belong to
bool canContinueForked = true;  // TBB was stopped before the last fork
bool isLost = false;            // it was not, and this is the forked process

// Waits for the threads of TBB to end.  On a thread of its own, so that the caller's never counts
// as one that uses TBB.
bool stopThreadsOfTbb() {
  bool isStopped = false;
  try {
    std::thread([&] {
      tbb::task_scheduler_handle handle{tbb::attach{}};
      isStopped = tbb::finalize(handle, std::nothrow);
    }).join();
  } catch (const std::system_error&) {  // there is no thread
  }
  return isStopped;
}

void beforeFork() {
  waitForCancelled(std::chrono::seconds(2));
  stopIdleThreads();
  canContinueForked = runningJobs() == 0 && stopThreadsOfTbb();
}

void afterForkInChild() {
  const bool hadOpenCl = devices->hasOpenCl || devices->lostOpenCl;
  devices = new Devices;
  devices->lostOpenCl = hadOpenCl;
  forgetJobs();
  isLost = isLost || !canContinueForked;
  process = ::getpid();
}

}  // namespace

bool isUsableProcess() { return ::getpid() == process && !isLost; }

void requireUsableProcess() {
  if (::getpid() != process) {
    throw Error(ErrorCode::device,
                "this process was forked without Python's knowledge, so it has no threads; start "
                "processes by os.fork or multiprocessing");
  }
  if (isLost) {
    throw Error(ErrorCode::device,
                "this process was forked while a fracture was under way on another thread, so it "
                "has no threads; fork between fractures, or use multiprocessing's 'spawn'");
  }
}

LeasedDevice::LeasedDevice(std::string choice) : choice_(std::move(choice)) {
  const bool mayUseOpenCl = sherd::mayUseOpenCl(choice_);
  {
    const std::lock_guard lock(devices->mutex);
    if (mayUseOpenCl && devices->lostOpenCl) {
      throw Error(ErrorCode::device,
                  "this process was forked from one that used OpenCL, whose drivers do not survive "
                  "that; use the device 'builtin', or multiprocessing's 'spawn'");
    }
    devices->hasOpenCl = devices->hasOpenCl || mayUseOpenCl;
    auto& idle = devices->idle[choice_];
    if (!idle.empty()) {
      device_ = std::move(idle.back());
      idle.pop_back();
      return;
    }
  }
  device_ = std::make_unique<sherd::Device>(choice_);
}

LeasedDevice::~LeasedDevice() {
  const std::lock_guard lock(devices->mutex);
  devices->idle[choice_].push_back(std::move(device_));
}

void bindProcess(nanobind::module_& module) {
  module.def("before_fork", beforeFork);
  module.def("after_fork_in_child", afterForkInChild);
}

}  // namespace pysherd
