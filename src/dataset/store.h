// Where the files of an object go: each to the disk by itself, or all into one archive.
#pragma once

#include <sherd/dataset.h>

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "dataset/file_queue.h"
#include "formats/arrays/zip_writer.h"

namespace sherd {

/// A file that was written.
struct FileRecord {
  std::string name;  ///< below the dataset's folder, or in the archive; with what packs it: ".zip"
  std::uint64_t bytes = 0;
  std::string sha256;  ///< of the file as it lies there; in an archive, of what it unpacks to
};

/// The files of one fracture on their way.  Any thread may hand them over.
class StagedFiles : public FileSink {
 public:
  ///   root     the dataset's folder; empty: into an archive
  ///   prefix   before every name
  ///   queue    writes them, unless they go into an archive
  StagedFiles(std::filesystem::path root, std::string prefix, FileCompression compression,
              FileQueue* queue);
  ~StagedFiles() override;

  void take(const std::string& name, const Content& content) override;

  /// What a file is called once it is packed.
  [[nodiscard]] std::string stored(const std::string& name) const;

  /// Seconds that whoever handed them over spent on packing them.
  [[nodiscard]] double packing() const;

  /// Seconds that were spent on writing them, all told once they are kept.
  [[nodiscard]] double writing() const;

 private:
  friend class ObjectStore;
  FileRecord toDisk(const std::string& name, const Content& content);
  FileRecord toArchive(const std::string& name, const Content& content);

  std::filesystem::path root_;
  std::string prefix_;
  FileCompression compression_;
  void waitForAll();

  FileQueue* queue_;
  mutable std::mutex mutex_;
  std::condition_variable written_;
  std::size_t onTheirWay_ = 0;
  std::exception_ptr problem_;  // the first
  std::vector<FileRecord> records_;
  std::vector<PackedFile> packed_;
  double packing_ = 0.0, writing_ = 0.0;
};

/// Keeps the files of an object.  What is not kept, and is below the object's folder, is from a run
/// that ended too early, and goes.
class ObjectStore {
 public:
  ///   root    the dataset's folder, which is there
  ///   folder  the object's, below it
  ///   kept    what an earlier run has kept
  ///   archive  bytes of the archive that are kept
  ///   mostQueued  bytes of loose files that may wait for the disk
  ///   throws  Error(output) a symbolic link on the way to the folder or the archive, all else
  ObjectStore(std::filesystem::path root, std::string folder, DatasetLayout layout,
              FileCompression compression, const std::vector<FileRecord>& kept,
              std::uint64_t archive, std::size_t mostQueued = 0);
  ~ObjectStore();
  ObjectStore(const ObjectStore&) = delete;
  ObjectStore& operator=(const ObjectStore&) = delete;

  /// Files to be taken, under names below the object's folder.
  [[nodiscard]] std::unique_ptr<StagedFiles> stage(const std::string& prefix) const;

  /// Keep them once they are written, in the order in which this is called.
  ///   return  [files] ascending by name
  ///   throws  Error(output)
  std::vector<FileRecord> keep(StagedFiles& files);

  /// Bytes of the archive so far; 0 where there is none.
  [[nodiscard]] std::uint64_t archiveBytes() const;

  /// Nothing follows.
  ///   return  the archive, where there is one
  std::vector<FileRecord> finish();

  /// Take away all there is of the object.
  void discard();

 private:
  class Archive;
  [[nodiscard]] std::filesystem::path place() const { return root_ / folder_; }

  std::filesystem::path root_;
  std::string folder_;
  FileCompression compression_;
  std::unique_ptr<Archive> archive_;
  std::unique_ptr<FileQueue> queue_;
};

}  // namespace sherd
