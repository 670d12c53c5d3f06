// Storage of an object's files.
#include "dataset/store.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <set>

#include "base/atomic_file.h"
#include "base/below_folder.h"
#include "base/little_endian.h"
#include "base/sha256.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kArchive = ".zip";
constexpr const char* kUnfinished = ".zip.partial";

std::string zstdBytes(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3);
  if (ZSTD_isError(size) != 0) {
    throw Error(ErrorCode::internal, std::string("zstd: ") + ZSTD_getErrorName(size));
  }
  out.resize(size);
  return out;
}

std::string allOf(const Content& content) {
  std::string bytes;
  content([&](std::string_view more) { bytes += more; });
  return bytes;
}

[[noreturn]] void cannot(const fs::path& file, const char* what, int number) {
  throw Error(ErrorCode::output, file.string() + ": cannot be " + what + ": " + reasonOf(number));
}

void makeFolder(const fs::path& folder) {
  const Uncut whole;  // a signal may remove a forecast's folder concurrently
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) cannot(folder, "made", failed.value());
}

}  // namespace

// ---- Staged files

StagedFiles::StagedFiles(fs::path root, std::string prefix, FileCompression compression,
                         FileQueue* queue)
    : root_(std::move(root)),
      prefix_(std::move(prefix)),
      compression_(compression),
      queue_(queue) {}

StagedFiles::~StagedFiles() { waitForAll(); }

void StagedFiles::waitForAll() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [this] { return pending_ == 0; });
}

double StagedFiles::packing() const {
  const std::lock_guard lock(mutex_);
  return packing_;
}

double StagedFiles::writing() const {
  const std::lock_guard lock(mutex_);
  return writing_;
}

std::string StagedFiles::stored(const std::string& name) const {
  const bool isArchived = root_.empty();
  const char* const packing = isArchived || compression_ == FileCompression::none ? ""
                              : compression_ == FileCompression::zip              ? ".zip"
                                                                                  : ".zst";
  return prefix_ + name + packing;
}

FileRecord StagedFiles::toDisk(const std::string& name, const Content& content) {
  FileRecord record{stored(name), 0, {}};
  Sha256 sum;
  FileBytes file;
  const auto write = [&](std::string_view bytes) {
    record.bytes += bytes.size();
    sum.add(bytes);
    file.insert(file.end(), bytes.begin(), bytes.end());
  };
  switch (compression_) {
    case FileCompression::none:
      content(write);
      break;
    case FileCompression::zip: {
      ZipWriter zip(write);
      zip.add(packed(fs::path(name).filename().string(), true, content));
      zip.finish();
      break;
    }
    case FileCompression::zstd:
      write(zstdBytes(allOf(content)));
      break;
  }
  record.sha256 = sum.text();
  const fs::path path = root_ / record.name;
  makeFolder(path.parent_path());
  const auto done = [this](std::exception_ptr problem, double seconds) {
    const std::lock_guard lock(mutex_);
    if (problem && !problem_) problem_ = std::move(problem);
    writing_ += seconds;
    --pending_;
    written_.notify_all();  // under the lock: *this may be destroyed once it is released
  };
  {
    const std::lock_guard lock(mutex_);
    ++pending_;
  }
  try {
    queue_->add(path, std::move(file), done);
  } catch (...) {
    done(nullptr, 0.0);
    throw;
  }
  return record;
}

FileRecord StagedFiles::toArchive(const std::string& name, const Content& content) {
  FileRecord record{stored(name), 0, {}};
  Sha256 sum;
  PackedFile entry =
      packed(record.name, compression_ != FileCompression::none, [&](const ByteSink& sink) {
        content([&](std::string_view bytes) {
          record.bytes += bytes.size();
          sum.add(bytes);
          sink(bytes);
        });
      });
  record.sha256 = sum.text();
  const std::lock_guard lock(mutex_);
  packed_.push_back(std::move(entry));
  return record;
}

void StagedFiles::take(const std::string& name, const Content& content) {
  const Clock::time_point begin = Clock::now();
  FileRecord record = root_.empty() ? toArchive(name, content) : toDisk(name, content);
  const std::lock_guard lock(mutex_);
  records_.push_back(std::move(record));
  packing_ += std::chrono::duration<double>(Clock::now() - begin).count();
}

// ---- The archive

