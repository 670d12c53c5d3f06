// Files that are written past the system's cache, and archives beyond the limits of 32 and 16 bits.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/files/appended_file.h"
#include "base/files/atomic_file.h"
#include "base/files/sha256.h"
#include "base/random.h"
#include "dataset/store/archive.h"
#include "dataset/store/byte_blocks.h"
#include "dataset/store/store.h"
#include "formats/arrays/zip_writer.h"
#include "full_disk.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Bytes without a period.
std::string noise(std::size_t size, std::uint64_t seed) {
  std::string bytes;
  for (std::uint64_t i = 0; bytes.size() < size; ++i) {
    const std::uint64_t bits = randomBits(seed, Stage::pointPosition, i);
    bytes.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  }
  bytes.resize(size);
  return bytes;
}

using StoredFiles = TempFolder;

TEST_F(StoredFiles, BlocksHoldWhatWasAppended) {
  BlockPool pool(2);
  const std::string bytes = noise(3 * BlockPool::kBytes + 17, 1);
  for (const std::size_t step : {std::size_t{1000}, BlockPool::kBytes, bytes.size()}) {
    ByteBlocks blocks(pool);
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      blocks.append(std::string_view(bytes).substr(at, step));
    }
    std::string all;
    for (const std::string_view piece : blocks.pieces()) all += piece;
    EXPECT_EQ(blocks.size(), bytes.size());
    EXPECT_TRUE(all == bytes) << step;
  }
}

TEST_F(StoredFiles, ArePiecesOneAfterAnother) {
  BlockPool pool(1000);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, BlockPool::kBytes - 1, BlockPool::kBytes,
        2 * BlockPool::kBytes + 4097, 1030 * BlockPool::kBytes + 5}) {  // more than one call takes
    const std::string bytes = noise(size, 2);
    ByteBlocks blocks(pool);
    blocks.append(bytes);
    for (const Caching caching : {Caching::kept, Caching::none}) {
      AtomicFile file(folder_ / "a", caching);
      file.write("head ");
      file.write(blocks.pieces());
      file.commit();
      EXPECT_TRUE(bytesOf(folder_ / "a") == "head " + bytes) << size;
      AtomicFile direct(folder_ / "a", caching);
      direct.write(blocks.pieces());
      direct.write(" end");
      direct.commit();
      EXPECT_TRUE(bytesOf(folder_ / "a") == bytes + " end") << size;
    }
  }
}

TEST_F(StoredFiles, GrowByAppending) {
  const std::string bytes = noise(5'000'000, 3);
  const fs::path file = folder_ / "a";
  std::size_t kept = 0;
  for (std::uint64_t run = 0; kept < bytes.size(); ++run) {  // each is killed but the last
    AppendedFile out(file);
    out.cutTo(kept);
    for (int i = 0; i < 6 && kept < bytes.size(); ++i) {
      const std::size_t some = randomBelow(400'000, 4, Stage::pointPosition, 10 * run + i);
      out.append(std::string_view(bytes).substr(kept, some));
      kept = std::min(bytes.size(), kept + some);
      if (i % 2 == 0) continue;
      out.flush();
      const std::string now = bytesOf(file);
      ASSERT_TRUE(now.starts_with(std::string_view(bytes).substr(0, kept)));
      ASSERT_LT(now.size(), kept + kDirectBlock);
    }
    if (kept == bytes.size()) {
      out.close();
    } else {
      out.flush();
    }
  }
  EXPECT_TRUE(bytesOf(file) == bytes);
}

TEST_F(StoredFiles, ReportAFullDiskWhereTheyGrow) {
  std::string sentence;
  {
    const FullDisk full(3'000'000);
    try {
      AppendedFile file(folder_ / "a");
      file.cutTo(0);
      for (int i = 0; i < 8; ++i) file.append(std::string(1'000'000, 'x'));
      file.close();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::output);
      sentence = e.what();
    }
  }
  EXPECT_EQ(sentence, (folder_ / "a").string() + ": cannot be written: file too large");
}

