// Writes SVG.
#pragma once

#include <string>

namespace sherd::chart {

/// Escapes text for XML and HTML.  Replaces control characters, which XML forbids, by '?'.
[[nodiscard]] std::string escapedXml(const std::string& words);

/// An SVG image.  Later shapes cover earlier ones; lengths in pixels, y downwards.
class Svg {
 public:
  enum class Anchor { start, middle, end };

  Svg(double width, double height);

  void rect(double x, double y, double width, double height, const std::string& fill);
  void line(double x1, double y1, double x2, double y2, const std::string& stroke,
            bool dashed = false);
  void circle(double x, double y, double radius, const std::string& fill);
  /// Adds text; y is the baseline.
  void text(double x, double y, const std::string& words, double size, const std::string& fill,
            Anchor anchor = Anchor::start, bool bold = false);

  [[nodiscard]] std::string done() const { return body_ + "</svg>\n"; }

 private:
  std::string body_;
};

}  // namespace sherd::chart
