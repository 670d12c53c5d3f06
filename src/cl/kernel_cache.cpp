// The folder where PoCL, the OpenCL driver for CPUs, stores compiled kernels, and its linker.
#include "cl/kernel_cache.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "base/files/atomic_file.h"
#include "base/files/unfinished.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// PoCL 3.1 writes its preprocessor's output in each run (1 MB), and each kernel once per work-group
// size, as bitcode and as a library (1 MB in all).  It ends the process if a write fails, so the
// space is checked before.
constexpr std::size_t kLargestFile = std::size_t{2} << 20;
constexpr std::size_t kFreeBytes = std::size_t{8} << 20;
constexpr std::size_t kLongestName = 700;  // PoCL reserves 1024 bytes for paths below it

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

// Creates a folder and its parents with mode 0700, as PoCL does.
//   return  the first errno; 0 if the folder exists now
int createFolders(const fs::path& folder) {
  int failed = 0;
  fs::path at;
  for (const fs::path& part : folder) {
    at /= part;
    if (::mkdir(at.c_str(), 0700) != 0 && errno != EEXIST && failed == 0) failed = errno;
  }
  std::error_code error;
  if (fs::is_directory(folder, error)) return 0;
  return failed != 0 ? failed : ENOTDIR;
}

// Returns why PoCL cannot create files in a folder, or load libraries from it; empty if it can.
std::string faultOf(const fs::path& folder) {
  std::string name = (folder / "sherd-XXXXXX").string();
  if (name.size() > kLongestName) return "its name is too long";
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) return reasonOf(errno);
  ::unlink(name.c_str());
  const auto close = [file](const void*) { ::close(file); };
  const std::unique_ptr<const std::string, decltype(close)> closed(&name, close);

  rlimit size{};
  if (::getrlimit(RLIMIT_FSIZE, &size) == 0 && size.rlim_cur < kLargestFile) {
    return "a file may have " + std::to_string(size.rlim_cur >> 10) + " KiB (ulimit -f), " +
           std::to_string(kLargestFile >> 10) + " are needed";
  }
  struct statvfs system {};
  if (::fstatvfs(file, &system) == 0 && system.f_bavail * system.f_frsize < kFreeBytes) {
    return std::to_string(system.f_bavail * system.f_frsize >> 10) + " KiB are free, " +
           std::to_string(kFreeBytes >> 10) + " are needed";
  }
  // A quota takes effect on allocation only.  Not every file system supports fallocate.
  if (::fallocate(file, 0, 0, kLargestFile) != 0 &&
      (errno == ENOSPC || errno == EDQUOT || errno == EFBIG || errno == EIO))
    return reasonOf(errno);
  if (::ftruncate(file, 1) != 0) return reasonOf(errno);
  void* const mapped = ::mmap(nullptr, 1, PROT_READ | PROT_EXEC, MAP_PRIVATE, file, 0);
  if (mapped == MAP_FAILED) return "libraries cannot be loaded from it (noexec)";
  ::munmap(mapped, 1);
  return {};
}

// A folder that PoCL may use, and the variable it comes from.
struct Candidate {
  fs::path folder;
  const char* source;
};

// Returns the folders from the user's variables; PoCL takes the first.
std::vector<Candidate> usersFolders() {
  if (const std::string cache = variable("POCL_CACHE_DIR"); !cache.empty())
    return {{cache, "POCL_CACHE_DIR"}};
  std::vector<Candidate> folders;
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty())
    folders.push_back({fs::path(cache) / "pocl" / "kcache", "XDG_CACHE_HOME"});
  if (const std::string home = variable("HOME"); !home.empty())
    folders.push_back({fs::path(home) / ".cache" / "pocl" / "kcache", "HOME"});
  return folders;
}

KernelCache usersCache(const Candidate& candidate) {
  const int failed = createFolders(candidate.folder);
  return {candidate.folder, candidate.source,
          failed != 0 ? reasonOf(failed) : faultOf(candidate.folder)};
}

// A folder that is removed at the end of the program, but not by a forked child.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& folder)
      : folder_(folder), owner_(::getpid()), unfinished_(folder, Unfinished::Kind::folder) {}
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (::getpid() == owner_) fs::remove_all(folder_, ignored);
  }

 private:
  fs::path folder_;
  pid_t owner_;
  Unfinished unfinished_;
};