// The error of the thread that appends.
TEST_F(StoredFiles, OfAnArchiveReportAFullDiskToTheCaller) {
  int kept = 0;
  std::string sentence;
  {
    const FullDisk full(3'000'000);
    try {
      ObjectStore store({.root = folder_, .folder = "ball", .isArchive = true}, 10'000'000);
      for (int i = 0; i < 8; ++i) {
        std::shared_ptr<StagedFiles> files = store.stage(std::to_string(i) + "/");
        files->take("a", [](const ByteSink& sink) { sink(std::string(1'000'000, 'x')); });
        store.keep(files, [&](const KeptFiles& stored) {
          EXPECT_EQ(stored.files.size(), 1u);
          EXPECT_LT(stored.archiveBytes, 3'000'000u);
          ++kept;
        });
      }
      (void)store.finish();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::output);
      sentence = e.what();
    }
  }
  EXPECT_EQ(sentence,
            (folder_ / "ball.zip.partial").string() + ": cannot be written: file too large");
  EXPECT_EQ(kept, 2);
  EXPECT_FALSE(fs::exists(folder_ / "ball.zip"));
}

TEST_F(StoredFiles, AreKeptInTheOrderOfTheCalls) {
  for (const bool isArchive : {false, true}) {
    std::vector<std::string> order;
    ObjectStore store({.root = folder_, .folder = "ball", .isArchive = isArchive}, 100'000);
    for (int i = 0; i < 20; ++i) {
      std::shared_ptr<StagedFiles> files = store.stage(std::to_string(i) + "/");
      const auto bytes = static_cast<std::size_t>(i % 3 == 0 ? 500'000 : 10);
      files->take("a", [&](const ByteSink& sink) { sink(std::string(bytes, 'x')); });
      store.keep(files, [&order](const KeptFiles& kept) { order.push_back(kept.files[0].name); });
    }
    (void)store.finish();
    ASSERT_EQ(order.size(), 20u);
    for (std::size_t i = 0; i < order.size(); ++i) {
      EXPECT_EQ(order[i], (isArchive ? "" : "ball/") + std::to_string(i) + "/a");
    }
  }
}

// Of a large file no more is in memory than HeldBytes::kMost.
TEST_F(StoredFiles, LargeOnesWaitInATemporaryFile) {
  const std::string large = noise(HeldBytes::kMost + 12'345, 3), small = noise(1000, 4);
  for (const bool isArchive : {false, true}) {
    {
      ObjectStore store({.root = folder_, .folder = "ball", .isArchive = isArchive}, 100'000);
      std::shared_ptr<StagedFiles> files = store.stage("");
      files->take("a", [&](const ByteSink& sink) {
        for (std::size_t at = 0; at < large.size(); at += 100'000) {
          sink(std::string_view(large).substr(at, 100'000));
        }
      });
      files->take("b", [&](const ByteSink& sink) { sink(small); });
      std::vector<FileRecord> records;
      store.keep(files, [&](KeptFiles kept) { records = std::move(kept.files); });
      (void)store.finish();
      ASSERT_EQ(records.size(), 2u);
      EXPECT_EQ(records[0].bytes, large.size());
      EXPECT_EQ(records[0].sha256, sha256(large));
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_)) {
      EXPECT_FALSE(isTemporaryName(entry.path().filename().string())) << entry.path();
    }
    if (isArchive) {
      const std::string archive = bytesOf(folder_ / "ball.zip");
      EXPECT_NE(archive.find(large), archive.npos);
      EXPECT_NE(archive.find(small), archive.npos);
    } else {
      EXPECT_TRUE(bytesOf(folder_ / "ball" / "a") == large);
      EXPECT_TRUE(bytesOf(folder_ / "ball" / "b") == small);
    }
  }
}

TEST_F(StoredFiles, ManyOfAnArchiveWaitInTemporaryFilesToo) {
  const std::string some = noise(HeldBytes::kMost - 1, 5);
  ObjectStore store({.root = folder_, .folder = "ball", .isArchive = true}, 100'000'000);
  std::shared_ptr<StagedFiles> files = store.stage("");
  const auto waiting = [&] {
    return std::ranges::count_if(fs::directory_iterator(folder_), [](const auto& entry) {
      return isTemporaryName(entry.path().filename().string());
    });
  };
  for (int i = 0; i < 6; ++i) {
    files->take(std::to_string(i), [&](const ByteSink& sink) { sink(some); });
    EXPECT_EQ(waiting(), i < 4 ? 0 : i - 3) << i;
  }
  std::vector<FileRecord> records;
  store.keep(files, [&](KeptFiles kept) { records = std::move(kept.files); });
  (void)store.finish();
  EXPECT_EQ(records.size(), 6u);
  EXPECT_EQ(waiting(), 0);
}

TEST_F(StoredFiles, LargeOnesOfAFailedFractureLeaveNothing) {
  for (const bool isArchive : {false, true}) {
    ObjectStore store({.root = folder_, .folder = "ball", .isArchive = isArchive}, 100'000);
    const std::shared_ptr<StagedFiles> files = store.stage("");
    EXPECT_THROW(files->take("a",
                             [](const ByteSink& sink) {
                               sink(std::string(HeldBytes::kMost + 1, 'x'));
                               throw Error(ErrorCode::cancelled, "");
                             }),
                 Error);
    EXPECT_FALSE(fs::exists(folder_ / "ball" / "a"));
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_)) {
    EXPECT_FALSE(isTemporaryName(entry.path().filename().string())) << entry.path();
  }
}

// ---- Archives of more bytes and files than the first ZIP files could have, by Python's zipfile

int runPython(const std::string& script, const fs::path& file) {
  const std::string command = "/usr/bin/python3 -c '" + script + "' '" + file.string() + "'";
  return std::system(command.c_str());
}

// Writes a ZIP file with holes.
class SparseZip {
 public:
  explicit SparseZip(const fs::path& file)
      : descriptor_(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666)) {}
  ~SparseZip() { ::close(descriptor_); }
  SparseZip(const SparseZip&) = delete;
  SparseZip& operator=(const SparseZip&) = delete;

  void addZeros(const std::string& name, std::uint64_t size) {
    zip_.begin({name, false, crcOfZeros(size), size, {}}, size);
    at_ += size;
  }
  void add(const std::string& name, const std::string& text) {
    zip_.add(packed(name, false, [&](const ByteSink& sink) { sink(text); }));
  }
  void finish() { zip_.finish(); }

 private:
  static std::uint32_t crcOfZeros(std::uint64_t size) {
    uLong sum = 0, power = ::crc32(0, reinterpret_cast<const Bytef*>("\0"), 1);  // of 2^k zeros
    for (z_off_t length = 1; size > 0; size >>= 1, length *= 2) {
      if ((size & 1) != 0) sum = ::crc32_combine(sum, power, length);
      power = ::crc32_combine(power, power, length);
    }
    return static_cast<std::uint32_t>(sum);
  }

  int descriptor_;
  std::uint64_t at_ = 0;
  ZipWriter zip_{[this](std::string_view bytes) {
    ASSERT_EQ(::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at_)),
              static_cast<ssize_t>(bytes.size()));
    at_ += bytes.size();
  }};
};

TEST_F(StoredFiles, OfMoreThanFourGibibytesAreReadByPython) {
  const fs::path file = folder_ / "large.zip";
  SparseZip zip(file);
  zip.add("first", "one");
  zip.addZeros("below", 0xfffffffeu);  // the largest size of 32 bits
  zip.add("second", "two");            // begins beyond 32 bits
  zip.addZeros("above", 0xffffffffu);  // the smallest that needs 64
  zip.addZeros("large", std::uint64_t{5} << 30);
  zip.add("last", "three");
  zip.finish();
  EXPECT_EQ(runPython(R"(
import sys, zipfile
archive = zipfile.ZipFile(sys.argv[1])
sizes = [(i.filename, i.file_size, i.compress_size) for i in archive.infolist()]
expected = [("first", 3), ("below", 2**32 - 2), ("second", 3), ("above", 2**32 - 1), ("large", 5 * 2**30), ("last", 5)]
assert sizes == [(name, size, size) for name, size in expected], sizes
assert [archive.read(name) for name in ("first", "second", "last")] == [b"one", b"two", b"three"]
for name in "below", "above", "large":  # local headers agree with the directory; the sum is checked at the end only
    assert archive.open(name).read(1000) == bytes(1000)
)",
                      file),
            0);
}

TEST_F(StoredFiles, OfMoreThan65535EntriesAreReadByPython) {
  const fs::path file = folder_ / "many.zip";
  SparseZip zip(file);
  for (int i = 0; i < 65'540; ++i) zip.add(std::to_string(i), "x");
  zip.finish();
  EXPECT_EQ(runPython(R"(
import sys, zipfile
archive = zipfile.ZipFile(sys.argv[1])
assert archive.namelist() == [str(i) for i in range(65540)]
assert archive.read("65539") == b"x"
)",
                      file),
            0);
}

// The bytes of each file begin at a multiple of the alignment, and readers skip what is between.
TEST_F(StoredFiles, AreAlignedInAnArchive) {
  for (const std::uint64_t alignment : {1, 64, 4096}) {
    std::string bytes;
    ZipWriter zip([&](std::string_view more) { bytes += more; }, alignment);
    for (std::size_t length = 1; length <= 130; ++length) {  // every remainder of 64, twice
      zip.add(packed(std::string(length, 'n'), false,
                     [&](const ByteSink& sink) { sink(noise(length, length)); }));
      EXPECT_EQ(zip.offset(), bytes.size());
      EXPECT_EQ((bytes.size() - length) % alignment, 0u) << length;
    }
    zip.add(packed("gr\u00f6\u00dfe", false, [](const ByteSink& sink) { sink("one"); }));
    zip.finish();
    AtomicFile file(folder_ / "aligned.zip");
    file.write(bytes);
    file.commit();
    EXPECT_EQ(runPython(R"(
import sys, zipfile
archive = zipfile.ZipFile(sys.argv[1])
assert archive.testzip() is None
assert archive.namelist() == ["n" * i for i in range(1, 131)] + ["gr\u00f6\u00dfe"]
assert [i.file_size for i in archive.infolist()] == [*range(1, 131), 3]
)",
                        folder_ / "aligned.zip"),
              0);
  }
}

