// Exceptions of objects.
#include <gtest/gtest.h>
#include <openvdb/Exceptions.h>

#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>

#include "dataset/failure.h"
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
  EXPECT_FALSE(isTriedAgain({"absent", "", false}, file));
  EXPECT_TRUE(isTriedAgain({"absent", "", true}, file));
  write("no mesh");
  const std::string sum = sumOfFile(file);
  EXPECT_TRUE(isTriedAgain({"absent", "", false}, file));
  EXPECT_FALSE(isTriedAgain({"no mesh", sum, false}, file));
  write("another");
  EXPECT_TRUE(isTriedAgain({"no mesh", sum, false}, file));
}

}  // namespace
}  // namespace sherd
