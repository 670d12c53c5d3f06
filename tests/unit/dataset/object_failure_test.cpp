// Exceptions of objects.
#include <gtest/gtest.h>
#include <openvdb/Exceptions.h>
#include <sherd/dataset.h>
#include <sherd/files.h>

#include <fstream>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "cl/device_impl.h"
#include "dataset/journal/failure.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

template <class Exception>
Error errorOf(const Exception& exception) {
  return objectError(std::make_exception_ptr(exception));
}

TEST(ObjectFailures, AnyExceptionIsAnErrorOfItsObject) {
  for (const Error& error :
       {errorOf(std::runtime_error("odd")), errorOf(openvdb::ArithmeticError("odd")),
        errorOf(std::system_error(std::make_error_code(std::errc::io_error), "odd"))}) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
    EXPECT_NE(std::string(error.what()).find("odd"), std::string::npos);
    EXPECT_FALSE(endsRun(error));
  }
  EXPECT_EQ(errorOf(std::bad_alloc()).code(), ErrorCode::input);
  EXPECT_EQ(errorOf(3).code(), ErrorCode::internal);
  EXPECT_EQ(std::string(errorOf(Error(ErrorCode::usage, "as it was")).what()), "as it was");
}

TEST(ObjectFailures, OnlyCancellationAndOutputEndTheRun) {
  for (const ErrorCode code :
       {ErrorCode::internal, ErrorCode::usage, ErrorCode::input, ErrorCode::device})
    EXPECT_FALSE(endsRun(Error(code, "")));
  for (const ErrorCode code : {ErrorCode::output, ErrorCode::cancelled})
    EXPECT_TRUE(endsRun(Error(code, "")));
}

TEST(ObjectFailures, ThoseForWantOfMemoryTimeOrDevicePass) {
  EXPECT_TRUE(isPassing(errorOf(std::bad_alloc())));
  EXPECT_TRUE(isPassing(errorOf(std::runtime_error("a fault of the program"))));
  EXPECT_TRUE(isPassing(Error(ErrorCode::device, "lost")));
  EXPECT_TRUE(isPassing(Error(ErrorCode::input, "", {"resolution", "max-memory"})));
  EXPECT_TRUE(isPassing(Error(ErrorCode::input, "", {"object-timeout"})));
  EXPECT_FALSE(isPassing(Error(ErrorCode::input, "no mesh", {"resolution"})));
  EXPECT_FALSE(isPassing(Error(ErrorCode::usage, "contradicts")));
}

TEST(ObjectFailures, AnotherFileIsTriedAgain) {
  const OwnFolder folder;
  const std::filesystem::path file = folder.path() / "a.obj";
  const auto write = [&](const char* text) { std::ofstream(file) << text; };
  EXPECT_FALSE(isTriedAgain({"absent", "", false}, {.key = "k", .folder = {}, .file = file}));
  EXPECT_TRUE(isTriedAgain({"absent", "", true}, {.key = "k", .folder = {}, .file = file}));
  write("no mesh");
  const std::string sum = sumOfFile(file);
  EXPECT_TRUE(isTriedAgain({"absent", "", false}, {.key = "k", .folder = {}, .file = file}));
  EXPECT_FALSE(isTriedAgain({"no mesh", sum, false}, {.key = "k", .folder = {}, .file = file}));
  write("another");
  EXPECT_TRUE(isTriedAgain({"no mesh", sum, false}, {.key = "k", .folder = {}, .file = file}));
}

// A device that is lost, and may come back.
class LosingDevice : public DeviceImpl {
 public:
  explicit LosingDevice(const bool& isLost) : isLost_(isLost) { info = implOf(whole_).info; }

  void launch(const KernelLaunch& launch) override { found().launch(launch); }
  std::unique_ptr<Allocation> allocate(std::size_t bytes) override {
    return found().allocate(bytes);
  }
  void write(Allocation& to, const void* from, std::size_t bytes) override {
    found().write(to, from, bytes);
  }
  void read(Allocation& from, std::size_t offset, std::size_t bytes, void* to) override {
    found().read(from, offset, bytes, to);
  }
  void fill(Allocation& to, const void* pattern, std::size_t patternBytes,
            std::size_t bytes) override {
    found().fill(to, pattern, patternBytes, bytes);
  }
  void copy(Allocation& from, Allocation& to, std::size_t toOffset, std::size_t bytes) override {
    found().copy(from, to, toOffset, bytes);
  }
  void view(Allocation& from, std::size_t offset, std::size_t bytes,
            const ViewedBytes& use) override {
    found().view(from, offset, bytes, use);
  }

 private:
  DeviceImpl& found() {
    if (isLost_) throw Error(ErrorCode::device, "the device is lost");
    return implOf(whole_);
  }

  const bool& isLost_;
  Device whole_;
};

class LostDevice : public TempFolder {
 protected:
  struct Run {
    bool hasThrown = false;
    std::size_t fractures = 0;
    std::vector<std::string> failed;
  };

  // Breaks a library of cubes with a device that is lost for some of them.
  Run broken(std::size_t cubes, const std::set<std::size_t>& lostFor, bool resume = false) const {
    for (std::size_t i = 0; i < cubes; ++i) {
      const std::filesystem::path file = folder_ / "library" / (std::to_string(i) + ".ply");
      std::filesystem::create_directories(file.parent_path());
      writePly(file, shapes::cube(1.0));
    }
    bool isLost = lostFor.contains(0);
    Device device = deviceOf(std::make_unique<LosingDevice>(isLost));
    DatasetOptions options{.schedule = {.fewest = 2, .most = 2, .repeatsOfFewest = 1}};
    options.each.fracture.solid.resolution = 16;
    options.resume = resume;
    Run run;
    DatasetCallbacks callbacks;
    callbacks.fractured = [&](const DatasetProgress& at) { isLost = lostFor.contains(at.objects); };
    callbacks.failed = [&](const std::string& object, const Error& reason) {
      EXPECT_EQ(reason.code(), ErrorCode::device);
      run.failed.push_back(object);
    };
    try {
      run.fractures =
          runDataset(folder_ / "library", folder_ / "out", options, device, callbacks).fractures;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::device) << e.what();
      run.hasThrown = true;
    }
    return run;
  }
};

TEST_F(LostDevice, ForOneObjectFailsItAndItIsBrokenLater) {
  const Run run = broken(3, {1});
  EXPECT_FALSE(run.hasThrown);
  EXPECT_EQ(run.failed, std::vector<std::string>{"1.ply"});
  EXPECT_EQ(run.fractures, 2u);
  const Run later = broken(3, {}, true);
  EXPECT_TRUE(later.failed.empty());
  EXPECT_EQ(later.fractures, 3u);
}

TEST_F(LostDevice, ForTwoObjectsInARowEndsTheRun) {
  const Run run = broken(4, {1, 2});
  EXPECT_TRUE(run.hasThrown);
  EXPECT_EQ(run.failed, std::vector<std::string>{"1.ply"});
  const Run later = broken(4, {}, true);
  EXPECT_TRUE(later.failed.empty());
  EXPECT_EQ(later.fractures, 4u);
}

TEST_F(LostDevice, ForTheOnlyObjectEndsTheRun) {
  EXPECT_TRUE(broken(1, {0}).hasThrown);
  EXPECT_EQ(broken(1, {}, true).fractures, 1u);
}

}  // namespace
}  // namespace sherd
