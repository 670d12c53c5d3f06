// Lines, words and numbers of a text in memory.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace sherd {

inline bool isBlank(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

/// Removes the byte order mark that some programs write before UTF-8.
inline std::string_view withoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

/// Whether a text has only blanks.
inline bool isBlank(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return isBlank(c); });
}

/// Replaces all but printable ASCII by '?', for text from files in messages.
inline std::string plainText(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return out;
}

/// Returns the first 40 characters in quotes, for text from files in messages.
inline std::string inQuotes(std::string_view text) {
  return std::string(1, '\'').append(plainText(text.substr(0, 40))).append(1, '\'');
}

/// Removes the first word of a line and returns it; empty at the line's end.
inline std::string_view takeWord(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && isBlank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !isBlank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Removes leading and trailing blanks.
inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// Returns the number of words in a line.
inline std::size_t countWords(std::string_view line) {
  std::size_t count = 0;
  while (!takeWord(line).empty()) ++count;
  return count;
}

/// Parses a word as an integer.
template <class Integer>
std::optional<Integer> parseInteger(std::string_view word) {
  Integer value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Parses a word as a number; infinity if it is too large for a double.
inline std::optional<double> parseReal(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range)
    return std::strtod(std::string(word).c_str(), nullptr);
  return value;
}

/// Whether a word is a number, including "nan", "inf" and numbers beyond the range of double.
inline bool isNumber(std::string_view word) { return parseReal(word).has_value(); }

/// Removes `count` words from a line; returns whether all are numbers.
inline bool takeNumbers(std::string_view& line, int count) {
  for (int i = 0; i < count; ++i)
    if (!isNumber(takeWord(line))) return false;
  return true;
}

/// Iterates over the lines of a text, which end with '\n', "\r\n" or '\r'.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  /// Moves to the next line; returns false after the last.
  bool next() {
    if (position_ >= text_.size()) return false;
    std::size_t end = position_;
    while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') ++end;
    line_ = text_.substr(position_, end - position_);
    position_ = std::min(text_.size(), end + (text_.substr(end, 2) == "\r\n" ? 2 : 1));
    ++number_;
    return true;
  }

  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }      ///< of the line, from 1
  std::size_t position() const { return position_; }  ///< byte offset after the line's end

 private:
  std::string_view text_, line_;
  std::size_t position_ = 0, number_ = 0;
};

/// Moves to the next line that is not blank before a '#'; returns false after the last.
inline bool nextDataLine(LineReader& lines, std::string_view& line) {
  while (lines.next()) {
    line = lines.line().substr(0, lines.line().find('#'));
    if (!isBlank(line)) return true;
  }
  return false;
}

}  // namespace sherd
