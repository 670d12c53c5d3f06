// Text of Houdini's geometry, `.geo` in JSON.
#include "formats/geo/geo_text.h"

#include "base/version.h"

namespace sherd {
namespace {

// The oldest version of Houdini whose files are known to have runs of polygons and of polylines.
constexpr std::string_view kFileVersion = "20.0.0";

}  // namespace

void GeoText::begin(const GeoCounts& counts) {
  (text_ += "[\"fileversion\",\"") += kFileVersion;
  appendShortest(text_ += "\",\"hasindex\",false,\"pointcount\",", counts.points);
  appendShortest(text_ += ",\"vertexcount\",", counts.vertices);
  appendShortest(text_ += ",\"primitivecount\",", counts.primitives);
  text_ += ",\n\"info\",{\"software\":\"Sherd " SHERD_VERSION "\"},\n";
}

void GeoText::separate() {
  text_ += isFirst_ ? "\n" : ",\n";
  isFirst_ = false;
}

void GeoText::openAttributes(std::string_view owner) {
  if (hasAttributes_) text_ += ',';
  hasAttributes_ = isFirst_ = true;
  ((text_ += "\n\"") += owner) += "\",[";
}

void GeoText::beginAttribute(const GeoAttribute& attribute) {
  separate();
  ((text_ += "[[\"scope\",\"public\",\"type\",\"numeric\",\"name\",\"") += attribute.name) +=
      "\",\"options\",{";
  if (!attribute.meaning.empty()) {
    ((text_ += "\"type\":{\"type\":\"string\",\"value\":\"") += attribute.meaning) += "\"}";
  }
  const std::string_view storage = attribute.isWhole ? "int32" : "fpreal32";
  const auto sized = [&] {
    appendShortest(text_ += "[\"size\",", attribute.size);
    ((text_ += ",\"storage\",\"") += storage) += "\",";
  };
  text_ += "}],\n ";
  sized();
  text_ += attribute.isWhole
               ? "\"defaults\",[\"size\",1,\"storage\",\"int64\",\"values\",[0]],\"values\","
               : "\"defaults\",[\"size\",1,\"storage\",\"fpreal64\",\"values\",[0]],\"values\",";
  sized();
  text_ += attribute.size == 1 ? "\"arrays\"," : "\"tuples\",";
}

void GeoText::beginStrings(std::string_view name) {
  separate();
  ((text_ += "[[\"scope\",\"public\",\"type\",\"string\",\"name\",\"") += name) +=
      "\",\"options\",{}],\n [\"size\",1,\"storage\",\"int32\",\"strings\",";
}

void GeoText::primitives(std::uint64_t count, int vertices, bool isClosed) {
  text_ += "],\n\"primitives\",[";
  if (count > 0) {
    text_ += isClosed ? "[[\"type\",\"Polygon_run\"]" : "[[\"type\",\"PolygonCurve_run\"]";
    appendShortest(text_ += ",[\"startvertex\",0,\"nprimitives\",", count);
    appendShortest(text_ += ",\"nvertices_rle\",[", vertices);
    appendShortest(text_ += ',', count);
    text_ += "]]]";
  }
  text_ += ']';
}

void GeoText::openGroups() {
  isFirst_ = true;
  text_ += ",\n\"primitivegroups\",[";
}

void GeoText::beginGroup(std::string_view name) {
  separate();
  ((text_ += "[[\"name\",\"") += name) += "\"],[\"selection\",[\"unordered\",[\"i8\",";
}

void GeoText::finish() {
  text_ += "\n]\n";
  flush(0);
}

}  // namespace sherd
