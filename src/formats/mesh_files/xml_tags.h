// The tags of an XML text, one after another.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sherd {

/// A start tag or an end tag.
struct XmlTag {
  std::string_view name;  ///< without a prefix: "color" of <m:color>
  bool isEnd = false;     ///< </name>
  bool isEmpty = false;   ///< <name/>
  std::vector<std::pair<std::string_view, std::string_view>> attributes;  ///< not decoded

  /// Returns the text of an attribute by its whole name, empty if it is absent; entities are not
  /// decoded: for numbers and colors.
  [[nodiscard]] std::string_view operator[](std::string_view attribute) const;
  [[nodiscard]] bool has(std::string_view attribute) const;

  /// Returns that of the first attribute of any prefix: "p:path" for "path".
  [[nodiscard]] std::string_view ofAnyPrefix(std::string_view attribute) const;
};

/// Tags between two checks for cancellation.
inline constexpr std::size_t kTagsAtATime = 4096;

/// Returns text with the five named entities and numbered ones decoded; unknown ones stay.
[[nodiscard]] std::string xmlDecoded(std::string_view text);

/// Iterates over tags.  Text, comments, CDATA, processing instructions and declarations are left
/// out; entities that a document declares are not known, so that none can grow.
class XmlTags {
 public:
  ///   text  UTF-8, outlives this object and its tags
  explicit XmlTags(std::string_view text) : text_(text) {}

  /// Moves to the next tag.
  ///   return  false after the last
  ///   throws  std::runtime_error with a clause: the text ends within a tag, or a tag is malformed
  bool next(XmlTag& tag);

 private:
  void skipTo(std::string_view end);
  void readAttributes(XmlTag& tag, std::string_view content);

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace sherd
