// Storage of an object's files.
#include "dataset/store/store.h"

#include <sherd/error.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <set>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/sha256.h"
#include "base/threads.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostSpareBlocks = 256;

std::string zstdBytes(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3);
  if (ZSTD_isError(size) != 0) {
    throw Error(ErrorCode::internal, std::string("zstd: ") + ZSTD_getErrorName(size));
  }
  out.resize(size);
  return out;
}

// Passes bytes on in pieces that stay in the processor's cache while several uses read them.
ByteSink inPieces(const ByteSink& sink) {
  return [&sink](std::string_view bytes) {
    for (; bytes.size() > BlockPool::kBytes; bytes.remove_prefix(BlockPool::kBytes)) {
      sink(bytes.substr(0, BlockPool::kBytes));
    }
    sink(bytes);
  };
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

StagedFiles::StagedFiles(fs::path root, fs::path archive, std::string prefix,
                         FileCompression compression, BlockPool& pool, FileQueue* queue)
    : root_(std::move(root)),
      archive_(std::move(archive)),
      prefix_(std::move(prefix)),
      compression_(compression),
      pool_(pool),
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
  const bool isArchived = !archive_.empty();
  const char* const packing = isArchived || compression_ == FileCompression::none ? ""
                              : compression_ == FileCompression::zip              ? ".zip"
                                                                                  : ".zst";
  return prefix_ + name + packing;
}

template <class Action>
void StagedFiles::onDisk(const Action& action) {
  try {
    action();
  } catch (...) {
    isDiskAtFault_ = true;
    throw;
  }
}

FileRecord StagedFiles::toDisk(const std::string& name, const Content& content) {
  FileRecord record{stored(name), 0, {}};
  Sha256 sum;
  const fs::path path = root_ / record.name;
  HeldBytes file(pool_, path);
  const ByteSink keep = [&](std::string_view bytes) {
    record.bytes += bytes.size();
    sum.add(bytes);
    onDisk([&] { file.append(bytes); });
  };
  const ByteSink write = inPieces(keep);
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
  if (!file.isInMemory()) {
    onDisk([&] { file.commit(); });
    return record;
  }
  onDisk([&] { makeFolder(path.parent_path()); });
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
    queue_->add(path, std::move(file.inMemory()), done);
  } catch (...) {
    done(nullptr, 0.0);
    throw;
  }
  return record;
}

FileRecord StagedFiles::toArchive(const std::string& name, const Content& content) {
  FileRecord record{stored(name), 0, {}};
  Sha256 sum;
  HeldBytes bytes(pool_, archive_);
  const auto contentWithSum = [&](const ByteSink& sink) {
    const ByteSink both = [&](std::string_view some) {
      record.bytes += some.size();
      sum.add(some);
      sink(some);
    };
    content(inPieces(both));
  };
  PackedFile file = packed(record.name, compression_ != FileCompression::none, contentWithSum,
                           [&](std::string_view some) { onDisk([&] { bytes.append(some); }); });
  record.sha256 = sum.text();
  const std::lock_guard lock(mutex_);
  // Of many small files as much is held as of a few large ones.
  if (packedBytes_ + bytes.size() > kMostPacked) onDisk([&] { bytes.moveToFile(); });
  if (bytes.isInMemory()) packedBytes_ += bytes.size();
  packed_.push_back({std::move(file), std::move(bytes)});
  return record;
}

std::vector<FileRecord> StagedFiles::recorded() {
  std::sort(records_.begin(), records_.end(),
            [](const FileRecord& a, const FileRecord& b) { return a.name < b.name; });
  return std::move(records_);
}

void StagedFiles::appendTo(Archive& archive) {
  const Clock::time_point begin = Clock::now();
  std::sort(packed_.begin(), packed_.end(),
            [](const Packed& a, const Packed& b) { return a.file.name < b.file.name; });
  for (Packed& packed : packed_) {
    archive.add(packed.file, packed.bytes);
    packed.bytes.clear();
  }
  archive.flush();
  writing_ += std::chrono::duration<double>(Clock::now() - begin).count();
}

void StagedFiles::take(const std::string& name, const Content& content) {
  const Clock::time_point begin = Clock::now();
  FileRecord record = archive_.empty() ? toDisk(name, content) : toArchive(name, content);
  const std::lock_guard lock(mutex_);
  records_.push_back(std::move(record));
  packing_ += std::chrono::duration<double>(Clock::now() - begin).count();
}

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

