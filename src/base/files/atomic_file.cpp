// Files that appear whole or not at all: a hidden temporary in the same folder, then a rename.
#include "base/files/atomic_file.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

namespace sherd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void outputError(const fs::path& file, const std::string& what) {
  throw Error(ErrorCode::output, file.string() + ": " + what);
}

constexpr std::string_view kTemporaryBegin = ".sherd-", kTemporaryEnd = ".tmp";

// Independent of the target's name, which may already have the maximal length.  The file may exist:
// in a container every run has the same process id.
fs::path temporaryBeside(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  return file.parent_path() / (std::string(kTemporaryBegin) + std::to_string(::getpid()) + "-" +
                               std::to_string(counter.fetch_add(1)) + std::string(kTemporaryEnd));
}

// Whether an errno value means that the file system does not support an operation.
bool isUnsupported(int number) {
  return number == EINVAL || number == ENOSYS || number == EOPNOTSUPP;
}

constexpr std::size_t kLeastDirect = 16 * kDirectBlock;  // fewer bytes are not worth it

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

AtomicFile::AtomicFile(fs::path file, Caching caching) : file_(std::move(file)), caching_(caching) {
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
  do {
    temporary_ = temporaryBeside(file_);
    unfinished_ =
        Unfinished(temporary_, Unfinished::Kind::file);  // first, as it may throw bad_alloc
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) outputError(file_, "cannot be written: " + reasonOf(errno));
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  (void)undo();
}

void AtomicFile::write(std::span<const std::string_view> pieces) {
  const auto isAligned = [](std::string_view piece) {
    return reinterpret_cast<std::uintptr_t>(piece.data()) % kDirectBlock == 0;
  };
  const auto isWhole = [](std::string_view piece) { return piece.size() % kDirectBlock == 0; };
  std::size_t bytes = 0;
  for (const std::string_view piece : pieces) bytes += piece.size();
  if (caching_ != Caching::none || bytes < kLeastDirect || written_ % kDirectBlock != 0 ||
      !std::all_of(pieces.begin(), pieces.end(), isAligned) ||
      !std::all_of(pieces.begin(), pieces.end() - 1, isWhole)) {
    return put(pieces, false);
  }
  std::vector<std::string_view> whole(pieces.begin(), pieces.end());
  const std::string_view end =
      whole.back().substr(whole.back().size() / kDirectBlock * kDirectBlock);
  whole.back().remove_suffix(end.size());
  setDirect(descriptor_, true);
  put(whole, true);
  setDirect(descriptor_, false);
  put(std::span(&end, 1), false);
}

void AtomicFile::put(std::span<const std::string_view> pieces, bool direct) {
  constexpr std::size_t kMost = 1024;  // pieces in one call, a limit of the system
  std::array<iovec, kMost> some;
  std::size_t done = 0;  // bytes of the first piece that are written
  const auto skip = [&](std::size_t bytes) {
    for (done += bytes; !pieces.empty() && done >= pieces.front().size();) {
      done -= pieces.front().size();
      pieces = pieces.subspan(1);
    }
  };
  for (skip(0); !pieces.empty();) {
    const std::size_t count = std::min(pieces.size(), kMost);
    for (std::size_t i = 0; i < count; ++i) {
      some[i] = {const_cast<char*>(pieces[i].data()), pieces[i].size()};
    }
    some[0] = {const_cast<char*>(pieces[0].data()) + done, pieces[0].size() - done};
    const ssize_t n = count == 1 ? ::write(descriptor_, some[0].iov_base, some[0].iov_len)
                                 : ::writev(descriptor_, some.data(), static_cast<int>(count));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EINVAL &&
        std::exchange(direct, false)) {  // the file system needs larger blocks
      setDirect(descriptor_, false);
      continue;
    }
    if (n <= 0) fail(n < 0 ? errno : EIO);
    written_ += static_cast<std::uintmax_t>(n);
    skip(static_cast<std::size_t>(n));
  }
}

void AtomicFile::close() {
  if (descriptor_ < 0) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);  // NFS reports a full disk here
}

void AtomicFile::commit() {
  close();
  const Uncut whole;
  if (::rename(temporary_.c_str(), file_.c_str()) != 0) fail(errno);
  temporary_.clear();
  unfinished_.end();
}

void AtomicFile::putInPlace() {
  close();
  const Uncut whole;
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, file_.c_str(), RENAME_EXCHANGE) == 0) {
    before_ = std::exchange(temporary_, {});
  } else if (isUnsupported(errno)) {
    replaceByTwoRenames();
  } else if (errno != ENOENT || ::rename(temporary_.c_str(), file_.c_str()) != 0) {
    fail(errno);
  } else {  // there was no file to replace
    temporary_.clear();
    unfinished_.end();
  }
  isInPlace_ = true;
}

// For file systems that cannot swap names.  The replaced file gets a second name by a hard link, so
// that the name always exists; without hard links it is renamed.
void AtomicFile::replaceByTwoRenames() {
  std::error_code none;
  if (!fs::exists(fs::symlink_status(file_, none))) {
    if (::rename(temporary_.c_str(), file_.c_str()) != 0) fail(errno);
    temporary_.clear();
    return unfinished_.end();
  }
  fs::path before = temporaryBeside(file_);
  while (fs::exists(fs::symlink_status(before, none))) before = temporaryBeside(file_);
  Unfinished unfinished(before, Unfinished::Kind::file);
  const bool isLinked = ::link(file_.c_str(), before.c_str()) == 0;
  if (!isLinked && ::rename(file_.c_str(), before.c_str()) != 0) fail(errno);
  if (::rename(temporary_.c_str(), file_.c_str()) == 0) {
    before_ = std::move(before);
    temporary_.clear();
    unfinished_ = std::move(unfinished);
    return;
  }
  const int number = errno;
  if (isLinked) {
    ::unlink(before.c_str());
  } else if (::rename(before.c_str(), file_.c_str()) != 0) {
    unfinished.end();
    outputError(file_, reasonOf(number) + "; what was there before is " + before.string());
  }
  fail(number);
}

bool AtomicFile::undo() noexcept {
  if (!std::exchange(isInPlace_, false)) return true;
  const Uncut whole;
  if ((before_.empty() ? ::unlink(file_.c_str()) : ::rename(before_.c_str(), file_.c_str())) == 0) {
    before_.clear();
    return true;
  }
  unfinished_.end();  // keeps the only copy of the replaced file
  return false;
}

std::string AtomicFile::takeBack() {
  if (undo()) return {};
  return file_.string() + " is replaced, " +
         (before_.empty() ? "though nothing was there before"
                          : "and what was there before is " + before_.string());
}

void AtomicFile::keep() {
  isInPlace_ = false;
  if (!before_.empty()) ::unlink(before_.c_str());
  unfinished_.end();
}

void AtomicFile::fail(int number) const {
  outputError(file_, reasonOf(number) + " after " + amount(written_));
}

bool isTemporaryName(std::string_view name) {
  if (!name.starts_with(kTemporaryBegin) || !name.ends_with(kTemporaryEnd)) return false;
  name.remove_prefix(kTemporaryBegin.size());
  name.remove_suffix(std::min(name.size(), kTemporaryEnd.size()));
  const auto isNumber = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
  };
  const std::size_t hyphen = std::min(name.find('-'), name.size() - 1);
  return isNumber(name.substr(0, hyphen)) && isNumber(name.substr(hyphen + 1));
}

void writeWhole(const fs::path& file, std::string_view bytes) {
  AtomicFile out(file);
  out.write(bytes);
  out.commit();
}

}  // namespace sherd
