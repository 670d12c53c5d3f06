// Text of USD layers.
#include "formats/mesh/usd_text.h"

#include <set>

namespace sherd {
namespace {

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

template <class Number, class Vector>
std::string vectorText(const Vector& v) {
  std::string text = "(";
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += ", ";
    appendShortest(text, static_cast<Number>(v[axis]) + Number{0});
  }
  return text + ")";
}

}  // namespace

std::string usdName(std::string_view text) {
  std::string name;
  for (const char c : text) name += isLetter(c) || isDigit(c) ? c : '_';
  return name.empty() || isDigit(name.front()) ? "_" + name : name;
}

std::vector<std::string> usdNames(const MaterialTable& table) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const MaterialTable::Entry& entry : table.materials) {
    const std::string name = usdName(entry.name);
    std::string unique = name;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = name + "_" + std::to_string(i);
    names.push_back(std::move(unique));
  }
  return names;
}

std::string usdString(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      (quoted += '\\') += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      ((quoted += "\\x") += kHex[byte >> 4]) += kHex[byte & 15];
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string usdAsset(std::string_view path) {
  if (path.find('@') == std::string_view::npos) return "@" + std::string(path) + "@";
  std::string quoted = "@@@";
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path.substr(i, 3) == "@@@") {
      quoted += "\\@@@";
      i += 2;
    } else {
      quoted += path[i];
    }
  }
  return quoted + "@@@";
}

void UsdText::open(std::string_view specifierAndType, std::string_view name,
                   std::string_view metadata) {
  indent();
  ((text_ += specifierAndType) += " \"") += name;
  text_ += '"';
  if (!metadata.empty()) ((text_ += " (") += metadata) += ')';
  text_ += '\n';
  indent();
  text_ += "{\n";
  ++depth_;
}

void UsdText::close() {
  --depth_;
  indent();
  text_ += "}\n";
  flush(kBlock);
}

void UsdText::line(std::string_view text) {
  indent();
  (text_ += text) += '\n';
}

std::string usdNumber(std::string_view declaration, double value) {
  std::string text = std::string(declaration) + " = ";
  appendShortest(text, value);
  return text;
}

std::string usdNumber(std::string_view declaration, float value) {
  std::string text = std::string(declaration) + " = ";
  appendFloat(text, value);
  return text;
}

std::string usdVector(const glm::dvec3& v) { return vectorText<double>(v); }
std::string usdVector(const glm::vec3& v) { return vectorText<float>(v); }

std::string usdRotation(const glm::dquat& q) {
  std::string text = "(";
  for (const double x : {q.w, q.x, q.y, q.z}) {
    if (text.size() > 1) text += ", ";
    appendFloat(text, static_cast<float>(x));
  }
  return text + ")";
}

}  // namespace sherd
