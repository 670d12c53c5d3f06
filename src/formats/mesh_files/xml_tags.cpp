// The tags of an XML text.
#include "formats/mesh_files/xml_tags.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

#include "base/text/text_scan.h"

namespace sherd {
namespace {

// Of a tag; formats have a dozen.  More would take many times the memory of their text.
constexpr std::size_t kMostAttributes = 1000;

[[noreturn]] void malformed(const std::string& what) { throw std::runtime_error(what); }

// Appends a character of Unicode as UTF-8.
void appendUtf8(std::string& text, std::uint32_t c) {
  const auto tail = [&](int shift) {
    text += static_cast<char>(0x80U | ((c >> static_cast<unsigned>(shift)) & 0x3fU));
  };
  if (c < 0x80U) {
    text += static_cast<char>(c);
  } else if (c < 0x800U) {
    text += static_cast<char>(0xc0U | (c >> 6U));
    tail(0);
  } else if (c < 0x10000U) {
    text += static_cast<char>(0xe0U | (c >> 12U));
    tail(6);
    tail(0);
  } else {
    text += static_cast<char>(0xf0U | (c >> 18U));
    tail(12);
    tail(6);
    tail(0);
  }
}

std::optional<std::uint32_t> numberOf(std::string_view entity) {
  if (!entity.starts_with('#')) return {};
  entity.remove_prefix(1);
  const bool isHex = entity.starts_with('x');
  if (isHex) entity.remove_prefix(1);
  std::uint32_t value = 0;
  const auto [end, error] =
      std::from_chars(entity.data(), entity.data() + entity.size(), value, isHex ? 16 : 10);
  const bool isCharacter = value > 0 && value < 0x110000U && (value < 0xd800U || value > 0xdfffU);
  if (error != std::errc() || end != entity.data() + entity.size() || !isCharacter) return {};
  return value;
}

}  // namespace

std::string_view XmlTag::operator[](std::string_view attribute) const {
  for (const auto& [key, value] : attributes) {
    if (key == attribute) return value;
  }
  return {};
}

bool XmlTag::has(std::string_view attribute) const {
  return std::any_of(attributes.begin(), attributes.end(),
                     [&](const auto& one) { return one.first == attribute; });
}

std::string_view XmlTag::ofAnyPrefix(std::string_view attribute) const {
  for (const auto& [key, value] : attributes) {
    if (key.substr(key.find(':') + 1) == attribute) return value;
  }
  return {};
}

std::string xmlDecoded(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kNamed{
      {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}}};
  constexpr std::size_t kLongest = 10;
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t end = text[i] == '&' ? text.substr(0, i + kLongest).find(';', i) : text.npos;
    if (end == text.npos) {
      out += text[i];
      continue;
    }
    const std::string_view entity = text.substr(i + 1, end - i - 1);
    const auto named = std::find_if(kNamed.begin(), kNamed.end(),
                                    [&](const auto& one) { return one.first == entity; });
    const std::optional<std::uint32_t> number = numberOf(entity);
    if (named == kNamed.end() && !number) {
      out += text[i];
      continue;
    }
    if (number) {
      appendUtf8(out, *number);
    } else {
      out += named->second;
    }
    i = end;
  }
  return out;
}

void XmlTags::skipTo(std::string_view end) {
  const std::size_t found = text_.find(end, at_);
  if (found == text_.npos) malformed("ends before " + inQuotes(end));
  at_ = found + end.size();
}

void XmlTags::readAttributes(XmlTag& tag, std::string_view content) {
  for (;;) {
    content = trimmed(content);
    if (content.empty()) return;
    const std::size_t equals = content.find('=');
    const std::string_view name = trimmed(content.substr(0, equals));
    if (equals == content.npos)
      malformed("has an attribute " + inQuotes(name) + " without a value");
    content = trimmed(content.substr(equals + 1));
    const char quote = content.empty() ? '\0' : content.front();
    const std::size_t end =
        quote == '"' || quote == '\'' ? content.find(quote, 1) : std::string_view::npos;
    if (end == content.npos) malformed("has an attribute " + inQuotes(name) + " without quotes");
    if (tag.attributes.size() == kMostAttributes)
      malformed("has a tag of more than " + std::to_string(kMostAttributes) + " attributes");
    tag.attributes.emplace_back(name, content.substr(1, end - 1));
    content.remove_prefix(end + 1);
  }
}

bool XmlTags::next(XmlTag& tag) {
  for (;;) {
    at_ = text_.find('<', at_);
    if (at_ == text_.npos) return false;
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("<!--")) {
      at_ += 4;
      skipTo("-->");
    } else if (rest.starts_with("<![CDATA[")) {
      skipTo("]]>");
    } else if (rest.starts_with("<?")) {
      skipTo("?>");
    } else if (rest.starts_with("<!")) {
      skipTo(">");  // of a document type; what it declares within brackets is malformed next
    } else {
      break;
    }
  }
  std::size_t end = ++at_;
  for (char quote = '\0'; end < text_.size(); ++end) {  // '>' may stand in an attribute
    const char c = text_[end];
    if (quote == '\0' && c == '>') break;
    if (quote == '\0' && c == '<') malformed("has a tag within a tag");
    if (c == quote) {
      quote = '\0';
    } else if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    }
  }
  if (end == text_.size()) malformed("ends within a tag");
  std::string_view content = text_.substr(at_, end - at_);
  at_ = end + 1;
  tag.isEnd = content.starts_with('/');
  if (tag.isEnd) content.remove_prefix(1);
  tag.isEmpty = content.ends_with('/');
  if (tag.isEmpty) content.remove_suffix(1);
  tag.name = takeWord(content);
  tag.name = tag.name.substr(tag.name.find(':') + 1);
  if (tag.name.empty()) malformed("has a tag without a name");
  tag.attributes.clear();
  readAttributes(tag, content);
  return true;
}

}  // namespace sherd
