// A drawing as SVG text.
#pragma once

#include <string>

namespace sherd::chart {

/// Words as text of XML or HTML.  Names of files may hold anything; control characters are not XML.
[[nodiscard]] std::string escapedXml(const std::string& words);

/// Shapes one over another, lengths in pixels, y downwards.
class Svg {
 public:
  enum class Anchor { start, middle, end };

  Svg(double width, double height);

  void rect(double x, double y, double width, double height, const std::string& fill);
  void line(double x1, double y1, double x2, double y2, const std::string& stroke,
            bool dashed = false);
  void circle(double x, double y, double radius, const std::string& fill);
  /// y is the base line's.
  void text(double x, double y, const std::string& words, double size, const std::string& fill,
            Anchor anchor = Anchor::start, bool bold = false);

  [[nodiscard]] std::string done() const { return body_ + "</svg>\n"; }

 private:
  std::string body_;
};

}  // namespace sherd::chart
