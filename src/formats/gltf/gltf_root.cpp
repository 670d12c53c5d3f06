// The root node of our glTF files, by which coordinates of the input are glTF's: meters, y up.
#include "formats/gltf/gltf_root.h"

#include <cmath>
#include <string>

#include "mesh/coordinate_system.h"

namespace sherd {
namespace {

using OrderedJson = nlohmann::ordered_json;

// Takes the upward axis to y: a quarter of a rotation about x, or a third of one about all axes.
OrderedJson rotationOf(char up) {
  const double half = std::sqrt(0.5);
  if (up == 'z') return {-half, 0.0, 0.0, half};
  return {0.5, 0.5, 0.5, 0.5};
}

}  // namespace

bool isOfGltf(const CoordinateSystem& coordinates) {
  return coordinates.metersPerUnit == 1.0 && coordinates.up == 'y';
}

OrderedJson rootTransform(const CoordinateSystem& coordinates) {
  OrderedJson node = OrderedJson::object();
  if (coordinates.up != 'y') node["rotation"] = rotationOf(coordinates.up);
  const double m = coordinates.metersPerUnit;
  if (m != 1.0) node["scale"] = {m, m, m};
  return node;
}

OrderedJson assetExtras(const CoordinateSystem& coordinates) {
  return {
      {"sherd",
       {{"meters_per_unit", coordinates.metersPerUnit}, {"up", std::string(1, coordinates.up)}}}};
}

std::optional<CoordinateSystem> coordinatesBelow(const nlohmann::json& asset,
                                                 const nlohmann::json& root) {
  const auto memberOf = [](const nlohmann::json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return found != object.end() ? *found : nlohmann::json();
  };
  const nlohmann::json said = memberOf(memberOf(asset, "extras"), "sherd");
  const nlohmann::json meters = memberOf(said, "meters_per_unit"), up = memberOf(said, "up");
  if (!meters.is_number() || (up != "x" && up != "y" && up != "z")) return {};
  CoordinateSystem coordinates{meters.get<double>(), up.get<std::string>().front(),
                               CoordinateBasis::file, CoordinateBasis::file};
  if (!isUnit(coordinates.metersPerUnit)) return {};
  const OrderedJson expected = rootTransform(coordinates);
  for (const char* key : {"matrix", "translation", "rotation", "scale"}) {
    const nlohmann::json of =
        expected.contains(key) ? nlohmann::json(expected[key]) : nlohmann::json();
    if (memberOf(root, key) != of) return {};
  }
  return coordinates;
}

}  // namespace sherd
