// `sherd doctor`: drivers, devices, and a test of the kernels.
#include <fcntl.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/labels.h>
#include <sherd/solid.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <sstream>
#include <thread>

#include "base/files/atomic_file.h"
#include "cli/doctor/doctor.h"
#include "cli/terminal/command.h"
#include "cli/terminal/foreign_exit.h"
#include "cli/terminal/interrupts.h"

namespace sherd::cli {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr unsigned kMostSeconds = 300;  // a driver builds the kernels in 3 to 10 s

Json textOrNull(const std::string& text) { return text.empty() ? Json() : Json(text); }

// ---- In the separate process

Json driverFacts() {
  Json drivers = Json::array();
  for (const DriverFile& driver : listDrivers()) {
    drivers.push_back({{"file", driver.file.string()},
                       {"library", driver.library},
                       {"fault", textOrNull(driver.fault)}});
  }
  return drivers;
}

Json platformFacts() {
  Json platforms = Json::array();
  for (const PlatformState& platform : listPlatforms()) {
    Json devices = Json::array();
    for (const DeviceState& device : platform.devices) {
      devices.push_back({{"name", device.info.name},
                         {"version", device.info.version},
                         {"driver", textOrNull(device.driver)},
                         {"gpu", device.info.gpu},
                         {"compute_units", device.info.computeUnits},
                         {"memory_bytes", device.info.memoryBytes},
                         {"chosen", device.info.chosen},
                         {"caveat", textOrNull(device.info.caveat)},
                         {"fault", textOrNull(device.fault)}});
    }
    platforms.push_back({{"name", platform.name},
                         {"version", platform.version},
                         {"fault", textOrNull(platform.fault)},
                         {"devices", devices}});
  }
  return platforms;
}

TriangleMesh cube() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}},
          {{0, 2, 1},
           {1, 2, 3},
           {4, 5, 6},
           {5, 7, 6},
           {0, 1, 4},
           {1, 5, 4},
           {2, 6, 3},
           {3, 6, 7},
           {0, 4, 2},
           {2, 4, 6},
           {1, 3, 5},
           {3, 7, 5}}};
}

// Returns whether each voxel has the label of its nearest seed, ties to the lower id.  Both growths
// below give that in a box.
bool isNearest(const Labels& labels, const std::vector<Seed>& seeds, Metric metric) {
  bool right = true;
  labels.blocks->forEachInside([&](std::size_t voxel) {
    const auto order = [&](const Seed& seed) {
      return std::pair(metricOrder(metric, seed.voxel, labels.blocks->voxelAt(voxel)),
                       seed.fragment);
    };
    const auto nearest =
        std::min_element(seeds.begin(), seeds.end(),
                         [&](const Seed& a, const Seed& b) { return order(a) < order(b); });
    right = right && labels.fragment[voxel] == nearest->fragment;
  });
  return right;
}

bool growsRight(const Solid& solid, Device& device) {
  const openvdb::Coord low = solid.box.min, high = solid.box.max;
  const std::vector<Seed> seeds{{low, 2}, {{high.x(), low.y(), high.z()}, 1}, {high, 3}};
  const std::vector<std::vector<Seed>> sets{seeds};
  const auto grown = [&](Growth growth) {
    return grow(solid.blocks, sets, device,
                {.growth = growth, .regrowIsolated = false, .outerSteps = 0})
        .front();
  };
  return findComponents(*solid.blocks, device).count() == 1 &&
         isNearest(grown(Growth::flood), seeds, Metric::manhattan) &&
         isNearest(grown(Growth::nearest), seeds, Metric::euclidean);
}

Json untested() { return {{"device", nullptr}, {"right", false}, {"fault", nullptr}}; }

Json selfTest(const std::string& choice) {
  Json test = untested();
  try {
    Device device(choice);
    const ForeignExit explained;
    test["device"] = device.info().platform + " / " + device.info().name;
    const Solid solid = voxelize(cube(), {.resolution = 20});
    for (const char* const run : {"first_seconds", "again_seconds"}) {  // the first builds kernels
      const Clock::time_point begin = Clock::now();
      const bool right = growsRight(solid, device);
      test[run] = std::chrono::duration<double>(Clock::now() - begin).count();
      test["right"] = right;
      if (!right)
        test["fault"] =
            device.info().name + ": a growth gives wrong labels; try another device (--device)";
    }
  } catch (const Error& e) {
    test["fault"] = sentenceOf(e);
  } catch (const std::exception& e) {
    test["fault"] = e.what();
  }
  return test;
}

