// Storage of an object's files: loose files, or one archive.
#pragma once

#include <sherd/dataset.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "dataset/store/archive.h"
#include "dataset/store/byte_blocks.h"
#include "dataset/store/file_queue.h"
#include "dataset/store/held_bytes.h"
#include "formats/arrays/zip_writer.h"

namespace sherd {

/// A written file.
struct FileRecord {
  std::string name;  ///< below the dataset's folder or in the archive, with its suffix: ".zip"
  std::uint64_t bytes = 0;
  std::string sha256;  ///< of the stored file; in an archive, of the unpacked file
};

/// The files of one fracture while they are packed and written.  take() is thread-safe.
class StagedFiles : public FileSink {
 public:
  ///   root     the dataset's folder
  ///   archive  that the files go to, of which the folder exists; empty for loose files
  ///   prefix   of every name
  ///   pool     of the files' bytes
  ///   queue    writes loose files; null for an archive
  StagedFiles(std::filesystem::path root, std::filesystem::path archive, std::string prefix,
              FileCompression compression, BlockPool& pool, FileQueue* queue);
  ~StagedFiles() override;

  void take(const std::string& name, const Content& content) override;

  /// Returns the name of the packed file.
  [[nodiscard]] std::string stored(const std::string& name) const;

  /// Whether take() failed because of the disk, not of the content.
  [[nodiscard]] bool isDiskAtFault() const { return isDiskAtFault_; }

  /// Seconds that callers of take() spent on packing.
  [[nodiscard]] double packing() const;

  /// Seconds that were spent on writing; complete once the files are kept.
  [[nodiscard]] double writing() const;

 private:
  friend class ObjectStore;
  struct Packed {
    PackedFile file;
    HeldBytes bytes;
  };
  template <class Action>
  void onDisk(const Action& action);  // which only the disk can make fail
  FileRecord toDisk(const std::string& name, const Content& content);
  FileRecord toArchive(const std::string& name, const Content& content);
  void waitForAll();
  void appendTo(Archive& archive);     // all of them, ascending by name
  std::vector<FileRecord> recorded();  // [files] ascending by name

  std::filesystem::path root_, archive_;
  std::string prefix_;
  FileCompression compression_;
  BlockPool& pool_;
  FileQueue* queue_;
  mutable std::mutex mutex_;
  std::condition_variable written_;
  std::size_t pending_ = 0;
  std::exception_ptr problem_;  // the first one
  std::atomic<bool> isDiskAtFault_{false};
  std::vector<FileRecord> records_;
  std::vector<Packed> packed_;
  static constexpr std::size_t kMostPacked = 4 * HeldBytes::kMost;
  std::size_t packedBytes_ = 0;  // in memory
  double packing_ = 0.0, writing_ = 0.0;
};

/// Where the files of an object are stored.
struct StorePlace {
  std::filesystem::path root;        ///< the dataset's folder, which exists
  std::string folder;                ///< the object's, below it; or empty, and then
  std::vector<std::string> names{};  ///< all that its files may have, in folders of many objects
  bool isArchive = false;            ///< one archive beside the folder instead of loose files
  FileCompression compression = FileCompression::none;
  std::vector<FileRecord> kept{};  ///< files of an earlier run to keep
  std::uint64_t archive = 0;       ///< bytes of the archive to keep
};

/// The files of one fracture once they are stored.
struct KeptFiles {
  std::vector<FileRecord> files;   ///< ascending by name
  std::uint64_t archiveBytes = 0;  ///< so far; 0 for loose files
  double seconds = 0.0;            ///< of packing and writing
};

/// Stores the files of an object.  Other files below the object's folder, or with its names, are
/// leftovers of an interrupted run and are removed.
class ObjectStore {
 public:
  ///   maxQueuedBytes  that wait for the disk
  ///   throws  Error(output), also for a symbolic link on the path of the folder or the archive
  explicit ObjectStore(StorePlace place, std::size_t maxQueuedBytes = 0);
  /// Waits for all that is kept.
  ~ObjectStore();
  ObjectStore(const ObjectStore&) = delete;
  ObjectStore& operator=(const ObjectStore&) = delete;

  /// Returns a sink for files under names below the object's folder.
  [[nodiscard]] std::unique_ptr<StagedFiles> stage(const std::string& prefix);

  using Kept = std::function<void(KeptFiles)>;

  /// Keeps staged files: a thread waits until they are written, or appends them to the archive, in
  /// the order of the calls.  Blocks while too many bytes wait for the archive.
  ///   kept    called from that thread once the files are stored; not after a problem
  ///   throws  Error(output), also of earlier files and of what `kept` throws
  void keep(std::shared_ptr<StagedFiles> files, Kept kept);

  /// Waits until all are kept, and ends the archive.
  ///   return  the archive; empty for loose files
  ///   throws  as keep()
  std::vector<FileRecord> finish();

 private:
  struct Entry {
    std::shared_ptr<StagedFiles> files;
    Kept kept;
    std::size_t bytes = 0;  // that wait for the archive
  };
  [[nodiscard]] std::filesystem::path path() const { return place_.root / place_.folder; }
  void work();
  void record(StagedFiles& files, const Kept& kept);

  StorePlace place_;
  std::size_t maxQueuedBytes_;
  BlockPool pool_;
  std::unique_ptr<Archive> archive_;
  std::unique_ptr<FileQueue> queue_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> entries_;     // the first is being stored
  std::size_t waitingBytes_ = 0;  // of all entries
  std::exception_ptr problem_;    // the first one
  bool isClosed_ = false;
  std::thread thread_;
};

/// Removes all files of an object.  It starts no thread, so that it can follow any failure.
///   throws  Error(output), also for a symbolic link on the path of the folder or the archive
void discardStored(const StorePlace& place);

}  // namespace sherd