// Returns why another user may control a folder; empty if none does.
std::string ownershipFault(const fs::path& folder) {
  struct stat found {};
  if (::lstat(folder.c_str(), &found) != 0) return reasonOf(errno);
  if (!S_ISDIR(found.st_mode)) return "it is not a folder";
  if (found.st_uid != ::geteuid()) return "it belongs to another user";
  if ((found.st_mode & 077) != 0) return "other users may write or read it";
  return {};
}

std::vector<Candidate> temporaryFolders() {
  std::vector<Candidate> folders{{"/tmp", "temporary folder"},
                                 {"/var/tmp", "temporary folder"},
                                 {"/dev/shm", "temporary folder"}};
  if (const std::string named = variable("TMPDIR"); !named.empty())
    folders.insert(folders.begin(), {named, "TMPDIR"});
  return folders;
}

// Returns this user's folder below one for temporary files, the same in each run.  If another user
// owns that name, uses a folder with a random name, removed at the end of this process.
KernelCache privateCache(const Candidate& parent) {
  const fs::path folder = parent.folder / ("sherd-cache-" + std::to_string(::geteuid()));
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    return {folder, parent.source, reasonOf(errno)};
  if (ownershipFault(folder).empty()) {
    const std::string fault = faultOf(folder);
    if (!fault.empty()) ::rmdir(folder.c_str());  // if it is empty
    return {folder, parent.source, fault};
  }
  std::string random = folder.string() + "-XXXXXX";
  const Uncut whole;
  if (::mkdtemp(random.data()) == nullptr) return {folder, parent.source, ownershipFault(folder)};
  static std::vector<std::unique_ptr<TemporaryFolder>> removed;
  removed.push_back(std::make_unique<TemporaryFolder>(random));
  return {random, parent.source, faultOf(random)};
}

// Returns whether a folder of a colon-separated list contains ld.
bool hasLinker(const std::string& folders) {
  std::istringstream list(folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    if (!folder.empty() && ::access((fs::path(folder) / "ld").c_str(), X_OK) == 0) return true;
  }
  return false;
}

constexpr const char* kSystemFolders = "/usr/bin:/bin";

// Appends the system's folders to PATH if it has no linker, as in services and under `env -i`.
void provideLinker() {
  const std::string path = variable("PATH");
  if (hasLinker(path) || !hasLinker(kSystemFolders)) return;
  ::setenv("PATH", (path.empty() ? kSystemFolders : path + ":" + kSystemFolders).c_str(), 1);
}

}  // namespace

std::string linkerFault() {
  if (hasLinker(variable("PATH"))) return {};
  return "PoCL links kernels with ld, which no folder of PATH has; install binutils, or name its "
         "folder in PATH";
}

KernelCache poclCache() {
  const std::vector<Candidate> folders = usersFolders();
  return usersCache(folders.empty() ? Candidate{"/tmp/pocl/kcache", "no HOME"} : folders.front());
}

std::string cacheFaultMessage(const KernelCache& cache) {
  return "PoCL cannot keep compiled kernels in " + cache.folder.string() + " (" + cache.source +
         "): " + cache.fault + "; set POCL_CACHE_DIR to a folder that can be written";
}

std::vector<KernelCache> provideKernelCache() {
  provideLinker();
  // PoCL takes an empty value as a folder, and aborts.
  if (variable("POCL_CACHE_DIR").empty()) ::unsetenv("POCL_CACHE_DIR");
  std::vector<KernelCache> tried;
  const auto found = [&] { return !tried.empty() && tried.back().fault.empty(); };
  for (const Candidate& candidate : usersFolders()) {
    if (!found()) tried.push_back(usersCache(candidate));
  }
  const bool isNamed = !variable("POCL_CACHE_DIR").empty();
  if (isNamed || (found() && tried.size() == 1)) return tried;  // PoCL's own choice
  for (const Candidate& candidate : temporaryFolders()) {
    if (!found()) tried.push_back(privateCache(candidate));
  }
  if (found()) ::setenv("POCL_CACHE_DIR", tried.back().folder.c_str(), 1);
  return tried;
}

}  // namespace sherd
