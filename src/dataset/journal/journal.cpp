// The journal of an object: a record of finished work.
#include "dataset/journal/journal.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/input_error.h"
#include "dataset/journal/object_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot(const fs::path& file, int number) {
  throw Error(ErrorCode::output, file.string() + ": cannot be written: " + reasonOf(number));
}

}  // namespace

std::string journalName(const LibraryObject& object) {
  return std::string(kJournalFolder) + "/" + object.folder + ".jsonl";
}

Json jsonOf(const std::vector<FileRecord>& files) {
  Json list = Json::array();
  for (const FileRecord& file : files) list.push_back({file.name, file.bytes, file.sha256});
  return list;
}

std::vector<FileRecord> filesOf(const Json& line) {
  std::vector<FileRecord> files;
  for (const Json& file : line.value("files", Json::array())) {
    files.push_back({file.at(0), file.at(1), file.at(2)});
  }
  return files;
}

namespace {

std::string dumped(const Json& line) {
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Returns text as it is read back from a journal, which has no bytes that are not UTF-8.
std::string asInJournal(const std::string& text) { return Json::parse(dumped(text)); }

}  // namespace

JournalText readJournal(const fs::path& out, const LibraryObject& object) {
  const std::string name = journalName(object);
  if (!fs::exists(fs::symlink_status(out / name))) return {};
  if (!isOwnFile(out, name))
    inputError(out / name, "is not a regular file, or a symbolic link leads there");
  JournalText journal = parsedJournal(readFileBytes(out / name), (out / name).string());
  if (!journal.object.empty() && journal.object != asInJournal(object.key)) {
    inputError(out / name,
               "is the journal of " + journal.object + ", not of " + object.key +
                   "; remove the file, and a resumed run breaks its object again",
               OptionNames{"resume"});
  }
  return journal;
}

Journal::Journal(const fs::path& out, const LibraryObject& object)
    : file_(out / journalName(object)), key_(object.key) {
  requireOwnFile(out, journalName(object));
  {
    const Uncut whole;  // a signal may remove a forecast's folder concurrently
    std::error_code failed;
    fs::create_directories(file_.parent_path(), failed);
    if (failed) cannot(file_.parent_path(), failed.value());
  }
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) cannot(file_, errno);
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      throw Error(ErrorCode::output,
                  file_.string() +
                      ": another sherd process works on this object; wait for it, or "
                      "give each process its own shard",
                  OptionNames{"shard"});
    }
    text_ = readJournal(out, object);
    if (::ftruncate(descriptor_, static_cast<off_t>(text_.bytes)) != 0) cannot(file_, errno);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

Journal::~Journal() { ::close(descriptor_); }

void Journal::write(const Json& line) {
  const std::string text = sealedLine(dumped(line), text_.sum);
  std::string_view rest = text;
  while (!rest.empty()) {
    const ssize_t n = ::write(descriptor_, rest.data(), rest.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) cannot(file_, n < 0 ? errno : EIO);
    rest.remove_prefix(static_cast<std::size_t>(n));
  }
}

std::vector<FileRecord> Journal::files() const {
  std::vector<FileRecord> all;
  for (const Json& line : text_.fractures) {
    const std::vector<FileRecord> files = filesOf(line);
    all.insert(all.end(), files.begin(), files.end());
  }
  return all;
}

std::uint64_t Journal::archiveBytes() const {
  return text_.fractures.empty() ? 0 : text_.fractures.back().value("archive", std::uint64_t{0});
}

void Journal::begin(const std::string& sha256) {
  text_.sha256 = sha256;
  write({{"object", key_}, {"sha256", sha256}});
}

void Journal::add(const Json& fracture) { write(fracture); }

void Journal::finish(const std::vector<FileRecord>& files) {
  write({{"done", true}, {"files", jsonOf(files)}});
  text_.done = true;
}

void Journal::fail(const FailedObject& failed) {
  write({{"failed", failed.reason},
         {"of", key_},
         {"sha256", failed.sha256},
         {"again", failed.isPassing}});
  text_.failed = failed;
}

void Journal::clear() {
  if (::ftruncate(descriptor_, 0) != 0) cannot(file_, errno);
  text_ = {};
}

}  // namespace sherd
