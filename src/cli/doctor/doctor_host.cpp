// `sherd doctor`: versions, memory, folders and sherd-assimp.
#include <gnu/libc-version.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sys/utsname.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <thread>

#include "base/memory.h"
#include "base/memory_bounds.h"
#include "base/text/library_versions.h"
#include "base/version.h"
#include "cli/doctor/doctor.h"
#include "cli/evaluate/cgal_checks.h"
#include "cli/terminal/interrupts.h"

extern char** environ;

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLittleMemory =
    500'000'000;  // a fracture at 128 voxels takes 200 to 400 MB

Json bytesOrNull(double bytes) {
  return std::isfinite(bytes) ? Json(static_cast<std::uint64_t>(bytes)) : Json();
}

Json freeBytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? Json() : Json(space.available);
}

// Returns PRETTY_NAME of /etc/os-release.
std::string systemName() {
  std::ifstream in("/etc/os-release");
  constexpr std::string_view kKey = "PRETTY_NAME=";
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(kKey)) continue;
    std::string name = line.substr(kKey.size());
    std::erase(name, '"');
    return name;
  }
  return "unknown";
}

// "x86-64-v4, x86-64-v3, x86-64-v2, by clang 14.0.6".
std::string builtinKernels(const DeviceSupport& support) {
  std::string text;
  for (const std::string& instructions : support.instructions)
    text += (text.empty() ? "" : ", ") + instructions;
  return text.empty() ? "not in this build" : text + ", by " + support.compiler;
}

Json versionFacts() {
#ifdef __clang__
  const std::string compiler = "Clang " __clang_version__;
#else
  const std::string compiler = "GCC " __VERSION__;
#endif
  const DeviceSupport support = deviceSupport();
  Json versions = {{"sherd", SHERD_VERSION}};
  for (const auto& [name, version] : libraryVersions()) versions[name] = version;
  versions["license"] = programLicense();
  versions["cgal_checks"] = hasCgalChecks() ? "in this build" : "not in this build";
  versions["built_in_kernels"] = builtinKernels(support);
  versions["opencl"] = support.openCl ? "in this build" : "not in this build";
  versions["compiler"] = compiler;
  versions["glibc"] = ::gnu_get_libc_version();
  versions["system"] = systemName();
  utsname kernel{};
  if (::uname(&kernel) == 0)
    versions["kernel"] = std::string(kernel.sysname) + " " + kernel.release + " " + kernel.machine;
  return versions;
}

Json machineFacts() {
  return {{"cores", std::thread::hardware_concurrency()},
          {"threads", tbb::info::default_concurrency()},
          {"user_id", ::geteuid()}};
}

void addMemory(Diagnosis& diagnosis) {
  const MemoryBounds bounds = memoryBounds();
  const std::uint64_t free = freeMemory();
  const double pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
                       static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  diagnosis.sections["memory"] = {{"machine_bytes", bytesOrNull(pages)},
                                  {"free_bytes", bytesOrNull(bounds.machine)},
                                  {"left_by_cgroups_bytes", bytesOrNull(bounds.groups)},
                                  {"left_by_ulimit_bytes", bytesOrNull(bounds.addresses)},
                                  {"max_memory_default_bytes", free}};
  if (free < kLittleMemory)
    diagnosis.problems.push_back(std::to_string(free / 1'000'000) +
                                 " MB of memory are left for this process, which is little");
}

void addKernelCache(Diagnosis& diagnosis, const std::vector<KernelCache>& caches) {
  const KernelCache& used = caches.back();
  const bool usable = used.fault.empty();
  Json passedOver = Json::array();
  for (const KernelCache& cache : caches) {
    if (!cache.fault.empty())
      passedOver.push_back(cache.folder.string() + " (" + cache.source + "): " + cache.fault);
  }
  diagnosis.sections["kernel_cache"] = {{"folder", usable ? Json(used.folder.string()) : Json()},
                                        {"chosen_by", usable ? Json(used.source) : Json()},
                                        {"free_bytes", usable ? freeBytes(used.folder) : Json()},
                                        {"passed_over", passedOver}};
  for (const auto& text : passedOver) {
    diagnosis.problems.push_back("compiled kernels cannot be kept in " + text.get<std::string>());
  }
}

void addTemporaryFolder(Diagnosis& diagnosis) {
  const char* const named = std::getenv("TMPDIR");
  const fs::path folder = named != nullptr && *named != '\0' ? named : "/tmp";
  std::error_code error;
  const bool writable =
      fs::is_directory(folder, error) && ::access(folder.c_str(), W_OK | X_OK) == 0;
  diagnosis.sections["temporary_folder"] = {
      {"folder", folder.string()}, {"writable", writable}, {"free_bytes", freeBytes(folder)}};
  if (!writable)
    diagnosis.problems.push_back("the folder for temporary files, " + folder.string() +
                                 ", cannot be written (TMPDIR names another)");
}

void addAssimp(Diagnosis& diagnosis) {
  const AssimpProgram program = findAssimp();
  Json tried = Json::array();
  for (const fs::path& path : program.tried) tried.push_back(path.lexically_normal().string());
  const std::string why = assimpFault(&untilInterrupted());
  const Json fault = why.empty() ? Json() : Json(why);
  diagnosis.sections["assimp"] = {
      {"program", program.found ? Json(program.found->lexically_normal().string()) : Json()},
      {"tried", tried},
      {"reads", fault.is_null()},
      {"fault", fault}};
  if (!fault.is_null())
    diagnosis.problems.push_back("FBX and DAE files cannot be read: " + fault.get<std::string>());
}

}  // namespace

Json environmentFacts() {
  constexpr std::array<std::string_view, 11> kNames{"HOME",
                                                    "XDG_CACHE_HOME",
                                                    "TMPDIR",
                                                    "OCL_ICD_VENDORS",
                                                    "OCL_ICD_FILENAMES",
                                                    "OPENCL_VENDOR_PATH",
                                                    "SHERD_ASSIMP",
                                                    "RUSTICL_ENABLE",
                                                    "LANG",
                                                    "LC_ALL",
                                                    "LC_NUMERIC"};
  constexpr std::string_view kPocl = "POCL_";
  Json found = Json::object();
  for (char** at = environ; at != nullptr && *at != nullptr; ++at) {
    const std::string_view variable = *at;
    const std::string_view name = variable.substr(0, variable.find('='));
    if (name.size() == variable.size()) continue;
    const bool matters =
        name.starts_with(kPocl) || std::find(kNames.begin(), kNames.end(), name) != kNames.end();
    if (matters) found[std::string(name)] = variable.substr(name.size() + 1);
  }
  return found;
}

void addHostFacts(Diagnosis& diagnosis, const std::vector<KernelCache>& caches) {
  diagnosis.sections["versions"] = versionFacts();
  diagnosis.sections["machine"] = machineFacts();
  addMemory(diagnosis);
  addKernelCache(diagnosis, caches);
  addTemporaryFolder(diagnosis);
  addAssimp(diagnosis);
}

}  // namespace sherd::cli
