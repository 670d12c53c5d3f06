// Samples the resources of a run every second.
#include "dataset/report/resources.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <new>
#include <system_error>
#include <utility>

namespace sherd {
namespace {

double cpuSeconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::uint64_t residentBytes() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  in >> all >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

std::uint64_t peakMemory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

ResourceSampler::ResourceSampler(const Device& device) : device_(device), lastCpu_(cpuSeconds()) {
  try {
    thread_ = std::thread([this] { work(); });
  } catch (const std::system_error&) {  // a run without samples but the last is a run nevertheless
  }
}

void ResourceSampler::work() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; })) {
    try {
      sample();
    } catch (const std::bad_alloc&) {  // the sample is left out
    }
  }
}

ResourceSampler::~ResourceSampler() {
  try {
    (void)finish();
  } catch (const std::bad_alloc&) {  // by the last sample, which nobody reads
  }
}

void ResourceSampler::sample() {
  const double now =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  const double cpu = cpuSeconds();
  samples_.push_back({now, (cpu - lastCpu_) / std::max(now - lastSeconds_, 1e-9), residentBytes(),
                      device_.memory().bytes});
  lastSeconds_ = now;
  lastCpu_ = cpu;
}

std::vector<ResourceSample> ResourceSampler::finish() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(done_, true)) return {};
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  sample();
  return std::move(samples_);
}

}  // namespace sherd