// Removes the loose files of an object, except those to keep.
void removeLoose(const StorePlace& place, const std::vector<FileRecord>& kept) {
  for (const std::string& name : place.names) requireOwnFile(place.root, name);
  if (!place.folder.empty()) requireOwnSubfolder(place.root, place.folder + "/file");
  std::set<fs::path> names;
  for (const FileRecord& record : kept) names.insert(place.root / record.name);
  for (const std::string& name : place.names) {
    const fs::path file = place.root / name;
    if (names.contains(file) || ::unlink(file.c_str()) == 0 || errno == ENOENT || errno == ENOTDIR)
      continue;
    cannot(file, "removed", errno);
  }
  if (!place.folder.empty()) removeAllBelow(place.root / place.folder, names);
}

void requireOwnArchive(const StorePlace& place) {
  requireOwnFile(place.root, place.folder + Archive::kSuffix);
  requireOwnFile(place.root, place.folder + Archive::kUnfinished);
}

}  // namespace

ObjectStore::ObjectStore(StorePlace place, std::size_t maxQueuedBytes)
    : place_(std::move(place)), maxQueuedBytes_(maxQueuedBytes), pool_(kMostSpareBlocks) {
  if (place_.isArchive) {
    requireOwnArchive(place_);
    makeFolder(path().parent_path());
    archive_ = std::make_unique<Archive>(path(), place_.archive);
  } else {
    removeLoose(place_, place_.kept);
    queue_ = std::make_unique<FileQueue>(maxQueuedBytes);
  }
  thread_ = startedThread([this] { work(); });
}

ObjectStore::~ObjectStore() {
  {
    const std::lock_guard lock(mutex_);
    isClosed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::unique_ptr<StagedFiles> ObjectStore::stage(const std::string& prefix) {
  if (archive_) {
    return std::make_unique<StagedFiles>(place_.root, path().string() + Archive::kSuffix, prefix,
                                         place_.compression, pool_, nullptr);
  }
  const std::string folder = place_.folder.empty() ? "" : place_.folder + "/";
  return std::make_unique<StagedFiles>(place_.root, fs::path(), folder + prefix, place_.compression,
                                       pool_, queue_.get());
}

void ObjectStore::keep(std::shared_ptr<StagedFiles> files, Kept kept) {
  const std::size_t size = files->packedBytes_;
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] {
      return problem_ || entries_.empty() || waitingBytes_ + size <= maxQueuedBytes_;
    });
    if (problem_) std::rethrow_exception(problem_);
    entries_.push_back({std::move(files), std::move(kept), size});
    waitingBytes_ += size;
  }
  changed_.notify_all();
}

void ObjectStore::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return isClosed_ || !entries_.empty(); });
    if (entries_.empty()) return;
    Entry& entry = entries_.front();  // stays there until it is recorded
    const bool isUseless = problem_ != nullptr;
    lock.unlock();
    std::exception_ptr problem;
    try {
      if (!isUseless) record(*entry.files, entry.kept);
    } catch (...) {
      problem = std::current_exception();
    }
    const Entry done = std::move(entry);
    lock.lock();
    if (problem) problem_ = problem;
    waitingBytes_ -= done.bytes;
    entries_.pop_front();
    changed_.notify_all();
  }
}

void ObjectStore::record(StagedFiles& files, const Kept& kept) {
  files.waitForAll();
  if (files.problem_) std::rethrow_exception(files.problem_);
  if (archive_) files.appendTo(*archive_);
  const std::uint64_t archive = archive_ ? archive_->bytes() : 0;
  kept({files.recorded(), archive, files.packing() + files.writing()});
}

std::vector<FileRecord> ObjectStore::finish() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return entries_.empty(); });
    if (problem_) std::rethrow_exception(problem_);
  }
  if (!archive_) return {};
  const Archive::Finished finished = archive_->finish();
  return {{place_.folder + Archive::kSuffix, finished.bytes, finished.sha256}};
}

void discardStored(const StorePlace& place) {
  if (!place.isArchive) return removeLoose(place, {});
  requireOwnArchive(place);
  for (const char* suffix : {Archive::kSuffix, Archive::kUnfinished})
    ::unlink((place.root / (place.folder + suffix)).c_str());
}

}  // namespace sherd
