// What has threads of its own, apart from TBB: for ThreadSanitizer, which Debian's TBB and PoCL are
// not built for, so that it would find races in them.  Linked from the few sources that are tested,
// without the library.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/files/atomic_file.h"
#include "base/files/unfinished.h"
#include "cli/terminal/held_files.h"
#include "dataset/store/file_queue.h"
#include "dataset/store/store.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

void inThreads(int count, const std::function<void(int)>& work) {
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i) threads.emplace_back(work, i);
  for (std::thread& thread : threads) thread.join();
}

class Threads : public TempFolder {
 protected:
  [[nodiscard]] fs::path file(int thread, int number) const {
    return folder_ / (std::to_string(thread) + "-" + std::to_string(number));
  }

  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
};

TEST_F(Threads, MayAllAddFilesToAQueue) {
  constexpr int kThreads = 4, kFiles = 50;
  std::atomic<int> written{0}, failed{0};
  BlockPool pool(kThreads);
  {
    FileQueue queue(1000);  // room for a few, so that those who add wait
    inThreads(kThreads, [&](int thread) {
      for (int i = 0; i < kFiles; ++i) {
        const bool bad = i == 7;
        const fs::path where = bad ? folder_ / "absent" / "a" : file(thread, i);
        ByteBlocks bytes(pool);
        bytes.append(std::string(static_cast<std::size_t>(100 + i), 'x'));
        queue.add(where, std::move(bytes),
                  [&](std::exception_ptr problem, double) { ++(problem ? failed : written); });
      }
    });
  }
  EXPECT_EQ(written, kThreads * (kFiles - 1));
  EXPECT_EQ(failed, kThreads);
  EXPECT_EQ(files(), static_cast<std::size_t>(written));
}

TEST_F(Threads, StoreFracturesWhileTheStoreRecordsThem) {
  constexpr int kThreads = 3, kFractures = 40;
  for (const bool isArchive : {false, true}) {
    std::vector<std::uint64_t> bytes;  // only the store's thread writes to it
    ObjectStore store({.root = folder_, .folder = "ball", .isArchive = isArchive}, 100'000);
    std::vector<std::shared_ptr<StagedFiles>> fractures;
    for (int i = 0; i < kFractures; ++i) fractures.push_back(store.stage(std::to_string(i) + "/"));
    for (const std::shared_ptr<StagedFiles>& files : fractures) {
      inThreads(kThreads, [&](int thread) {  // the one before may still be written
        files->take(std::to_string(thread),
                    [&](const ByteSink& sink) { sink(std::string(20'000, 'x')); });
      });
      store.keep(files, [&bytes](const KeptFiles& kept) {
        bytes.push_back(kept.files[0].bytes + kept.files[1].bytes + kept.files[2].bytes);
      });
    }
    (void)store.finish();
    EXPECT_EQ(bytes, std::vector<std::uint64_t>(kFractures, 60'000));
  }
}

TEST_F(Threads, MayMakeAndDropTemporaryFiles) {
  inThreads(4, [&](int thread) {
    for (int i = 0; i < 50; ++i) {
      AtomicFile out(file(thread, i));
      out.write("text");
      if (i % 2 == 0) out.commit();  // or else it goes
    }
  });
  EXPECT_EQ(files(), 100u);
}

TEST_F(Threads, MayHoldFilesThatArePutInPlaceTogether) {
  HeldFiles held;
  inThreads(4, [&](int thread) {
    for (int i = 0; i < 25; ++i) {
      held.take(file(thread, i).string(), [](const ByteSink& write) { write("text"); });
    }
  });
  const Uncut whole;
  held.putInPlace();
  held.keep();
  EXPECT_EQ(files(), 100u);
}

}  // namespace
}  // namespace sherd
