// Text of USD layers.
#pragma once

#include <sherd/files.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/number_text.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// Returns text as a string of a layer, in quotes.
[[nodiscard]] std::string usdString(std::string_view text);

/// Returns the path of a file as an asset of a layer, between '@'.
[[nodiscard]] std::string usdAsset(std::string_view path);

/// Text that is passed to a sink in blocks.
class UsdText {
 public:
  explicit UsdText(const ByteSink& sink) : sink_(sink) {}

  /// Begins a prim, with its metadata in parentheses, and ends it.
  void open(std::string_view specifierAndType, std::string_view name,
            std::string_view metadata = {});
  void close();

  /// Adds a line at the depth of the open prims.
  void line(std::string_view text);

  /// Adds "TYPE NAME = [value, ...]".
  template <class Values, class Append>
  void array(std::string_view declaration, const Values& values, const Append& append,
             std::string_view metadata = {}) {
    indent();
    text_ += declaration;
    text_ += " = [";
    bool first = true;
    for (const auto& value : values) {
      if (!first) text_ += ", ";
      first = false;
      append(text_, value);
      flush(kBlock);
    }
    text_ += ']';
    if (!metadata.empty()) (text_ += " (") += std::string(metadata) + ")";
    text_ += '\n';
  }

  void finish() { flush(0); }

 private:
  static constexpr std::size_t kBlock = 1 << 16;

  void indent() { text_.append(2 * depth_, ' '); }
  void flush(std::size_t most) {
    if (text_.size() <= most) return;
    sink_(text_);
    text_.clear();
  }

  const ByteSink& sink_;
  std::string text_;
  std::size_t depth_ = 0;
};

/// Returns "DECLARATION = value" in double or single precision.
[[nodiscard]] std::string usdNumber(std::string_view declaration, double value);
[[nodiscard]] std::string usdNumber(std::string_view declaration, float value);

/// Returns "(x, y, z)" in double or single precision.
[[nodiscard]] std::string usdVector(const glm::dvec3& v);
[[nodiscard]] std::string usdVector(const glm::vec3& v);

/// Returns "(w, x, y, z)" in single precision.
[[nodiscard]] std::string usdRotation(const glm::dquat& q);

}  // namespace sherd
