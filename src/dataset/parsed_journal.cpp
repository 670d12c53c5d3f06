// A journal's bytes as values: anybody may have written it, and disks fail.
#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <set>

#include "base/below_folder.h"
#include "base/parsed_json.h"
#include "dataset/fracture_line.h"
#include "dataset/journal.h"
#include "dataset/json_fields.h"

namespace sherd {
namespace {

constexpr int kMostRepeats = 1 << 30;

void requireSum(const std::string& sum) {
  const bool good = sum.size() == 64 && sum.find_first_not_of("0123456789abcdef") == sum.npos;
  if (!good) damaged("'" + sum + "' is no SHA-256");
}

using Names = std::set<std::string>;

// The names of a line's files.
Names namesOf(const Json& line) {
  Names names;
  for (const Json& file : list(line, "files")) {
    const bool good = file.is_array() && file.size() == 3 && file[0].is_string() &&
                      file[1].is_number_unsigned() && file[2].is_string();
    if (!good) damaged("\"files\" has an entry that is not [name, bytes, SHA-256]");
    const std::string name = file[0];
    if (!isBelowFolder(name)) damaged("lists '" + name + "', which leaves the dataset's folder");
    requireSum(file[2]);
    names.insert(name);
  }
  return names;
}

void requireListed(const Json& names, const Names& files) {
  for (const Json& name : names) {
    if (!name.is_string()) damaged("a file's name is not text");
    if (!files.contains(name)) damaged("'" + name.get<std::string>() + "' is none of its files");
  }
}

void checkPose(const Json& pose) {
  for (const char* key : {"turn", "centre", "truth_turn", "truth_shift"}) {
    const Json& numbers = list(pose, key);
    const std::size_t wanted = std::string_view(key).ends_with("turn") ? 4 : 3;
    const bool good = numbers.size() == wanted &&
                      std::all_of(numbers.begin(), numbers.end(),
                                  [](const Json& number) { return number.is_number(); });
    if (!good) damaged(std::string("\"") + key + "\" is not so many numbers");
  }
}

void checkFragment(const Json& fragment, const Names& files) {
  if (!fragment.is_object()) damaged("a fragment is not an object");
  (void)count(fragment, "id", 1, kMaxFragments);
  for (const char* key : {"voxels", "vertices", "faces"}) (void)count(fragment, key);
  for (const char* key : {"share", "volume"}) requireNumber(fragment, key);
  for (const Json& contact : list(fragment, "contacts")) {
    const bool good = contact.is_array() && contact.size() == 2 &&
                      contact[0].is_number_unsigned() && contact[1].is_number();
    if (!good) damaged("\"contacts\" has an entry that is not [fragment, area]");
  }
  if (fragment.contains("withheld")) {
    (void)field(fragment, "withheld", &Json::is_boolean, "true or false");
  }
  if (fragment.contains("pose")) checkPose(field(fragment, "pose", &Json::is_object, "an object"));
  requireListed(list(fragment, "files"), files);
}

void checkFracture(const Json& line) {
  const PlannedFracture planned{static_cast<int>(count(line, "pieces", 0, kMaxFragments)),
                                static_cast<int>(count(line, "repeat", 0, kMostRepeats))};
  const std::string name = text(line, "fracture");
  if (name != kWholeName && name != planned.name()) {
    damaged("\"fracture\" is '" + name + "', by its pieces and repeat it is '" + planned.name() +
            "'");
  }
  (void)count(line, "attempt", 0, kMostRepeats);
  (void)count(line, "seed");
  (void)count(line, "archive");
  for (const auto& [option, value] :
       field(line, "options", &Json::is_object, "an object").items()) {
    if (!value.is_string()) damaged("option " + option + " is not text");
  }
  const Names files = namesOf(line);
  requireListed(list(line, "labels"), files);
  for (const Json& fragment : list(line, "fragments")) checkFragment(fragment, files);
}

// Add what a line tells.
void addLine(Json line, JournalText& journal) {
  if (!line.is_object()) damaged("is not an object");
  if (journal.done || journal.failed) damaged("comes after the journal's last line");
  const bool isBegun = !journal.sha256.empty();
  if (line.contains("object")) {
    if (isBegun) damaged("begins the object again");
    (void)text(line, "object");
    journal.sha256 = text(line, "sha256");
    requireSum(journal.sha256);
  } else if (line.contains("failed")) {
    journal.failed = text(line, "failed");
  } else if (!isBegun) {
    damaged("comes before the object's own line");
  } else if (line.contains("fracture")) {
    checkFracture(line);
    journal.fractures.push_back(std::move(line));
  } else if (line.contains("done")) {
    (void)namesOf(line);
    journal.done = true;
  } else {
    damaged("tells of nothing that a journal has");
  }
}

}  // namespace

JournalText parsedJournal(std::string_view bytes, const std::string& name) {
  JournalText journal;
  std::size_t number = 0;
  for (;;) {
    const std::string_view rest = bytes.substr(journal.bytes);
    const std::size_t end = rest.find('\n');
    if (end == rest.npos) return journal;  // a line without its end is cut off
    ++number;
    try {
      addLine(parsedOrderedJson(rest.substr(0, end)), journal);
    } catch (const Error& e) {
      throw Error(ErrorCode::input, name + ":" + std::to_string(number) +
                                        ": is damaged: " + e.what() +
                                        "; remove the file, and --resume breaks its object anew");
    }
    journal.bytes += end + 1;
  }
}

}  // namespace sherd
