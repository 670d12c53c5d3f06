// Writes files from threads of its own, so that those that compute need not wait for the disk.
#pragma once

#include <boost/align/aligned_allocator.hpp>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "base/atomic_file.h"

namespace sherd {

/// The bytes of a file, in memory aligned so that they can be written past the system's cache.
using FileBytes = std::vector<char, boost::alignment::aligned_allocator<char, kDirectBlock>>;

/// Files on their way to the disk, at most so many bytes of them.
class FileQueue {
 public:
  explicit FileQueue(std::size_t mostBytes, int threads = 2);
  /// Waits until all are written.
  ~FileQueue();
  FileQueue(const FileQueue&) = delete;
  FileQueue& operator=(const FileQueue&) = delete;

  /// What became of a file: none, or an Error(output); and the seconds that it took.
  using Done = std::function<void(std::exception_ptr problem, double seconds)>;

  /// Write a file once its turn comes; in the meantime wait if there are too many.
  ///   done  called from another thread
  void add(std::filesystem::path file, FileBytes bytes, Done done);

 private:
  struct Entry {
    std::filesystem::path file;
    FileBytes bytes;
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
