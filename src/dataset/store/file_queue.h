// Writes files in background threads, so that compute threads do not wait for the disk.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "dataset/store/byte_blocks.h"

namespace sherd {

/// A queue of files to write past the system's cache, bounded in bytes.
class FileQueue {
 public:
  ///   threads  fewer where the system refuses some
  ///   throws   Error(internal) it refuses all
  explicit FileQueue(std::size_t mostBytes, int threads = 2);
  /// Waits until all are written.
  ~FileQueue();
  FileQueue(const FileQueue&) = delete;
  FileQueue& operator=(const FileQueue&) = delete;

  /// The outcome of a file: null or an Error(output), and the seconds of writing.
  using Done = std::function<void(std::exception_ptr problem, double seconds)>;

  /// Enqueues a file; blocks while the queue is full.
  ///   done  called from another thread
  void add(std::filesystem::path file, ByteBlocks bytes, Done done);

 private:
  struct Entry {
    std::filesystem::path file;
    ByteBlocks bytes;
    Done done;
  };
  void work();

  const std::size_t mostBytes_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> entries_;
  std::size_t bytes_ = 0;  // waiting and being written
  bool closed_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace sherd
