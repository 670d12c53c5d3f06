// Prints what HouIO reads of a .geo file as JSON: geo_dump FILE.  Compiled by geo.py.
#include <houio/GeometryIO.h>

#include <cstdio>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

namespace {

using Adapter = houio::HouGeoAdapter;
using Attribute = Adapter::AttributeAdapter;

template <class Item, class Print>
void list(const std::vector<Item>& items, const Print& print) {
  std::printf("[");
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) std::printf(",");
    print(items[i]);
  }
  std::printf("]");
}

// Names of what Sherd writes need no escapes.
void key(const std::string& name, bool isFirst) {
  std::printf("%s\"%s\":", isFirst ? "" : ",", name.c_str());
}

void attribute(const Attribute& own) {
  const std::size_t size = own.tupleSize().asSize();
  const std::size_t count = static_cast<std::size_t>(own.elementCount());
  std::printf("{\"size\":%zu,\"values\":[", size);
  const auto data = own.rawData();
  for (std::size_t i = 0; i < count * size; ++i) {
    if (i > 0) std::printf(",");
    if (own.type() == Attribute::Type::string) {
      std::printf("\"%s\"", own.stringValue(static_cast<int>(i)).c_str());
    } else if (own.storage() == Attribute::Storage::int32) {
      std::printf("%d", data.read<int>(i));
    } else {
      std::printf("%.9g", static_cast<double>(data.read<float>(i)));
    }
  }
  std::printf("]}");
}

template <class Of>
void attributes(const char* owner, const std::vector<std::string>& names, const Of& of) {
  std::printf(",\"%s\":{", owner);
  for (const std::string& name : names) {
    key(name, &name == &names.front());
    attribute(*of(name));
  }
  std::printf("}");
}

void primitives(const Adapter& geo) {
  std::printf(",\"primitives\":[");
  bool isFirst = true;
  for (const auto& primitive : geo.primitives()) {
    const auto polygons = std::dynamic_pointer_cast<const Adapter::PolyPrimitive>(primitive);
    if (!polygons) throw std::runtime_error("a primitive is no polygon");
    for (int i = 0; i < polygons->polygonCount(); ++i) {
      const auto points = polygons->polygonVertexIndices(i);
      std::printf("%s{\"closed\":%s,\"points\":", isFirst ? "" : ",",
                  polygons->isClosed() ? "true" : "false");
      list(std::vector<int>(points.begin(), points.end()), [](int p) { std::printf("%d", p); });
      std::printf("}");
      isFirst = false;
    }
  }
  std::printf("]");
}

void groups(const Adapter& geo) {
  std::printf(",\"groups\":{");
  const std::vector<std::string> names = geo.primitiveGroupNames();
  for (const std::string& name : names) {
    key(name, &name == &names.front());
    list(*geo.primitiveGroupMembership(name), [](bool in) { std::printf(in ? "1" : "0"); });
  }
  std::printf("}");
}

}  // namespace

int main(int, char** arguments) {
  const auto read = houio::GeometryIO::readHouGeo(arguments[1]);
  for (const auto& diagnostic : read.diagnostics) std::cerr << diagnostic.message << '\n';
  if (!read || !read.diagnostics.empty()) return 1;
  const Adapter& geo = *read.value;
  std::printf("{\"counts\":[%lld,%lld,%lld]", static_cast<long long>(geo.pointCount()),
              static_cast<long long>(geo.vertexCount()),
              static_cast<long long>(geo.primitiveCount()));
  attributes("point", geo.pointAttributeNames(), [&](auto& n) { return geo.pointAttribute(n); });
  attributes("vertex", geo.vertexAttributeNames(), [&](auto& n) { return geo.vertexAttribute(n); });
  attributes("primitive", geo.primitiveAttributeNames(),
             [&](auto& n) { return geo.primitiveAttribute(n); });
  primitives(geo);
  groups(geo);
  std::printf("}\n");
}
