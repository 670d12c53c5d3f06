// Text of USD layers.
#include "formats/usd/usd_text.h"

namespace sherd {
namespace {

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
