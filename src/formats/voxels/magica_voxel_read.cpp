// Reads MagicaVoxel scenes, `.vox`, as labels: a voxel's label is its color.
//
// source  https://github.com/ephtracy/voxel-model: MagicaVoxel-file-format-vox.txt and its
// extension
#include <sherd/files.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>

#include "base/input_error.h"
#include "base/little_endian.h"
#include "base/text/text_scan.h"
#include "formats/voxels/parse_voxels.h"
#include "formats/voxels/voxel_runs.h"

namespace sherd {
namespace {

constexpr int kPaperSide = 126;  // of every model in a file of the paper's layout
constexpr std::size_t kDeepest = 64;

struct Model {
  std::array<int, 3> size{};
  std::string_view voxels;  // u8 x, y, z, color of each
};

// Axis `from[i]` of the model becomes axis i, reversed where `sign` is -1; then a shift.
struct Transform {
  std::array<std::size_t, 3> from{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};
  std::array<std::int64_t, 3> shift{};  // in half voxels

  // Transforms a point, in half voxels.
  [[nodiscard]] std::array<std::int64_t, 3> operator()(const std::array<std::int64_t, 3>& p) const {
    std::array<std::int64_t, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) out[i] = sign[i] * p[from[i]] + shift[i];
    return out;
  }
  // Returns the transform that applies `inner`, then this one.
  [[nodiscard]] Transform after(const Transform& inner) const {
    Transform both;
    for (std::size_t i = 0; i < 3; ++i) {
      both.from[i] = inner.from[from[i]];
      both.sign[i] = sign[i] * inner.sign[from[i]];
      both.shift[i] = sign[i] * inner.shift[from[i]] + shift[i];
    }
    return both;
  }
};

struct Node {
  enum class Kind { transform, group, shape } kind = Kind::group;
  Transform transform;
  std::vector<int> children;  // nodes; of a shape: models, of which the first is used
};

struct Scene {
  std::vector<Model> models;
  std::map<int, Node> nodes;
  bool foreign = false;  // has a chunk or size that the paper's layout does not have
};

/// Reads numbers and strings in sequence.
class Content {
 public:
  Content(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

  int number() {
    const std::string_view bytes = take(4);
    return static_cast<int>(loadLittle<std::uint32_t>(bytes.data()));
  }
  int count() {
    const int n = number();
    if (n < 0) inputError(name_, "is damaged: a count in it is negative");
    return n;
  }
  std::string_view take(std::size_t bytes) {
    if (bytes > rest_.size()) inputError(name_, "is cut or damaged: a chunk in it is too short");
    const std::string_view taken = rest_.substr(0, bytes);
    rest_.remove_prefix(bytes);
    return taken;
  }
  std::map<std::string_view, std::string_view> dictionary() {
    std::map<std::string_view, std::string_view> entries;
    for (int n = count(); n > 0; --n) {
      const std::string_view key = take(static_cast<std::size_t>(count()));
      entries[key] = take(static_cast<std::size_t>(count()));
    }
    return entries;
  }
  [[nodiscard]] bool done() const { return rest_.empty(); }

 private:
  std::string_view rest_;
  const std::string& name_;
};

// Bits 0-1 and 2-3: the columns of the nonzero entries in rows 0 and 1; 4 to 6: the signs of the
// rows.
void takeRotation(std::string_view text, Transform& transform, const std::string& name) {
  const auto bits = parseInteger<unsigned>(text);
  const std::size_t first = bits ? *bits & 3 : 3, second = bits ? *bits >> 2 & 3 : 3;
  if (first == 3 || second == 3 || first == second) {
    inputError(name, "has an invalid rotation " + inQuotes(text));
  }
  transform.from = {first, second, 3 - first - second};
  for (std::size_t i = 0; i < 3; ++i) transform.sign[i] = (*bits >> (4 + i) & 1) != 0 ? -1 : 1;
}

void takeTranslation(std::string_view text, Transform& transform, const std::string& name) {
  const std::string whole(text);
  for (std::int64_t& shift : transform.shift) {
    const auto value = parseInteger<std::int32_t>(takeWord(text));
    if (!value) inputError(name, "has an invalid translation " + inQuotes(whole));
    shift = std::int64_t{*value} * 2;
  }
}

Node transformNode(Content& in, const std::string& name) {
  Node node{Node::Kind::transform, {}, {in.number()}};
  in.take(8);  // reserved, layer
  if (in.count() < 1) inputError(name, "has a transform without a frame");
  const auto frame = in.dictionary();
  if (const auto r = frame.find("_r"); r != frame.end()) {
    takeRotation(r->second, node.transform, name);
  }
  if (const auto t = frame.find("_t"); t != frame.end()) {
    takeTranslation(t->second, node.transform, name);
  }
  return node;
}

Node listNode(Content& in, Node::Kind kind, const std::string& name) {
  Node node{kind, {}, {}};
  const int count = in.count();
  for (int i = 0; i < count; ++i) {
    node.children.push_back(in.number());
    if (kind == Node::Kind::shape) (void)in.dictionary();
  }
  if (kind == Node::Kind::shape && count == 0) inputError(name, "has a shape without a model");
  return node;
}

void addNode(Scene& scene, std::string_view id, Content& in, const std::string& name) {
  const int number = in.number();
  (void)in.dictionary();
  Node node = id == "nTRN"   ? transformNode(in, name)
              : id == "nGRP" ? listNode(in, Node::Kind::group, name)
                             : listNode(in, Node::Kind::shape, name);
  if (!scene.nodes.emplace(number, std::move(node)).second) {
    inputError(name, "has two nodes " + std::to_string(number));
  }
}

Model modelOf(Content& in, const std::array<int, 3>& size, const std::string& name) {
  const auto count = static_cast<std::size_t>(in.count());
  Model model{size, in.take(4 * count)};
  for (std::size_t i = 0; i < model.voxels.size(); i += 4) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (static_cast<unsigned char>(model.voxels[i + axis]) >= size[axis]) {
        inputError(name, "has a voxel outside of its model");
      }
    }
  }
  return model;
}

