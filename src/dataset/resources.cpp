// Samples the resources of a run every second.
#include "dataset/resources.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

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

ResourceSampler::ResourceSampler(const Device& device)
    : device_(device), lastCpu_(cpuSeconds()), thread_([this] {
        std::unique_lock lock(mutex_);
        while (!wake_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; })) sample();
      }) {}

ResourceSampler::~ResourceSampler() { (void)finish(); }

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
    done_ = true;
  }
  wake_.notify_all();
  if (!thread_.joinable()) return {};
  thread_.join();
  sample();
  return std::move(samples_);
}

}  // namespace sherd
