// Failures of objects.
#include "dataset/journal/failure.h"

#include <algorithm>
#include <new>

#include "base/files/sha256.h"

namespace sherd {

Error objectError(const std::exception_ptr& met) {
  try {
    std::rethrow_exception(met);
  } catch (const Error& e) {
    return e;
  } catch (const std::bad_alloc&) {
    return {ErrorCode::input, "not enough memory; try a lower resolution, or allow it more memory",
            OptionNames{"resolution", "max-memory"}};
  } catch (const std::exception& e) {
    return {ErrorCode::internal, std::string("internal error: ") + e.what()};
  } catch (...) {
    return {ErrorCode::internal, "internal error: an exception of an unknown kind"};
  }
}

bool endsRun(const Error& error) {
  return error.code() == ErrorCode::cancelled || error.code() == ErrorCode::output;
}

bool isPassing(const Error& error) {
  if (error.code() == ErrorCode::device || error.code() == ErrorCode::internal) return true;
  // Limits of the run, which the next one may raise; other options are the dataset's.
  return std::any_of(error.options().begin(), error.options().end(), [](const std::string& name) {
    return name == "max-memory" || name == "object-timeout";
  });
}

std::string sumOfFile(const std::filesystem::path& file) try {
  return sha256OfFile(file);
} catch (const Error&) {
  return {};
}

std::string sumOfSums(const std::vector<std::string>& sums) {
  std::string all;
  for (const std::string& sum : sums) all += sum + "\n";
  return sha256(all);
}

std::string sumOfObject(const LibraryObject& object) {
  if (object.parts.empty()) return sumOfFile(object.file);
  std::vector<std::string> sums;
  for (const LibraryObject& part : object.parts) {
    sums.push_back(sumOfFile(part.file));
    if (sums.back().empty()) return {};
  }
  return sumOfSums(sums);
}

bool isTriedAgain(const FailedObject& failed, const LibraryObject& object) {
  return failed.isPassing || sumOfObject(object) != failed.sha256;
}

}  // namespace sherd
