// Writes SVG.
#include "chart/svg.h"

#include "base/text/formatted.h"

namespace sherd::chart {
namespace {

// Hundredths of a pixel.
std::string number(double value) { return formatted("%.2f", value); }

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

}  // namespace

std::string escapedXml(const std::string& words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    }
  }
  return text;
}

Svg::Svg(double width, double height) {
  body_ = "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", number(width)) +
          attribute("height", number(height)) +
          attribute("viewBox", "0 0 " + number(width) + " " + number(height)) +
          " font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n";
  rect(0, 0, width, height, "#ffffff");
}

void Svg::rect(double x, double y, double width, double height, const std::string& fill) {
  body_ += "<rect" + attribute("x", number(x)) + attribute("y", number(y)) +
           attribute("width", number(width)) + attribute("height", number(height)) +
           attribute("fill", fill) + "/>\n";
}

void Svg::line(double x1, double y1, double x2, double y2, const std::string& stroke, bool dashed) {
  body_ += "<line" + attribute("x1", number(x1)) + attribute("y1", number(y1)) +
           attribute("x2", number(x2)) + attribute("y2", number(y2)) + attribute("stroke", stroke) +
           (dashed ? attribute("stroke-dasharray", "4 3") : "") + "/>\n";
}

void Svg::circle(double x, double y, double radius, const std::string& fill) {
  body_ += "<circle" + attribute("cx", number(x)) + attribute("cy", number(y)) +
           attribute("r", number(radius)) + attribute("fill", fill) + "/>\n";
}

void Svg::text(double x, double y, const std::string& words, double size, const std::string& fill,
               Anchor anchor, bool bold) {
  body_ += "<text" + attribute("x", number(x)) + attribute("y", number(y)) +
           attribute("font-size", number(size)) + attribute("fill", fill) +
           (anchor == Anchor::start
                ? ""
                : attribute("text-anchor", anchor == Anchor::middle ? "middle" : "end")) +
           (bold ? attribute("font-weight", "bold") : "") + ">" + escapedXml(words) + "</text>\n";
}

}  // namespace sherd::chart
