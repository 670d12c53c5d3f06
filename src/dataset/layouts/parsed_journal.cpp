// Parses journals.  The bytes are untrusted: anybody may have written them, and disks fail.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <set>

#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"
#include "base/files/sha256.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/json_fields.h"
#include "dataset/layouts/fracture_line.h"

namespace sherd {
namespace {

constexpr int kMostRepeats = 1 << 30;

void requireSum(const std::string& sum) {
  const bool good = sum.size() == 64 && sum.find_first_not_of("0123456789abcdef") == sum.npos;
  if (!good) fields::damaged("'" + sum + "' is not a SHA-256");
}

using NamedSet = std::set<std::string>;

// The names of a line's files.
NamedSet namesOf(const Json& line) {
  NamedSet names;
  for (const Json& file : fields::list(line, "files")) {
    const bool good = file.is_array() && file.size() == 3 && file[0].is_string() &&
                      file[1].is_number_unsigned() && file[2].is_string();
    if (!good) fields::damaged("\"files\" has an entry that is not [name, bytes, SHA-256]");
    const std::string name = file[0];
    if (!isBelowFolder(name))
      fields::damaged("lists '" + name + "', which leaves the dataset's folder");
    requireSum(file[2]);
    names.insert(name);
  }
  return names;
}

void requireListed(const Json& names, const NamedSet& files) {
  for (const Json& name : names) {
    if (!name.is_string()) fields::damaged("a file's name is not text");
    if (!files.contains(name))
      fields::damaged("'" + name.get<std::string>() + "' is not in its list of files");
  }
}

void checkPose(const Json& pose) {
  for (const char* key : {"rotation", "center", "truth_rotation", "truth_translation"}) {
    const Json& numbers = fields::list(pose, key);
    const std::size_t expected = std::string_view(key).ends_with("rotation") ? 4 : 3;
    const bool good = numbers.size() == expected &&
                      std::all_of(numbers.begin(), numbers.end(),
                                  [](const Json& number) { return number.is_number(); });
    if (!good)
      fields::damaged(std::string("\"") + key + "\" is not a list of " + std::to_string(expected) +
                      " numbers");
  }
}

// Returns the number of objects of an assemblage.
std::size_t checkObjects(const Json& line) {
  const Json& objects = fields::list(line, "objects");
  for (const Json& object : objects) {
    if (!object.is_object()) fields::damaged("\"objects\" has an entry that is no object");
    (void)fields::text(object, "mesh");
    (void)fields::count(object, "seed");
    fields::requireNumber(object, "scale");
    const Json& translation = fields::list(object, "translation");
    const auto isNumber = [](const Json& value) { return value.is_number(); };
    if (translation.size() != 3 || !std::ranges::all_of(translation, isNumber))
      fields::damaged("a translation is not three numbers");
    if (object.contains("intruder"))
      (void)fields::get(object, "intruder", &Json::is_boolean, "true or false");
  }
  return objects.size();
}

void checkFragment(const Json& fragment, const NamedSet& files, std::size_t objects) {
  if (!fragment.is_object()) fields::damaged("a fragment is not an object");
  if (fragment.contains("object")) {
    if (objects == 0) fields::damaged("a fragment is of an object that is not there");
    (void)fields::count(fragment, "object", 0, objects - 1);
  }
  (void)fields::count(fragment, "id", 1, kMaxFragments);
  for (const char* key : {"voxels", "vertices", "faces"}) (void)fields::count(fragment, key);
  for (const char* key : {"share", "volume"}) fields::requireNumber(fragment, key);
  for (const Json& contact : fields::list(fragment, "contacts")) {
    const bool good = contact.is_array() && contact.size() == 2 &&
                      contact[0].is_number_unsigned() && contact[1].is_number();
    if (!good) fields::damaged("\"contacts\" has an entry that is not [fragment, area]");
  }
  if (fragment.contains("withheld")) {
    (void)fields::get(fragment, "withheld", &Json::is_boolean, "true or false");
  }
  if (fragment.contains("pose"))
    checkPose(fields::get(fragment, "pose", &Json::is_object, "an object"));
  requireListed(fields::list(fragment, "files"), files);
}

void checkFracture(const Json& line) {
  const PlannedFracture planned{static_cast<int>(fields::count(line, "pieces", 0, kMaxFragments)),
                                static_cast<int>(fields::count(line, "repeat", 0, kMostRepeats))};
  const std::string name = fields::text(line, "fracture");
  if (name != kWholeName && name != planned.name()) {
    fields::damaged("\"fracture\" is '" + name + "', its pieces and repeat make it '" +
                    planned.name() + "'");
  }
  (void)fields::count(line, "attempt", 0, kMostRepeats);
  (void)fields::count(line, "seed");
  (void)fields::count(line, "archive");
  for (const auto& [option, value] :
       fields::get(line, "options", &Json::is_object, "an object").items()) {
    if (!value.is_string()) fields::damaged("option " + option + " is not text");
  }
  const std::size_t objects = line.contains("objects") ? checkObjects(line) : 0;
  const NamedSet files = namesOf(line);
  requireListed(fields::list(line, "labels"), files);
  for (const Json& fragment : fields::list(line, "fragments"))
    checkFragment(fragment, files, objects);
}

FailedObject failedObject(const Json& line) {
  FailedObject failed{fields::text(line, "failed"), fields::text(line, "sha256"),
                      fields::get(line, "again", &Json::is_boolean, "true or false").get<bool>()};
  if (!failed.sha256.empty()) requireSum(failed.sha256);
  return failed;
}

// Adds a line to the journal.
void addLine(Json line, JournalText& journal) {
  if (!line.is_object()) fields::damaged("is not an object");
  if (journal.done || journal.failed) fields::damaged("comes after the journal's last line");
  const bool isBegun = !journal.sha256.empty();
  if (line.contains("object")) {
    if (isBegun) fields::damaged("begins the object again");
    journal.object = fields::text(line, "object");
    journal.sha256 = fields::text(line, "sha256");
    requireSum(journal.sha256);
  } else if (line.contains("failed")) {
    if (!isBegun) journal.object = fields::text(line, "of");
    journal.failed = failedObject(line);
  } else if (!isBegun) {
    fields::damaged("comes before the object's own line");
  } else if (line.contains("fracture")) {
    checkFracture(line);
    journal.fractures.push_back(std::move(line));
  } else if (line.contains("done")) {
    (void)namesOf(line);
    journal.files = filesOf(line);
    journal.done = true;
  } else {
    fields::damaged("is not a line of a journal");
  }
}

// The end of a line: its checksum, which is not part of what it is of.
constexpr std::string_view kSumKey = R"(,"sum":")";
constexpr std::string_view kSumEnd = R"("})";
constexpr std::size_t kSumDigits = 16;
constexpr std::size_t kSealBytes = kSumKey.size() + kSumDigits + kSumEnd.size();