// An archive of an earlier run that is longer than 4 GiB grows.
TEST_F(StoredFiles, AreAddedToALargeArchiveOfAnEarlierRun) {
  const std::uint64_t zeros = (std::uint64_t{4} << 30) + 5;
  std::uint64_t kept = 0;
  {
    SparseZip zip(folder_ / "ball.zip.partial");
    zip.add("first", "one");
    zip.addZeros("zeros", zeros);
    kept = 30 + 5 + 3 + 30 + 5 + 20 + zeros;
    ASSERT_EQ(::truncate((folder_ / "ball.zip.partial").c_str(), static_cast<off_t>(kept + 999)),
              0);  // what a killed run left behind the last fracture of the journal
  }
  ObjectStore store({.root = folder_, .folder = "ball", .isArchive = true, .archive = kept}, 1000);
  for (const char* name : {"a", "b"}) {
    std::shared_ptr<StagedFiles> files = store.stage("");
    files->take(name, [](const ByteSink& sink) { sink(std::string(5000, 'x')); });
    store.keep(files, [&](const KeptFiles& stored) { kept = stored.archiveBytes; });
  }
  const std::vector<FileRecord> archive = store.finish();
  ASSERT_EQ(archive.size(), 1u);
  EXPECT_EQ(archive[0].bytes, fs::file_size(folder_ / "ball.zip"));
  EXPECT_EQ(archive[0].sha256, sha256OfFile(folder_ / "ball.zip"));
  EXPECT_EQ(runPython(R"(
import sys, zipfile
archive = zipfile.ZipFile(sys.argv[1])
assert [(i.filename, i.file_size) for i in archive.infolist()] == [("first", 3), ("zeros", 2**32 + 5), ("a", 5000), ("b", 5000)]
assert archive.read("first") == b"one" and archive.read("a") == archive.read("b") == b"x" * 5000
)",
                      folder_ / "ball.zip"),
            0);
}

}  // namespace
}  // namespace sherd
