// A file that grows at its end, past the system's cache.
#include "base/files/appended_file.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/files/atomic_file.h"

namespace sherd {
namespace {

// Fits the processor's cache; larger ones are not written faster.
constexpr std::size_t kBuffer = std::size_t{1} << 20;
static_assert(kBuffer % kDirectBlock == 0);

}  // namespace

AppendedFile::AppendedFile(std::filesystem::path file)
    : path_(std::move(file)), buffer_(directMemory(kBuffer)) {
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(errno);
}

AppendedFile::~AppendedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void AppendedFile::fail(int number) const {
  throw Error(ErrorCode::output, path_.string() + ": cannot be written: " + reasonOf(number));
}

std::string AppendedFile::read(std::size_t bytes, std::uint64_t at) const {
  std::string out(bytes, '\0');
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t n =
        ::pread(descriptor_, out.data() + done, bytes - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno);
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  out.resize(done);
  return out;
}

void AppendedFile::seek(std::uint64_t at) {
  if (::lseek(descriptor_, static_cast<off_t>(at), SEEK_SET) < 0) fail(errno);
}

void AppendedFile::cutTo(std::uint64_t bytes) {
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail(errno);
  begin_ = bytes / kDirectBlock * kDirectBlock;
  const std::string last = read(static_cast<std::size_t>(bytes - begin_), begin_);
  std::memcpy(buffer_.get(), last.data(), last.size());
  used_ = last.size();
  seek(begin_);
  setDirect(descriptor_, isDirect_ = true);
}

void AppendedFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t some = std::min(bytes.size(), kBuffer - used_);
    std::memcpy(buffer_.get() + used_, bytes.data(), some);
    bytes.remove_prefix(some);
    used_ += some;
    if (used_ < kBuffer) continue;
    put({buffer_.get(), kBuffer});
    begin_ += kBuffer;
    used_ = 0;
  }
}

void AppendedFile::flush() {
  const std::size_t whole = used_ / kDirectBlock * kDirectBlock, rest = used_ - whole;
  const std::size_t padded = rest > 0 ? whole + kDirectBlock : whole;
  std::memset(buffer_.get() + used_, 0, padded - used_);
  put({buffer_.get(), padded});
  if (rest == 0) {
    begin_ += whole;
    used_ = 0;
    return;
  }
  std::memmove(buffer_.get(), buffer_.get() + whole, rest);
  begin_ += whole;
  used_ = rest;
  seek(begin_);
}

void AppendedFile::close() {
  flush();
  if (::ftruncate(descriptor_, static_cast<off_t>(begin_ + used_)) != 0) fail(errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
}

void AppendedFile::put(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EINVAL &&
        std::exchange(isDirect_, false)) {  // the file system needs larger blocks
      setDirect(descriptor_, false);
      continue;
    }
    if (n <= 0) fail(n < 0 ? errno : EIO);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

}  // namespace sherd