std::string sumOf(std::string_view line, const std::string& before) {
  return sha256(before + std::string(line)).substr(0, kSumDigits);
}

// Checks a line's checksum, and sets `sum` to it.
void checkSum(std::string_view line, std::string& sum) {
  const std::size_t size = line.size() < kSealBytes ? 0 : line.size() - kSealBytes;
  const std::string_view seal = line.substr(size);
  if (!seal.starts_with(kSumKey) || !seal.ends_with(kSumEnd)) fields::damaged("has no checksum");
  const std::string expected = sumOf(line.substr(0, size), sum);
  if (seal.substr(kSumKey.size(), kSumDigits) != expected)
    fields::damaged("does not match its checksum, or the line before is another");
  sum = expected;
}

}  // namespace

std::string sealedLine(std::string line, std::string& before) {
  line.pop_back();  // the closing brace
  before = sumOf(line, before);
  return line.append(kSumKey).append(before).append(kSumEnd).append("\n");
}

JournalText parsedJournal(std::string_view bytes, const std::string& name) {
  JournalText journal;
  std::size_t number = 0;
  for (;;) {
    const std::string_view rest = bytes.substr(journal.bytes);
    const std::size_t end = rest.find('\n');
    if (end == rest.npos) return journal;  // an incomplete line
    ++number;
    try {
      checkSum(rest.substr(0, end), journal.sum);
      addLine(parsedOrderedJson(rest.substr(0, end)), journal);
    } catch (const Error& e) {
      throw Error(ErrorCode::input,
                  name + ":" + std::to_string(number) + ": is damaged: " + e.what() +
                      "; remove the file, and a resumed run breaks its object again",
                  OptionNames{"resume"});
    }
    journal.bytes += end + 1;
  }
}

}  // namespace sherd
