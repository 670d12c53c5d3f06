// Reads options from a TOML or JSON file.
#include "cli/arguments/config_file.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/files/parsed_json.h"
#include "base/input_error.h"
#include "base/text/lower_case.h"
#include "base/text/option_text.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Options = std::vector<ConfiguredOption>;
using Json = nlohmann::ordered_json;

/// Parser of the TOML subset that optionsIn() documents.
class Toml {
 public:
  Toml(fs::path file, std::string text) : file_(std::move(file)), text_(std::move(text)) {}

  Options options() {
    Options options;
    while (skipLines()) {
      if (peek() == '[') {
        while (!isAtLineEnd() && peek() != ']') ++at_;
        while (peek() == ']') ++at_;
      } else {
        options.push_back(option());
      }
      skipBlanks();
      if (!isAtLineEnd() && peek() != '#') refuse("has more than one value in a line");
    }
    return options;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::input, where() + ": " + what);
  }
  [[nodiscard]] std::string where() const { return file_.string() + ":" + std::to_string(line_); }

  [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  [[nodiscard]] bool isAtLineEnd() const {
    return at_ >= text_.size() || text_[at_] == '\n' || text_.substr(at_, 2) == "\r\n";
  }

  void skipBlanks() {
    while (peek() == ' ' || peek() == '\t') ++at_;
  }

  // Skips blanks, line ends and comments; returns false at the end of the text.
  bool skipLines() {
    for (;; ++at_) {
      skipBlanks();
      if (peek() == '#') at_ = std::min(text_.find('\n', at_), text_.size());
      if (at_ >= text_.size()) return false;
      if (!isAtLineEnd()) return true;
      if (peek() == '\r') ++at_;
      ++line_;
    }
  }

  std::string bare() {
    const std::size_t begin = at_;
    while (!isAtLineEnd() && std::string_view(" \t,]#=").find(peek()) == std::string_view::npos) {
      ++at_;
    }
    return text_.substr(begin, at_ - begin);
  }

  // "text" or 'text'
  std::string quoted() {
    const char quote = text_[at_++];
    if (text_.substr(at_, 2) == std::string(2, quote)) refuse("has text over several lines");
    std::string value;
    while (!isAtLineEnd() && peek() != quote) {
      if (quote == '"' && peek() == '\\') {
        ++at_;
        constexpr std::string_view kEscapes = "\"\\tn", kCharacters = "\"\\\t\n";
        const std::size_t which = isAtLineEnd() ? std::string_view::npos : kEscapes.find(peek());
        if (which == std::string_view::npos) {
          refuse("has a '\\' that is not one of \\\" \\\\ \\t \\n; write text in single quotes");
        }
        value += kCharacters[which];
        ++at_;
      } else {
        value += text_[at_++];
      }
    }
    if (isAtLineEnd()) refuse(std::string("has text without its closing ") + quote);
    ++at_;
    return value;
  }

  bool isQuote() const { return peek() == '"' || peek() == '\''; }

  // A text or a number.
  std::string value(const std::string& name) {
    const std::string text = isQuote() ? quoted() : bare();
    if (text.empty()) refuse(name + " has no value");
    if (text_[at_ - 1] == '"' || text_[at_ - 1] == '\'') return text;
    std::string digits = text;
    std::erase(digits, '_');
    if (digits.starts_with('+')) digits.erase(0, 1);
    if (!numberIn(digits)) {
      refuse(name + " is " + text + ", which is neither a number nor true or false; text needs " +
             "quotes");
    }
    return digits;
  }

  ConfiguredOption option() {
    ConfiguredOption option;
    option.name = isQuote() ? quoted() : bare();
    option.where = where() + ": " + option.name;
    skipBlanks();
    if (peek() != '=' || option.name.empty()) refuse("is not NAME = VALUE");
    ++at_;
    skipBlanks();
    if (peek() == '[') {
      option.values = list(option.name);
      return option;
    }
    const std::size_t begin = at_;
    const std::string word = isQuote() ? "" : bare();
    if (word == "true" || word == "false") {
      option.flag = word == "true";
    } else {
      at_ = begin;
      option.values = {value(option.name)};
    }
    return option;
  }

  std::vector<std::string> list(const std::string& name) {
    std::vector<std::string> values;
    ++at_;
    for (;;) {
      if (!skipLines()) refuse(name + " has a list without its closing ]");
      if (peek() == ']') break;
      values.push_back(value(name));
      if (!skipLines()) refuse(name + " has a list without its closing ]");
      if (peek() == ',') {
        ++at_;
      } else if (peek() != ']') {
        refuse(name + " has a list whose values are not separated by commas");
      }
    }
    ++at_;
    if (values.empty()) refuse(name + " has an empty list");
    return values;
  }

  fs::path file_;
  std::string text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

ConfiguredOption optionOf(const fs::path& file, const std::string& name, const Json& value) {
  ConfiguredOption option{name, file.string() + ": " + name, {}, {}};
  if (value.is_boolean()) {
    option.flag = value.get<bool>();
    return option;
  }
  for (const Json& one : value.is_array() ? value : Json::array({value})) {
    if (!one.is_string() && !one.is_number()) {
      inputError(file, "has no value for " + name + ": text, a number, true, false or a list");
    }
    option.values.push_back(one.is_string() ? one.get<std::string>() : one.dump());
  }
  const bool isEmpty = std::any_of(option.values.begin(), option.values.end(),
                                   [](const std::string& text) { return text.empty(); });
  if (isEmpty || option.values.empty()) inputError(file, "has an empty value for " + name);
  return option;
}

Options jsonOptions(const fs::path& file, const std::string& bytes) {
  Options options;
  try {
    const Json json = parsedOrderedJson(bytes);
    if (!json.is_object()) inputError(file, "is not a JSON object of options");
    for (const auto& [name, value] : json.items()) options.push_back(optionOf(file, name, value));
  } catch (const Error& e) {
    if (std::string_view(e.what()).starts_with(file.string())) throw;
    inputError(file, std::string(e.what()) + "; expected a JSON object of options", e.options());
  }
  // The parser silently keeps one of several equal names.
  std::set<std::string> names;
  [[maybe_unused]] const Json again =
      Json::parse(bytes, [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::key && depth == 1 &&
            !names.insert(parsed.get<std::string>()).second) {
          inputError(file, "has " + parsed.get<std::string>() + " twice");
        }
        return true;
      });
  return options;
}

Options tomlOptions(const fs::path& file, std::string bytes) {
  Options options = Toml(file, std::move(bytes)).options();
  std::map<std::string_view, const ConfiguredOption*> first;
  for (const ConfiguredOption& option : options) {
    const auto [before, isFirst] = first.emplace(option.name, &option);
    if (isFirst) continue;
    throw Error(ErrorCode::input,
                option.where + " is set twice; first at " + before->second->where);
  }
  return options;
}

}  // namespace

Options optionsIn(const fs::path& file) { return parsedOptions(readFileBytes(file), file); }

Options parsedOptions(std::string bytes, const fs::path& file) {
  const bool isJson = lowerCase(file.extension().string()) == ".json";
  return isJson ? jsonOptions(file, bytes) : tomlOptions(file, std::move(bytes));
}

}  // namespace sherd::cli
