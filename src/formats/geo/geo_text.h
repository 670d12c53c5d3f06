// Text of Houdini's geometry, `.geo` in JSON.
#pragma once

#include <sherd/files.h>
#include <sherd/progress.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "base/cancel_flag.h"
#include "base/text/number_text.h"

namespace sherd {

/// Numbers of points, vertices (corners of primitives) and primitives.
struct GeoCounts {
  std::uint64_t points = 0, vertices = 0, primitives = 0;
};

/// The name and type of a numeric attribute.
struct GeoAttribute {
  std::string_view name;
  int size = 1;                ///< numbers of each element
  bool isWhole = false;        ///< int32, else fpreal32
  std::string_view meaning{};  ///< how transforms change it, e.g. "point"; empty: not at all
};

/// A detail, passed to a sink in blocks.  Parts come in the order of these functions: points of
/// vertices, attributes of vertices, points and primitives, primitives, groups.  Elements of lists
/// are generated: generate(add) calls add(append) for each, and append(text) writes it.
///   source  files that Houdini 21 saves; $HFS/houdini/public/hgeo
class GeoText {
 public:
  GeoText(const ByteSink& sink, const Progress* progress) : sink_(sink), progress_(progress) {}

  void begin(const GeoCounts& counts);

  template <class Generate>
  void pointsOfVertices(const Generate& generate) {
    text_ += "\"topology\",[\"pointref\",[\"indices\",";
    list(generate);
    text_ += "]],\n\"attributes\",[";
  }

  /// Begins and ends the attributes of a class: "vertexattributes" and so on.
  void openAttributes(std::string_view owner);
  void closeAttributes() { text_ += ']'; }

  /// Adds a numeric attribute; an element of more than one number is "[x,y,z]".
  template <class Generate>
  void attribute(const GeoAttribute& attribute, const Generate& generate) {
    beginAttribute(attribute);
    if (attribute.size == 1) text_ += '[';
    list(generate);
    text_ += attribute.size == 1 ? "]]]]" : "]]]";
  }

  /// Adds an attribute of strings.
  ///   strings  generates the strings, without quotes; they need no escapes
  ///   indices  generates the number of each element's
  template <class Strings, class Indices>
  void strings(std::string_view name, const Strings& strings, const Indices& indices) {
    beginStrings(name);
    list([&](const auto& add) {
      strings([&](const auto& append) {
        add([&](std::string& to) {
          to += '"';
          append(to);
          to += '"';
        });
      });
    });
    text_ += ",\"indices\",[\"size\",1,\"storage\",\"int32\",\"arrays\",[";
    list(indices);
    text_ += "]]]]";
  }

  /// Ends attributes and adds all primitives, with the same number of vertices each.
  ///   isClosed  polygons, else polylines
  void primitives(std::uint64_t count, int vertices, bool isClosed);

  /// Adds groups of primitives.
  ///   generate  for each primitive whether it is in the group
  void openGroups();
  template <class Generate>
  void group(std::string_view name, const Generate& generate) {
    beginGroup(name);
    list([&](const auto& add) {
      generate([&](bool isIn) { add([=](std::string& to) { to += isIn ? '1' : '0'; }); });
    });
    text_ += "]]]]";
  }
  void closeGroups() { text_ += ']'; }

  void finish();

 private:
  static constexpr std::size_t kBlock = 1 << 16;

  void beginAttribute(const GeoAttribute& attribute);
  void beginStrings(std::string_view name);
  void beginGroup(std::string_view name);
  void separate();  // an attribute or group from the one before

  template <class Generate>
  void list(const Generate& generate) {
    text_ += '[';
    bool isFirst = true;
    generate([&](const auto& append) {
      if (!isFirst) text_ += ',';
      isFirst = false;
      append(text_);
      flush(kBlock);
    });
    text_ += ']';
  }

  void flush(std::size_t most) {
    if (text_.size() <= most) return;
    throwIfCancelled(progress_);
    sink_(text_);
    text_.clear();
  }

  const ByteSink& sink_;
  const Progress* progress_;
  std::string text_;
  bool hasAttributes_ = false;  // of a class
  bool isFirst_ = true;         // the next attribute or group is
};

/// Appends "[x,y,z]" in single precision.
template <class Vector>
void appendTuple(std::string& text, const Vector& v) {
  for (int axis = 0; axis < 3; ++axis) {
    text += axis == 0 ? '[' : ',';
    appendFloat(text, static_cast<float>(v[axis]));
  }
  text += ']';
}

}  // namespace sherd
