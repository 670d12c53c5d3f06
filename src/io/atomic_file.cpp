// Files that appear whole or not at all: a hidden temporary in the same folder, then a rename.
#include "io/atomic_file.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

namespace sherd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void outputError(const fs::path& file, const std::string& what) {
  throw Error(ErrorCode::output, file.string() + ": " + what);
}

// Not made from the target's name, which may already be as long as a name may be.
fs::path temporaryBeside(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  return file.parent_path() / (".sherd-" + std::to_string(::getpid()) + "-" +
                               std::to_string(counter.fetch_add(1)) + ".tmp");
}

constexpr std::size_t kLeastDirect = 16 * kDirectBlock;  // fewer bytes are not worth it

// Let writes go past the cache, or no longer.
void setDirect(int descriptor, bool direct) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0) return;
  // Not all file systems can; then it stays as it is.
  (void)::fcntl(descriptor, F_SETFL, direct ? flags | O_DIRECT : flags & ~O_DIRECT);
}

std::string amount(std::uintmax_t bytes) {
  if (bytes >= 1'000'000) return std::to_string(bytes / 1'000'000) + " MB";
  if (bytes >= 1'000) return std::to_string(bytes / 1'000) + " kB";
  return std::to_string(bytes) + " bytes";
}

}  // namespace

std::string reasonOf(int number) {
  std::string reason = std::generic_category().message(number);
  if (!reason.empty()) {
    reason[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(reason[0])));
  }
  return reason;
}

AtomicFile::AtomicFile(fs::path file, Caching caching)
    : file_(std::move(file)), temporary_(temporaryBeside(file_)), caching_(caching) {
  struct stat target {};
  if (::lstat(file_.c_str(), &target) == 0) {
    if (S_ISDIR(target.st_mode)) outputError(file_, "is a folder; a file name is needed");
    if (!S_ISREG(target.st_mode)) {
      outputError(file_, "is not a regular file; name a regular file or one that does not exist");
    }
  } else if (errno != ENOENT) {
    outputError(file_, "cannot be written: " + reasonOf(errno));
  }
  const Uncut whole;
  unfinished_ = Unfinished(temporary_, Unfinished::Kind::file);  // before, as memory may be out
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) outputError(file_, "cannot be written: " + reasonOf(errno));
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  if (!canUndo_) return;
  if (before_.empty()) {
    ::unlink(file_.c_str());
  } else {
    ::rename(before_.c_str(), file_.c_str());
  }
}

void AtomicFile::write(std::string_view bytes) {
  const bool isAligned = reinterpret_cast<std::uintptr_t>(bytes.data()) % kDirectBlock == 0 &&
                         written_ % kDirectBlock == 0;
  if (caching_ == Caching::none && isAligned && bytes.size() >= kLeastDirect) {
    const std::size_t whole = bytes.size() / kDirectBlock * kDirectBlock;
    setDirect(descriptor_, true);
    put(bytes.substr(0, whole), true);
    setDirect(descriptor_, false);
    bytes.remove_prefix(whole);
  }
  put(bytes, false);
}

void AtomicFile::put(std::string_view bytes, bool direct) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EINVAL && std::exchange(direct, false)) {  // blocks of another size
      setDirect(descriptor_, false);
      continue;
    }
    if (n <= 0) fail(n < 0 ? errno : EIO);
    written_ += static_cast<std::uintmax_t>(n);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void AtomicFile::close() {
  if (descriptor_ < 0) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);  // NFS tells of a full disk here
}

void AtomicFile::commit() {
  close();
  const Uncut whole;
  if (::rename(temporary_.c_str(), file_.c_str()) != 0) fail(errno);
  temporary_.clear();
  unfinished_.end();
}

void AtomicFile::putInPlace() {
  fs::path before = temporaryBeside(file_);
  Unfinished unfinished(before, Unfinished::Kind::file);
  close();
  const Uncut whole;
  const int reason = ::link(file_.c_str(), before.c_str()) == 0 ? 0 : errno;
  if (::rename(temporary_.c_str(), file_.c_str()) != 0) {
    const int number = errno;
    ::unlink(before.c_str());
    fail(number);
  }
  temporary_.clear();
  canUndo_ = reason == 0 || reason == ENOENT;
  if (reason == 0) before_ = std::move(before);
  unfinished_ = std::move(unfinished);
}

void AtomicFile::keep() {
  canUndo_ = false;
  if (!before_.empty()) ::unlink(before_.c_str());
  unfinished_.end();
}

void AtomicFile::fail(int number) const {
  outputError(file_, reasonOf(number) + " after " + amount(written_));
}

void writeWhole(const fs::path& file, std::string_view bytes) {
  AtomicFile out(file);
  out.write(bytes);
  out.commit();
}

}  // namespace sherd
