// The archive of an object's files.
#include "dataset/store/archive.h"

#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "base/files/atomic_file.h"
#include "base/little_endian.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Returns the path of the unfinished archive.  It may be finished although the journal is not.
fs::path unfinished(const fs::path& path, const fs::path& finished, std::uint64_t kept) {
  fs::path file = path.string() + Archive::kUnfinished;
  if (kept > 0 && !fs::exists(file)) ::rename(finished.c_str(), file.c_str());
  return file;
}

}  // namespace

Archive::Archive(const fs::path& path, std::uint64_t kept)
    : final_(path.string() + kSuffix), file_(unfinished(path, final_, kept)) {
  readKept(kept);
  constexpr std::uint64_t kBlock = std::uint64_t{1} << 20;
  while (bytes_ < kept) {
    addToSum(file_.read(static_cast<std::size_t>(std::min(kBlock, kept - bytes_)), bytes_));
  }
  file_.cutTo(kept);
}

void Archive::addToSum(std::string_view bytes) {
  sum_.add(bytes);
  bytes_ += bytes.size();
}

void Archive::append(std::string_view bytes) {
  addToSum(bytes);
  file_.append(bytes);
}

void Archive::add(const PackedFile& file, const HeldBytes& bytes) {
  zip_.begin(file, bytes.size());
  bytes.forEach([this](std::string_view piece) { append(piece); });
}

Archive::Finished Archive::finish() {
  zip_.finish();
  file_.close();
  if (::rename(file_.path().c_str(), final_.c_str()) != 0) {
    throw Error(ErrorCode::output,
                final_.string() + ": cannot be put in place: " + reasonOf(errno));
  }
  return {bytes_, sum_.text()};
}

// Restores the directory from the local headers of kept entries.
void Archive::readKept(std::uint64_t kept) {
  constexpr std::size_t kLocal = 30;
  const auto read = [&](std::size_t bytes, std::uint64_t at) {
    std::string all = file_.read(bytes, at);
    if (all.size() < bytes) damaged();
    return all;
  };
  while (zip_.offset() < kept) {
    const std::string head = read(kLocal, zip_.offset());
    const std::size_t name = loadLittle<std::uint16_t>(head.data() + 26);
    const std::size_t extra = loadLittle<std::uint16_t>(head.data() + 28);
    const std::string rest = read(name + extra, zip_.offset() + kLocal);
    PackedFile file;
    file.name = rest.substr(0, name);
    file.deflated = loadLittle<std::uint16_t>(head.data() + 8) != 0;
    file.sum = loadLittle<std::uint32_t>(head.data() + 14);
    std::uint64_t packedBytes = loadLittle<std::uint32_t>(head.data() + 18);
    file.size = loadLittle<std::uint32_t>(head.data() + 22);
    if (extra >= 20) {
      file.size = loadLittle<std::uint64_t>(rest.data() + name + 4);
      packedBytes = loadLittle<std::uint64_t>(rest.data() + name + 12);
    }
    if (packedBytes > kept - zip_.offset()) damaged();  // and the sum of both must not overflow
    zip_.note(file, packedBytes);
  }
  if (zip_.offset() != kept) damaged();
}

void Archive::damaged() const {
  throw Error(ErrorCode::output,
              file_.path().string() + ": does not match the object's journal; remove both");
}

}  // namespace sherd
