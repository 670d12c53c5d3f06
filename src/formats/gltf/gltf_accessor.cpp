// The arrays of a glTF file.
#include "formats/gltf/gltf_accessor.h"

#include <algorithm>
#include <bit>
#include <string>

#include "base/little_endian.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

enum ComponentType : std::size_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126
};

double load(const char* at, std::size_t type) {
  switch (type) {
    case int8:
      return static_cast<std::int8_t>(*at);
    case uint8:
      return static_cast<unsigned char>(*at);
    case int16:
      return static_cast<std::int16_t>(loadLittle<std::uint16_t>(at));
    case uint16:
      return loadLittle<std::uint16_t>(at);
    case uint32:
      return loadLittle<std::uint32_t>(at);
    default:
      return std::bit_cast<float>(loadLittle<std::uint32_t>(at));
  }
}

// Returns the bytes of a sparse part, which GltfDocument does not check against its view.
std::string_view packed(const GltfDocument& document, const Json& part, std::size_t count,
                        std::size_t elementBytes) {
  const std::string_view view = document.bufferView(document.number(part, "bufferView"));
  const std::size_t from = document.number(part, "byteOffset");
  if (from > view.size() || (view.size() - from) / elementBytes < count)
    throw document.bad("a sparse accessor reaches beyond its buffer view");
  return view.substr(from);
}

void setSparse(const GltfDocument& document, const Json& accessor, GltfArray& array) {
  const Json& sparse = GltfDocument::member(accessor, "sparse");
  const Json& indices = GltfDocument::member(sparse, "indices");
  const Json& values = GltfDocument::member(sparse, "values");
  const std::size_t count = document.number(sparse, "count");
  const std::size_t indexType = document.number(indices, "componentType");
  const std::size_t indexBytes = document.componentBytes(indices);
  const std::size_t type = document.number(accessor, "componentType");
  const std::size_t bytes = document.componentBytes(accessor);
  const std::string_view at = packed(document, indices, count, indexBytes);
  const std::string_view from = packed(document, values, count, bytes * array.components);
  for (std::size_t i = 0; i < count; ++i) {
    const double index = load(at.data() + i * indexBytes, indexType);
    if (!(index >= 0.0 && index < static_cast<double>(array.count)))
      throw document.bad("a sparse accessor sets an element that it does not have");
    const std::size_t first = static_cast<std::size_t>(index) * array.components;
    for (std::size_t k = 0; k < array.components; ++k) {
      array.values[first + k] = load(from.data() + (i * array.components + k) * bytes, type);
    }
  }
}

}  // namespace

double normalized(double value, std::size_t componentType) {
  switch (componentType) {
    case int8:
      return std::max(value / 127.0, -1.0);
    case uint8:
      return value / 255.0;
    case int16:
      return std::max(value / 32767.0, -1.0);
    case uint16:
      return value / 65535.0;
    default:
      return value;
  }
}

GltfArray readGltfArray(const GltfDocument& document, std::size_t index) {
  const Json& accessor = document.at("accessors", index);
  const std::size_t type = document.number(accessor, "componentType");
  const std::size_t bytes = document.componentBytes(accessor);
  GltfArray out{document.number(accessor, "count"), document.components(accessor), {}};
  const std::size_t element = bytes * out.components;
  const bool hasData = accessor.contains("bufferView");
  if (!hasData && out.count > document.bytes()) {  // all zeros: no data limits their number
    throw document.bad("accessor " + std::to_string(index) + " announces " +
                       std::to_string(out.count) + " elements without data");
  }
  charge(document.file(), out.count, out.components * sizeof(double));
  out.values.resize(out.count * out.components);
  if (hasData && out.count > 0) {
    const std::size_t view = document.number(accessor, "bufferView");
    const std::string_view from =
        document.bufferView(view).substr(document.number(accessor, "byteOffset"));
    const std::size_t stride =
        std::max(document.number(document.at("bufferViews", view), "byteStride"), element);
    for (std::size_t i = 0; i < out.count; ++i) {
      for (std::size_t k = 0; k < out.components; ++k) {
        out.values[i * out.components + k] = load(from.data() + i * stride + k * bytes, type);
      }
    }
  }
  if (accessor.contains("sparse")) setSparse(document, accessor, out);
  if (accessor.value("normalized", Json()) == true) {
    for (double& value : out.values) value = normalized(value, type);
  }
  return out;
}

}  // namespace sherd