// Reads SIZE and XYZI of each model and the nodes; other chunks are skipped.
Scene readScene(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("VOX ")) {
    inputError(name, "is no .vox file of MagicaVoxel: it does not begin with 'VOX '");
  }
  Content file(bytes.substr(4), name);
  (void)file.number();  // the version
  if (file.take(4) != "MAIN") inputError(name, "is damaged: its first chunk is not MAIN");
  const int own = file.count();
  const auto inside = static_cast<std::size_t>(file.count());
  (void)file.take(static_cast<std::size_t>(own));
  Content chunks(file.take(inside), name);
  if (!file.done()) inputError(name, "is damaged: it holds more than its first chunk announces");
  Scene scene;
  std::optional<std::array<int, 3>> size;
  while (!chunks.done()) {
    const std::string_view id = chunks.take(4);
    const auto content = static_cast<std::size_t>(chunks.count());
    const auto children = static_cast<std::size_t>(chunks.count());
    Content in(chunks.take(content), name);
    (void)chunks.take(children);
    if (id == "SIZE") {
      size = {in.number(), in.number(), in.number()};
      if (*std::min_element(size->begin(), size->end()) < 1) {
        inputError(name, "has a model without a size");
      }
      scene.foreign |= *size != std::array<int, 3>{kPaperSide, kPaperSide, kPaperSide};
    } else if (id == "XYZI") {
      if (!size) inputError(name, "has voxels before their model's size");
      scene.models.push_back(modelOf(in, *size, name));
    } else if (id == "nTRN" || id == "nGRP" || id == "nSHP") {
      addNode(scene, id, in, name);
    } else {
      scene.foreign = true;
    }
  }
  return scene;
}

struct Instance {
  const Model* model = nullptr;
  Transform transform;
};

class InstanceCollector {
 public:
  InstanceCollector(const Scene& scene, const std::string& name) : scene_(scene), name_(name) {}

  std::vector<Instance> instances() && {
    if (!scene_.nodes.empty()) {
      visit(0, {}, 0);
    } else if (scene_.models.size() == 1) {
      instances_.push_back({&scene_.models[0], {}});
    } else if (scene_.models.size() > 1) {
      inputError(name_, "has " + std::to_string(scene_.models.size()) +
                            " models and no nodes that position them; save it with a newer "
                            "MagicaVoxel");
    }
    return std::move(instances_);
  }

 private:
  void visit(int number, const Transform& outer, std::size_t depth) {
    const auto found = scene_.nodes.find(number);
    if (found == scene_.nodes.end() || depth > kDeepest || ++visited_ > scene_.nodes.size()) {
      inputError(name_, "has a damaged tree of nodes at node " + std::to_string(number));
    }
    const Node& node = found->second;
    if (node.kind == Node::Kind::shape) {
      const auto model = static_cast<std::size_t>(node.children[0]);
      if (model >= scene_.models.size()) {
        inputError(name_, "names model " + std::to_string(node.children[0]) + " of " +
                              std::to_string(scene_.models.size()));
      }
      instances_.push_back({&scene_.models[model], outer});
      return;
    }
    const Transform world = outer.after(node.transform);
    for (const int child : node.children) visit(child, world, depth + 1);
  }