class ObjectStore::Archive {
 public:
  Archive(const fs::path& path, std::uint64_t kept)
      : final_(path.string() + kArchive), file_(path.string() + kUnfinished) {
    makeFolder(file_.parent_path());
    // The archive may be finished although the journal is not.
    if (kept > 0 && !fs::exists(file_)) ::rename(final_.c_str(), file_.c_str());
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) cannot(file_, "written", errno);
    readKept(kept);
    if (::ftruncate(descriptor_, static_cast<off_t>(kept)) != 0 ||
        ::lseek(descriptor_, 0, SEEK_END) < 0) {
      cannot(file_, "written", errno);
    }
  }
  ~Archive() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  void add(const PackedFile& file) { zip_.add(file); }
  std::uint64_t bytes() const { return zip_.offset(); }
  const fs::path& file() const { return final_; }

  void finish() {
    zip_.finish();
    if (::close(std::exchange(descriptor_, -1)) != 0) cannot(file_, "written", errno);
    if (::rename(file_.c_str(), final_.c_str()) != 0) cannot(final_, "put in place", errno);
  }

  void discard() {
    ::unlink(file_.c_str());
    ::unlink(final_.c_str());
  }

 private:
  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) cannot(file_, "written", n < 0 ? errno : EIO);
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }

  // Restores the directory from the local headers of kept entries.
  void readKept(std::uint64_t kept) {
    constexpr std::size_t kLocal = 30;
    while (zip_.offset() < kept) {
      std::string head = read(kLocal, zip_.offset());
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

  std::string read(std::size_t bytes, std::uint64_t at) const {
    std::string out(bytes, '\0');
    for (std::size_t done = 0; done < bytes;) {
      const ssize_t n =
          ::pread(descriptor_, out.data() + done, bytes - done, static_cast<off_t>(at + done));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) damaged();
      done += static_cast<std::size_t>(n);
    }
    return out;
  }

  [[noreturn]] void damaged() const {
    throw Error(ErrorCode::output, file_.string() +
                                       ": does not match the object's journal; remove "
                                       "both");
  }

  fs::path final_, file_;
  int descriptor_ = -1;
  ZipWriter zip_{[this](std::string_view bytes) { write(bytes); }};
};

// ---- The object

namespace {

// Removes links, not their targets; the folder itself is no link, see requireOwnSubfolder.
void removeAllBelow(const fs::path& folder, const std::set<fs::path>& kept) try {
  if (!fs::exists(folder)) return;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() && !entry.is_symlink()) {
      folders.push_back(entry.path());
    } else if (!kept.contains(entry.path())) {
      fs::remove(entry.path());
    }
  }
  folders.push_back(folder);
  std::sort(folders.begin(), folders.end(), std::greater<>());   // deeper ones first
  for (const fs::path& empty : folders) ::rmdir(empty.c_str());  // fails if it is not empty
} catch (const fs::filesystem_error& e) {
  cannot(e.path1(), "removed", e.code().value());
}

}  // namespace

ObjectStore::ObjectStore(StorePlace place, std::size_t maxQueuedBytes) : place_(std::move(place)) {
  if (place_.isArchive) {
    requireOwnFile(place_.root, place_.folder + kArchive);
    requireOwnFile(place_.root, place_.folder + kUnfinished);
    archive_ = std::make_unique<Archive>(path(), place_.archive);
    return;
  }
  for (const std::string& name : place_.names) requireOwnFile(place_.root, name);
  if (!place_.folder.empty()) requireOwnSubfolder(place_.root, place_.folder + "/file");
  queue_ = std::make_unique<FileQueue>(maxQueuedBytes);
  removeAllBut(place_.kept);
}

ObjectStore::~ObjectStore() = default;

void ObjectStore::removeAllBut(const std::vector<FileRecord>& kept) const {
  std::set<fs::path> names;
  for (const FileRecord& record : kept) names.insert(place_.root / record.name);
  for (const std::string& name : place_.names) {
    const fs::path file = place_.root / name;
    if (names.contains(file) || ::unlink(file.c_str()) == 0 || errno == ENOENT || errno == ENOTDIR)
      continue;
    cannot(file, "removed", errno);
  }
  if (!place_.folder.empty()) removeAllBelow(path(), names);
}

std::unique_ptr<StagedFiles> ObjectStore::stage(const std::string& prefix) const {
  if (archive_)
    return std::make_unique<StagedFiles>(fs::path(), prefix, place_.compression, nullptr);
  const std::string folder = place_.folder.empty() ? "" : place_.folder + "/";
  return std::make_unique<StagedFiles>(place_.root, folder + prefix, place_.compression,
                                       queue_.get());
}

std::vector<FileRecord> ObjectStore::keep(StagedFiles& files) {
  files.waitForAll();
  if (files.problem_) std::rethrow_exception(files.problem_);
  const auto byName = [](const auto& a, const auto& b) { return a.name < b.name; };
  std::sort(files.packed_.begin(), files.packed_.end(), byName);
  for (PackedFile& file : files.packed_) {
    archive_->add(file);
    file.bytes = {};
  }
  std::sort(files.records_.begin(), files.records_.end(), byName);
  return std::move(files.records_);
}

std::uint64_t ObjectStore::archiveBytes() const { return archive_ ? archive_->bytes() : 0; }

std::vector<FileRecord> ObjectStore::finish() {
  if (!archive_) return {};
  archive_->finish();
  return {
      {place_.folder + kArchive, fs::file_size(archive_->file()), sha256OfFile(archive_->file())}};
}

void ObjectStore::discard() {
  if (archive_) {
    archive_->discard();
  } else {
    removeAllBut({});
  }
}

}  // namespace sherd
