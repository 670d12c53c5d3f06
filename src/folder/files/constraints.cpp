// Writes the contact graph as a constraint network for Houdini.
#include <sherd/files.h>

#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <vector>

#include "folder/files/split_levels.h"
#include "folder/manifest/split_parents.h"
#include "formats/geo/geo.h"
#include "formats/geo/geo_text.h"
#include "formats/mesh/each_contact.h"
#include "formats/mesh/joint_strength.h"

namespace sherd {
namespace {

struct Constraint {
  std::size_t one = 0, other = 0;  // indices of points
  float area = 0.0f, length = 0.0f, strength = 0.0f;
  std::size_t level = 0;  // of the split between them; 0: there are none
};

std::vector<Constraint> constraintsOf(std::span<const Fragment> fragments, double strength,
                                      std::span<const Split> splits, const Progress* progress) {
  const SplitLevels levels(parentsOf(splits, fragments.size()));
  std::vector<Constraint> constraints;
  forEachContact(fragments, [&](std::size_t one, std::size_t other, const Contact& contact) {
    throwIfCancelled(progress);
    const Fragment &a = fragments[one], &b = fragments[other];
    constraints.push_back(
        {.one = one,
         .other = other,
         .area = static_cast<float>(contact.area),
         .length = static_cast<float>(glm::length(a.mass.centroid - b.mass.centroid)),
         .strength = static_cast<float>(jointStrength(contact, strength)),
         .level = splits.empty() ? 0 : levels.ofContact(a.id, b.id)});
  });
  return constraints;
}

void points(GeoText& text, std::span<const Fragment> fragments) {
  text.openAttributes("pointattributes");
  text.attribute({.name = "P", .size = 3, .meaning = "point"}, [&](const auto& add) {
    for (const Fragment& fragment : fragments) {
      add([&](std::string& to) { appendTuple(to, fragment.mass.centroid); });
    }
  });
  text.strings(
      "name",
      [&](const auto& add) {
        for (const Fragment& fragment : fragments) {
          add([&](std::string& to) { to += geoName(fragment.id); });
        }
      },
      [&](const auto& add) {
        for (std::size_t i = 0; i < fragments.size(); ++i) {
          add([=](std::string& to) { appendShortest(to, i); });
        }
      });
  text.closeAttributes();
}

// Adds a string that all constraints have.
void shared(GeoText& text, std::string_view name, std::string_view value, std::size_t count) {
  text.strings(
      name, [=](const auto& add) { add([=](std::string& to) { to += value; }); },
      [=](const auto& add) {
        for (std::size_t i = 0; i < count; ++i) add([](std::string& to) { to += '0'; });
      });
}

void numbers(GeoText& text, std::string_view name, const std::vector<Constraint>& constraints,
             float Constraint::*value) {
  text.attribute({.name = name}, [&](const auto& add) {
    for (const Constraint& own : constraints) {
      add([&](std::string& to) { appendFloat(to, own.*value); });
    }
  });
}

void groups(GeoText& text, const std::vector<Constraint>& constraints) {
  std::map<std::size_t, std::size_t> levels;  // and how many have each
  for (const Constraint& own : constraints) ++levels[own.level];
  levels.erase(0);
  if (levels.empty()) return;
  text.openGroups();
  for (const auto& [level, count] : levels) {
    text.group("level" + std::to_string(level), [&, level = level](const auto& add) {
      for (const Constraint& own : constraints) add(own.level == level);
    });
  }
  text.closeGroups();
}

}  // namespace

void writeConstraints(const OutputFile& file, std::span<const Fragment> fragments, double strength,
                      std::span<const Split> splits, const Progress* progress) {
  const std::vector<Constraint> constraints = constraintsOf(fragments, strength, splits, progress);
  const std::size_t count = constraints.size();
  file.write([&](const ByteSink& sink) {
    GeoText text(sink, progress);
    text.begin({.points = fragments.size(), .vertices = 2 * count, .primitives = count});
    text.pointsOfVertices([&](const auto& add) {
      for (const Constraint& own : constraints) {
        for (const std::size_t end : {own.one, own.other}) {
          add([=](std::string& to) { appendShortest(to, end); });
        }
      }
    });
    points(text, fragments);
    text.openAttributes("primitiveattributes");
    shared(text, "constraint_name", "Glue", count);
    shared(text, "constraint_type", "all", count);
    numbers(text, "area", constraints, &Constraint::area);
    numbers(text, "restlength", constraints, &Constraint::length);
    numbers(text, "strength", constraints, &Constraint::strength);
    text.closeAttributes();
    text.primitives(count, 2, false);
    groups(text, constraints);
    text.finish();
  });
}

}  // namespace sherd
