// The records of joined files.
#include "dataset/layouts/hdf5_record.h"

#include <fnmatch.h>
#include <sherd/error.h>
#include <unistd.h>

#include <optional>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"
#include "base/files/sha256.h"
#include "dataset/journal/json_fields.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordSchema = "sherd-hdf5/1";
constexpr const char* kShardFiles = "fractures_[0-9]*_of_[0-9]*.hdf5";
constexpr std::uintmax_t kLargestRecord = std::uintmax_t{1} << 30;

JoinedFile stateFrom(const Json& json, const std::string& name) {
  JoinedFile state{name, fields::count(json, "bytes"), fields::text(json, "sha256"), {}};
  for (const auto& [key, sum] :
       fields::get(json, "objects", &Json::is_object, "an object").items()) {
    if (!sum.is_string()) fields::damaged("a checksum of \"objects\" is not text");
    state.objects.emplace(key, sum);
  }
  return state;
}

// Returns the state that a file has; nothing if its record is damaged or does not fit.
std::optional<JoinedFile> stateOf(const fs::path& out, const std::string& name) try {
  const std::uintmax_t bytes = fs::file_size(out / name);
  const Json record = readOrderedJson(out / recordName(name), "record", kLargestRecord);
  if (!record.is_object() || fields::text(record, "schema") != kRecordSchema) return {};
  std::vector<JoinedFile> fitting;
  for (const Json& json : fields::list(record, "states")) {
    if (!json.is_object()) return {};
    JoinedFile state = stateFrom(json, name);
    if (state.bytes == bytes) fitting.push_back(std::move(state));
  }
  if (fitting.size() == 1) return fitting.front();
  const std::string sum = fitting.empty() ? "" : sha256OfFile(out / name);
  for (JoinedFile& state : fitting) {
    if (state.sha256 == sum) return std::move(state);
  }
  return {};
} catch (const Error&) {
  return {};
} catch (const fs::filesystem_error&) {
  return {};
}

}  // namespace

std::string recordName(const std::string& joined) { return joined + ".json"; }

void writeRecord(const fs::path& out, const std::vector<JoinedFile>& states) {
  Json list = Json::array();
  for (const JoinedFile& state : states) {
    list.push_back({{"bytes", state.bytes}, {"sha256", state.sha256}, {"objects", state.objects}});
  }
  const Json record = {{"schema", kRecordSchema}, {"states", std::move(list)}};
  writeWhole(out / recordName(states.front().name),
             record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

void removeShardFiles(const fs::path& out) {
  std::error_code failed;
  for (fs::directory_iterator at(out, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().filename().string();
    const bool isShards = ::fnmatch(kShardFiles, name.c_str(), 0) == 0 ||
                          ::fnmatch(recordName(kShardFiles).c_str(), name.c_str(), 0) == 0;
    if (isShards && isOwnFile(out, name)) ::unlink(at->path().c_str());
  }
}

std::vector<JoinedFile> joinedFiles(const fs::path& out) {
  std::vector<JoinedFile> files;
  std::error_code failed;
  for (fs::directory_iterator at(out, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().filename().string();
    const bool isNamed =
        name == std::string(kHdf5Stem) + ".hdf5" || ::fnmatch(kShardFiles, name.c_str(), 0) == 0;
    if (!isNamed || !isOwnFile(out, name) || !isOwnFile(out, recordName(name))) continue;
    if (std::optional<JoinedFile> file = stateOf(out, name)) files.push_back(std::move(*file));
  }
  std::sort(files.begin(), files.end(),
            [](const JoinedFile& a, const JoinedFile& b) { return a.name < b.name; });
  return files;
}

}  // namespace sherd