  const Scene& scene_;
  const std::string& name_;
  std::size_t visited_ = 0;  // a tree visits each node once
  std::vector<Instance> instances_;
};

/// A voxel with a color, in the grid's axes.
struct Voxel {
  std::array<std::int64_t, 3> at{};
  std::uint8_t color = 0;
};

template <class Use>
void forEachVoxel(const std::vector<Instance>& instances, Use use) {
  for (const Instance& instance : instances) {
    const std::string_view bytes = instance.model->voxels;
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
      std::array<std::int64_t, 3> p{};  // of its center, relative to the model's pivot
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] =
            2 * (static_cast<unsigned char>(bytes[i + axis]) - instance.model->size[axis] / 2) + 1;
      }
      p = instance.transform(p);
      for (std::int64_t& v : p) v = (v - 1) / 2;  // centers are odd
      const auto color = static_cast<std::uint8_t>(bytes[i + 3]);
      if (color > 0) use(Voxel{{p[0], p[2], p[1]}, color});
    }
  }
}

void checkAmount(const std::vector<Instance>& instances, std::size_t bytes,
                 const std::string& name) {
  const std::uint64_t most = std::max<std::uint64_t>(std::uint64_t{1} << 24, 16 * bytes);
  std::uint64_t voxels = 0;
  for (const Instance& instance : instances) voxels += instance.model->voxels.size() / 4;
  if (voxels > most) {
    inputError(name, "its models repeat to " + std::to_string(voxels) + " voxels; at most " +
                         std::to_string(most) + " are read from a file of this size");
  }
}

// In the paper's layout color 1 is label 2, and label 1 has no color. Files with color 0, for empty
// voxels, have another layout.
bool hasPaperLayout(const Scene& scene) {
  if (scene.foreign) return false;
  return std::none_of(scene.models.begin(), scene.models.end(), [](const Model& model) {
    for (std::size_t i = 3; i < model.voxels.size(); i += 4) {
      if (model.voxels[i] == 0) return true;
    }
    return false;
  });
}

struct KeyedVoxel {
  std::uint64_t key = 0;  // index in the box
  std::uint32_t order = 0;
  std::uint16_t label = 0;
};

}  // namespace

RunLengthVoxels parseMagicaVoxel(std::string_view bytes, const std::string& name,
                                 const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  const Scene scene = readScene(bytes, name);
  const std::vector<Instance> instances = InstanceCollector(scene, name).instances();
  checkAmount(instances, bytes.size(), name);
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
  std::array<std::int64_t, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  std::size_t count = 0;
  forEachVoxel(instances, [&](const Voxel& voxel) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], voxel.at[axis]);
      high[axis] = std::max(high[axis], voxel.at[axis]);
    }
    ++count;
  });
  if (count == 0) inputError(name, "holds no voxel");
  std::array<std::uint64_t, 3> sides{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sides[axis] = static_cast<std::uint64_t>(high[axis] - low[axis]) + 1;
  }
  RunLengthVoxels voxels{boxOf(sides, name), {}};

  const std::uint16_t shift = hasPaperLayout(scene) ? 1 : 0;
  memory.charge(count, sizeof(KeyedVoxel));
  std::vector<KeyedVoxel> keyed;
  keyed.reserve(count);
  forEachVoxel(instances, [&](const Voxel& voxel) {
    std::uint64_t key = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      key = key * sides[axis] + static_cast<std::uint64_t>(voxel.at[axis] - low[axis]);
    }
    keyed.push_back({key, static_cast<std::uint32_t>(keyed.size()),
                     static_cast<std::uint16_t>(voxel.color + shift)});
  });
  std::sort(keyed.begin(), keyed.end(), [](const KeyedVoxel& a, const KeyedVoxel& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  });
  std::uint64_t done = 0;
  GrowingMemory growing(&memory);
  constexpr std::size_t kVoxelsAtATime = std::size_t{1} << 12;
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    if (i % kVoxelsAtATime == 0)
      growing.hold((voxels.runs.size() + 2 * kVoxelsAtATime) * sizeof(Run));
    if (i + 1 < keyed.size() && keyed[i + 1].key == keyed[i].key)
      continue;  // a later voxel replaces it
    appendRun(voxels.runs, 0, keyed[i].key - done);
    appendRun(voxels.runs, keyed[i].label, 1);
    done = keyed[i].key + 1;
  }
  appendRun(voxels.runs, 0, voxelsIn(voxels.dims) - done);
  return voxels;
}

}  // namespace sherd
