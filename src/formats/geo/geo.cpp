// Writes pieces in Houdini's geometry.
#include "formats/geo/geo.h"

#include <algorithm>
#include <array>

#include "formats/geo/geo_text.h"
#include "formats/mesh/identifiers.h"

namespace sherd {
namespace {

constexpr std::array<std::size_t, 3> kReversed{0, 2, 1};  // Houdini's order of a triangle's corners

class Detail {
 public:
  Detail(std::span<const GeoPiece> pieces, bool plain, const ByteSink& sink,
         const Progress* progress)
      : pieces_(pieces), plain_(plain), text_(sink, progress) {
    for (const GeoPiece& own : pieces) {
      counts_.points += own.piece.mesh.vertices.size();
      counts_.primitives += own.piece.mesh.triangles.size();
    }
    counts_.vertices = 3 * counts_.primitives;
  }

  void write() {
    text_.begin(counts_);
    text_.pointsOfVertices([this](const auto& add) {
      std::uint64_t first = 0;
      for (const GeoPiece& own : pieces_) {
        for (const glm::uvec3& triangle : own.piece.mesh.triangles) {
          for (const std::size_t k : kReversed) {
            const std::uint64_t point = first + triangle[static_cast<int>(k)];
            add([=](std::string& to) { appendShortest(to, point); });
          }
        }
        first += own.piece.mesh.vertices.size();
      }
    });
    if (!plain_) vertices();
    points();
    primitives();
    text_.primitives(counts_.primitives, 3, true);
    if (!plain_) {
      text_.openGroups();
      side("inside", true);
      side("outside", false);
      text_.closeGroups();
    }
    text_.finish();
  }

 private:
  bool any(bool (*has)(const SurfaceAttributes&)) const {
    return std::any_of(pieces_.begin(), pieces_.end(),
                       [=](const GeoPiece& own) { return has(own.piece.attributes); });
  }

  void vertices() {
    const bool hasNormals = any([](const SurfaceAttributes& a) { return !a.normals.empty(); });
    const bool hasTexcoords = any([](const SurfaceAttributes& a) { return !a.texcoords.empty(); });
    const bool hasColors = any([](const SurfaceAttributes& a) { return !a.colors.empty(); });
    if (!hasNormals && !hasTexcoords && !hasColors) return;
    text_.openAttributes("vertexattributes");
    if (hasNormals) normals();
    if (hasTexcoords) {
      corners({.name = "uv", .size = 3, .meaning = "texturecoord"},
              [](const SurfaceAttributes& a, std::size_t t, std::size_t k) {
                return a.texcoords.empty() ? glm::vec3(0.0f) : glm::vec3(a.texcoords[t][k], 0.0f);
              });
    }
    if (hasColors) {
      corners({.name = "Cd", .size = 3, .meaning = "color"},
              [](const SurfaceAttributes& a, std::size_t t, std::size_t k) {
                return a.colors.empty() ? glm::vec3(1.0f) : linearFromSrgb(a.colors[t][k]);
              });
    }
    text_.closeAttributes();
  }

  // Adds an attribute of vertices: value(attributes, triangle, corner).
  template <class Value>
  void corners(const GeoAttribute& attribute, const Value& value) {
    text_.attribute(attribute, [&](const auto& add) {
      for (const GeoPiece& own : pieces_) {
        for (std::size_t t = 0; t < own.piece.mesh.triangles.size(); ++t) {
          for (const std::size_t k : kReversed) {
            add([&](std::string& to) { appendTuple(to, value(own.piece.attributes, t, k)); });
          }
        }
      }
    });
  }

  void normals() {
    text_.attribute({.name = "N", .size = 3, .meaning = "normal"}, [this](const auto& add) {
      for (const GeoPiece& own : pieces_) {
        const std::vector<std::array<glm::vec3, 3>> normals = shortNormals(own.piece);
        for (const std::array<glm::vec3, 3>& corners : normals) {
          for (const std::size_t k : kReversed) {
            add([&](std::string& to) { appendTuple(to, corners[k]); });
          }
        }
      }
    });
  }

  void points() {
    text_.openAttributes("pointattributes");
    text_.attribute({.name = "P", .size = 3, .meaning = "point"}, [this](const auto& add) {
      for (const GeoPiece& own : pieces_) {
        for (const glm::dvec3& at : own.piece.mesh.vertices) {
          add([&](std::string& to) { appendTuple(to, at); });
        }
      }
    });
    text_.closeAttributes();
  }

  // Generates a number of each triangle: number(piece, its index, triangle).
  template <class Number>
  auto ofTriangles(const Number& number) const {
    return [this, number](const auto& add) {
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        for (std::size_t t = 0; t < pieces_[i].piece.mesh.triangles.size(); ++t) {
          add([&](std::string& to) { appendShortest(to, number(pieces_[i], i, t)); });
        }
      }
    };
  }

  void primitives() {
    text_.openAttributes("primitiveattributes");
    text_.strings(
        "name",
        [this](const auto& add) {
          for (const GeoPiece& own : pieces_) {
            add([&](std::string& to) { to += geoName(own.id); });
          }
        },
        ofTriangles([](const GeoPiece&, std::size_t i, std::size_t) { return i; }));
    if (!plain_) {
      text_.attribute({.name = "neighbor", .isWhole = true},
                      ofTriangles([](const GeoPiece& own, std::size_t, std::size_t t) {
                        return own.piece.mesh.neighborOf(t);
                      }));
    }
    text_.attribute(
        {.name = "unreal_gc_piece", .isWhole = true},
        ofTriangles([](const GeoPiece& own, std::size_t, std::size_t) { return own.level; }));
    text_.attribute(
        {.name = "unreal_gc_cluster", .isWhole = true},
        ofTriangles([](const GeoPiece& own, std::size_t, std::size_t) { return own.cluster; }));
    if (!plain_) materials();
    text_.closeAttributes();
  }

  // Nothing of an input without materials, so that Houdini looks for none.
  void materials() {
    if (!any([](const SurfaceAttributes& a) { return !a.material.empty(); })) return;
    const std::vector<std::string> names = identifiersOf(pieces_.front().piece.materials);
    text_.strings(
        "shop_materialpath",
        [&](const auto& add) {
          for (const std::string& name : names) {
            add([&](std::string& to) { (to += "/mat/") += name; });
          }
        },
        ofTriangles([](const GeoPiece& own, std::size_t, std::size_t t) {
          return own.piece.materialOf(t);
        }));
  }

  void side(std::string_view name, bool isInside) {
    text_.group(name, [&](const auto& add) {
      for (const GeoPiece& own : pieces_) {
        for (std::size_t t = 0; t < own.piece.mesh.triangles.size(); ++t) {
          add((own.piece.mesh.neighborOf(t) != 0) == isInside);
        }
      }
    });
  }

  std::span<const GeoPiece> pieces_;
  const bool plain_;
  GeoCounts counts_;
  GeoText text_;
};

}  // namespace

std::string geoName(int id) { return "piece" + std::to_string(id); }

void writeGeo(const OutputFile& file, std::span<const GeoPiece> pieces, const Progress* progress,
              bool plain) {
  file.write([&](const ByteSink& sink) { Detail(pieces, plain, sink, progress).write(); });
}

}  // namespace sherd