void put(int file, const Json& section) {
  const std::string line = section.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  if (::write(file, line.data(), line.size()) < 0) ::_exit(1);
}

// ---- In the program

int memoryFile(const char* name) {
  const int file = ::memfd_create(name, MFD_CLOEXEC);
  if (file < 0) throw Error(ErrorCode::internal, "no file in memory: " + reasonOf(errno));
  return file;
}

std::string wholeOf(int file) {
  std::string text, part(4096, '\0');
  for (ssize_t got = 1; got > 0;) {
    got = ::pread(file, part.data(), part.size(), static_cast<off_t>(text.size()));
    if (got > 0) text.append(part, 0, static_cast<std::size_t>(got));
  }
  return text;
}

// Returns the output of drivers on one line, at most its last 300 characters.
std::string oneLine(std::string text) {
  constexpr std::size_t kLongest = 300;
  for (char& c : text) {
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  return text.size() <= kLongest ? text : "... " + text.substr(text.size() - kLongest);
}

std::string endedBy(int status) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return "did not end within " + std::to_string(kMostSeconds) + " s";
  if (WIFSIGNALED(status))
    return "ended with signal " + std::to_string(WTERMSIG(status)) + " (" +
           ::strsignal(WTERMSIG(status)) + ")";
  return "ended with status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

DeviceExamination::DeviceExamination(const std::string& device)
    : answer_(memoryFile("answer")), printed_(memoryFile("printed")) {
  child_ = ::fork();
  if (child_ < 0) throw Error(ErrorCode::internal, "no process can be started: " + reasonOf(errno));
  if (child_ > 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);  // this process has no thread that waits for signals
  ::alarm(kMostSeconds);
  ::dup2(printed_, STDOUT_FILENO);
  ::dup2(printed_, STDERR_FILENO);
  try {                                             // the child must not return to the caller
    const bool needsDriver = mayUseOpenCl(device);  // else a driver that fails changes nothing
    if (!needsDriver) put(answer_, {{"self_test", selfTest(device)}});
    put(answer_, {{"drivers", driverFacts()}});
    put(answer_, {{"platforms", platformFacts()}});
    if (needsDriver) put(answer_, {{"self_test", selfTest(device)}});
  } catch (const std::exception& e) {
    std::fputs(e.what(), stderr);
    ::_exit(1);
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(0);  // skips exit handlers: drivers may crash in them
}

DeviceExamination::~DeviceExamination() {
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  ::close(answer_);
  ::close(printed_);
}

int DeviceExamination::wait() {
  constexpr std::chrono::milliseconds kPollInterval{10};
  for (int status = 0;;) {
    stopIfInterrupted();
    const pid_t ended = ::waitpid(child_, &status, WNOHANG);
    if (ended != 0) {
      child_ = -1;
      return ended > 0 ? status : 0;  // -1: the caller ignores SIGCHLD, so no status is available
    }
    std::this_thread::sleep_for(kPollInterval);
  }
}

void DeviceExamination::addTo(Diagnosis& diagnosis) {
  const int status = wait();
  const std::string printed = oneLine(wholeOf(printed_));
  Json& sections = diagnosis.sections;
  sections.update({{"driver_folder", driverFolder().string()},
                   {"drivers", Json::array()},
                   {"platforms", Json::array()},
                   {"self_test", untested()}});
  std::istringstream lines(wholeOf(answer_));
  for (std::string line; std::getline(lines, line);) {
    const Json section = Json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (section.is_object()) sections.update(section);
  }
  std::vector<std::string>& problems = diagnosis.problems;
  const Json& test = sections["self_test"];
  diagnosis.deviceWorks = test.value("right", false);
  if (!test["fault"].is_null()) problems.push_back(test["fault"].get<std::string>());
  for (const Json& driver : sections.value("drivers", Json::array())) {
    if (driver["fault"].is_null() || test["device"].is_null())
      continue;  // no device: the fault above names the driver
    problems.push_back("the driver " + driver["file"].get<std::string>() +
                       " cannot be used: " + driver["fault"].get<std::string>());
  }
  if (status != 0) {
    problems.push_back("the process that examines the OpenCL devices " + endedBy(status) +
                       (printed.empty() ? "" : " after it printed: " + printed) +
                       "; a driver fails (OCL_ICD_VENDORS=pocl.icd excludes all but PoCL)");
  }
  sections["drivers_print"] = textOrNull(printed);
}

}  // namespace sherd::cli
