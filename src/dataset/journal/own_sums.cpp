// The checksums of a dataset's own files.
#include "dataset/journal/own_sums.h"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "dataset/journal/object_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigits = 64;

// Those at the top of the folder, and those in folders; other files there are not the dataset's.
constexpr std::array kTop{
    "dataset.json", "index.csv",   "index.jsonl", "failures.jsonl", "train.txt",
    "val.txt",      "test.txt",    "report.html", "run.json",       "recipe.json",
    "run_*.json",   "*.train.txt", "*.val.txt",   "*.test.txt",     "fractures*.hdf5.json"};
constexpr std::array kOfJournal{"*.jsonl", "*.png", "*.html"};
constexpr std::array kOfLists{"*.txt"};

template <class Patterns>
bool isOneOf(const Patterns& patterns, const fs::path& file) {
  const std::string name = file.filename().string();
  return std::any_of(patterns.begin(), patterns.end(), [&](const char* pattern) {
    return ::fnmatch(pattern, name.c_str(), FNM_PERIOD) == 0;
  });
}

template <class Iterator, class Patterns>
void addNames(const fs::path& out, const fs::path& folder, const Patterns& patterns,
              std::set<std::string>& names) {
  std::error_code failed;
  if (fs::symlink_status(folder, failed).type() != fs::file_type::directory) return;
  for (Iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().lexically_relative(out).generic_string();
    if (isOneOf(patterns, at->path()) && isOwnFile(out, name)) names.insert(name);
  }
}

std::set<std::string> ownFiles(const fs::path& out) {
  std::set<std::string> names;
  addNames<fs::directory_iterator>(out, out, kTop, names);
  addNames<fs::recursive_directory_iterator>(out, out / kJournalFolder, kOfJournal, names);
  for (const char* folder : {kBbSplitFolder, kBbListFolder})
    addNames<fs::directory_iterator>(out, out / folder, kOfLists, names);
  return names;
}

// A name as sha256sum has it: with a line break or backslash, those are escaped and the line begins
// with a backslash.
std::string lineOf(const std::string& name, const std::string& sum) {
  std::string escaped;
  for (const char c : name) escaped += c == '\\' ? "\\\\" : c == '\n' ? "\\n" : std::string(1, c);
  return (escaped == name ? "" : "\\") + sum + "  " + escaped + "\n";
}

struct NamedSum {
  std::string name, sum;  // empty for a damaged line
};

NamedSum parsedLine(std::string_view line) {
  const bool isEscaped = line.starts_with('\\');
  if (isEscaped) line.remove_prefix(1);
  const std::string_view sum = line.substr(0, kDigits);
  if (sum.size() < kDigits || sum.find_first_not_of("0123456789abcdef") != sum.npos ||
      line.substr(kDigits, 2) != "  ")
    return {};
  NamedSum parsed{{}, std::string(sum)};
  const std::string_view name = line.substr(kDigits + 2);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool isPair = isEscaped && name[i] == '\\' && i + 1 < name.size();
    if (isPair) ++i;
    parsed.name += isPair && name[i] == 'n' ? '\n' : name[i];
  }
  return isBelowFolder(parsed.name) ? parsed : NamedSum{};
}

// Returns the lines, damaged ones as empty names; nothing where there is no file.
std::vector<NamedSum> linesIn(const fs::path& out) {
  if (!isOwnFile(out, kSumsName)) return {};
  const std::string text = readFileBytes(out / kSumsName);
  std::vector<NamedSum> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const bool isWhole = end < text.size();
    lines.push_back(isWhole ? parsedLine(std::string_view(text).substr(at, end - at)) : NamedSum{});
    at = end + 1;
  }
  return lines;
}

// Whether a file of the journal's folder is of one of these objects: its name is the object's, a
// full stop, and more.
bool isOfObject(const std::string& name, const std::set<std::string>& folders) {
  for (std::size_t dot = name.find('.'); dot != name.npos; dot = name.find('.', dot + 1)) {
    if (folders.contains(name.substr(0, dot))) return true;
  }
  return false;
}

}  // namespace

OwnSums readOwnSums(const fs::path& out) {
  OwnSums sums;
  for (NamedSum& line : linesIn(out)) {
    if (!line.name.empty()) sums.emplace(std::move(line.name), std::move(line.sum));
  }
  return sums;
}

void removeOwnSums(const fs::path& out) { removeOwnFile(out, kSumsName); }

void writeOwnSums(const fs::path& out, const OwnSums& before,
                  const std::vector<const LibraryObject*>& written) {
  std::set<std::string> folders;
  for (const LibraryObject* object : written)
    folders.insert(std::string(kJournalFolder) + "/" + object->folder);
  std::string text;
  for (const std::string& name : ownFiles(out)) {
    const auto known = before.find(name);
    const bool isKept = known != before.end() &&
                        name.starts_with(kJournalFolder + std::string("/")) &&
                        !isOfObject(name, folders);
    text += lineOf(name, isKept ? known->second : sha256OfFile(out / name));
  }
  requireOwnFile(out, kSumsName);
  writeWhole(out / kSumsName, text);
}

std::vector<std::string> changedOwnFiles(const fs::path& out, bool absentToo) {
  if (!isOwnFile(out, kSumsName)) return {};
  const std::vector<NamedSum> lines = linesIn(out);
  std::vector<std::string> sentences;
  std::set<std::string> unlisted = ownFiles(out);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const NamedSum& line = lines[i];
    const bool isInOrder = i == 0 || lines[i - 1].name < line.name;
    if (line.name.empty() || !isInOrder) {
      sentences.push_back(std::string(kSumsName) + ":" + std::to_string(i + 1) + ": is damaged");
    } else if (!isOwnFile(out, line.name)) {
      if (absentToo) sentences.push_back(line.name + ": is absent, or a symbolic link leads there");
    } else if (sha256OfFile(out / line.name) != line.sum) {
      sentences.push_back(line.name + ": differs from what was written");
    }
    unlisted.erase(line.name);
  }
  for (const std::string& name : unlisted) sentences.push_back(name + ": is not in " + kSumsName);
  return sentences;
}

}  // namespace sherd
