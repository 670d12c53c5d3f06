// Whether a glTF or GLB file is whole.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "mesh/completeness.h"
#include "mesh/file_bytes.h"
#include "mesh/gltf_buffer.h"
#include "mesh/text_scan.h"

namespace sherd {
namespace {

using Json = nlohmann::json;

constexpr int kDeepestJson = 64;  // Assimp's parser calls itself once per level
constexpr std::size_t kDeepestNode = 1000;

// What a GLB file consists of: a JSON text and, mostly, one buffer.
struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

std::uint32_t wordAt(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

Chunks splitGlb(const MeshFile& file) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  const std::string_view bytes = file.bytes;
  if (bytes.size() < kHeader + kChunkHeader)
    throw inputError(file, "cut short: the file ends within its header");
  if (bytes.substr(0, 4) != "glTF") throw inputError(file, "found no 'glTF' at its beginning");
  if (wordAt(bytes, 4) != 2) {
    throw inputError(
        file, "is GLB of version " + std::to_string(wordAt(bytes, 4)) + ", version 2 is needed");
  }
  const std::size_t length = wordAt(bytes, 8);
  if (length != bytes.size()) {
    throw inputError(file, std::string(bytes.size() < length ? "cut short: " : "") +
                               "the header announces " + std::to_string(length) +
                               " bytes, the file holds " + std::to_string(bytes.size()));
  }
  Chunks chunks;
  for (std::size_t at = kHeader; at < bytes.size();) {
    if (bytes.size() - at < kChunkHeader)
      throw inputError(file, "cut short: the file ends within a chunk's header");
    const std::size_t size = wordAt(bytes, at);
    const std::uint32_t type = wordAt(bytes, at + 4);
    const bool first = at == kHeader;
    at += kChunkHeader;
    if (bytes.size() - at < size) {
      throw inputError(file, "cut short: a chunk announces " + std::to_string(size) +
                                 " bytes, the file holds " + std::to_string(bytes.size() - at));
    }
    if (first != (type == kJson))
      throw inputError(file, "its first chunk, and only it, must be JSON");
    if (first) chunks.json = bytes.substr(at, size);
    if (type == kBinary && !chunks.binary) chunks.binary = bytes.substr(at, size);
    at += size;
  }
  return chunks;
}

Json parseJson(const MeshFile& file, std::string_view text) {
  const auto limitDepth = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > kDeepestJson) throw inputError(file, "its JSON is nested too deeply");
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), limitDepth);
  } catch (const Json::parse_error& e) {
    throw inputError(file, "cut short or malformed: its JSON stops making sense at byte " +
                               std::to_string(e.byte) + " of " + std::to_string(text.size()));
  }
}

// The bytes that the base64 text of a data URI stands for, up to the first character that is none
// of base64's.
std::string dataUriBytes(std::string_view uri) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : uri.substr(std::min(uri.size(), uri.find(',') + 1))) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += static_cast<char>(bits >> count & 0xff);
  }
  return out;
}

// A glTF document: arrays of objects that refer to each other by index.
class Document {
 public:
  Document(const MeshFile& file, const Json& json) : file_(file), json_(json) {}

  // The array of that name, empty if there is none.
  const Json& array(const char* name) const { return member(json_, name, Json::value_t::array); }

  static const Json& member(const Json& object, const char* name, Json::value_t type) {
    static const Json kNoArray = Json::array(), kNoObject = Json::object();
    const auto found = object.find(name);
    if (found == object.end()) return type == Json::value_t::array ? kNoArray : kNoObject;
    return *found;
  }

  // A number >= 0 of an object.
  std::size_t number(const Json& object, const char* name, std::size_t otherwise = 0) const {
    const auto found = object.find(name);
    if (found == object.end()) return otherwise;
    if (!found->is_number_unsigned() || found->get<std::uint64_t>() > 0xffffffffu)
      throw inputError(file_, "'" + std::string(name) + "' is " + found->dump() +
                                  ", not a whole number below 2^32");
    return found->get<std::size_t>();
  }

  // The object of `arrayName` that a number points to.
  const Json& at(const char* arrayName, std::size_t index) const {
    const Json& objects = array(arrayName);
    if (index >= objects.size()) {
      throw inputError(file_, "refers to number " + std::to_string(index) + " of '" + arrayName +
                                  "', the file has " + std::to_string(objects.size()));
    }
    return objects[index];
  }

  // Every array that is walked must hold objects, or looking into them would fail.
  void checkShape() const {
    if (!json_.is_object()) throw inputError(file_, "its JSON is not an object");
    for (const char* name : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes"}) {
      const Json& objects = array(name);
      if (!objects.is_array() ||
          !std::all_of(objects.begin(), objects.end(), [](const Json& o) { return o.is_object(); }))
        throw inputError(file_, "'" + std::string(name) + "' is not an array of objects");
    }
  }

  void checkVersion() const {
    const Json& asset = member(json_, "asset", Json::value_t::object);
    const std::string version = asset.is_object() ? asset.value("version", Json()).dump() : "";
    if (!version.starts_with("\"2."))
      throw inputError(file_, "is glTF of version " + version + ", version 2 is needed");
    for (const Json& extension : array("extensionsRequired")) {
      for (const char* unsupported : {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                      "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"}) {
        if (extension == unsupported)
          throw inputError(file_, "needs the extension " + std::string(unsupported) +
                                      ", which is not supported");
      }
    }
  }

  // Loads every buffer; the first of a GLB file is its binary chunk.
  void checkBuffers(const std::optional<std::string_view>& binaryChunk) {
    std::size_t index = 0;
    for (const Json& buffer : array("buffers")) {
      const std::size_t announced = number(buffer, "byteLength");
      const auto uri = buffer.find("uri");
      if (uri != buffer.end()) {
        const auto& text = uri->get_ref<const std::string&>();
        buffers_.push_back(text.starts_with("data:") ? dataUriBytes(text)
                                                     : readGltfBuffer(file_, text));
      } else if (index == 0 && binaryChunk) {
        buffers_.emplace_back(*binaryChunk);
      } else {
        throw inputError(file_, "buffer " + std::to_string(index) + " has no data");
      }
      if (buffers_.back().size() < announced) {
        throw inputError(file_, "cut short: buffer " + std::to_string(index) + " announces " +
                                    std::to_string(announced) + " bytes, there are " +
                                    std::to_string(buffers_.back().size()));
      }
      ++index;
    }
    index = 0;
    for (const Json& view : array("bufferViews")) {
      const std::size_t size = number(at("buffers", number(view, "buffer")), "byteLength");
      if (number(view, "byteOffset") + number(view, "byteLength") > size)
        throw inputError(file_,
                         "buffer view " + std::to_string(index) + " reaches beyond its buffer");
      ++index;
    }
  }

  void checkAccessors() const {
    std::size_t index = 0;
    for (const Json& accessor : array("accessors")) {
      const std::size_t count = number(accessor, "count"), element = elementBytes(accessor);
      if (accessor.contains("bufferView")) {
        const Json& view = at("bufferViews", number(accessor, "bufferView"));
        const std::size_t stride = std::max(number(view, "byteStride"), element);
        const std::size_t end =
            number(accessor, "byteOffset") + (count == 0 ? 0 : (count - 1) * stride + element);
        if (end > number(view, "byteLength"))
          throw inputError(file_,
                           "accessor " + std::to_string(index) + " reaches beyond its buffer view");
      } else if (count > file_.bytes.size()) {  // all zeros: nothing else bounds them
        throw inputError(file_, "accessor " + std::to_string(index) + " announces " +
                                    std::to_string(count) + " elements without data");
      }
      if (accessor.contains("sparse"))
        throw inputError(
            file_, "accessor " + std::to_string(index) + " is sparse, which is not supported");
      ++index;
    }
  }

  void checkMeshes() const {
    for (const Json& mesh : array("meshes")) {
      for (const Json& primitive : member(mesh, "primitives", Json::value_t::array)) {
        const Json& attributes = primitive.is_object()
                                     ? member(primitive, "attributes", Json::value_t::object)
                                     : primitive;
        if (!attributes.is_object() || !attributes.contains("POSITION"))
          throw inputError(file_, "a mesh has no 'POSITION'");
        const Json& position = at("accessors", number(attributes, "POSITION"));
        if (position.value("type", Json()) != "VEC3" || number(position, "componentType") != 5126)
          throw inputError(file_, "a mesh's 'POSITION' is not of three floats");
        if (primitive.contains("indices"))
          checkIndices(at("accessors", number(primitive, "indices")), number(position, "count"));
      }
    }
  }

  // Nodes must form trees: a node within itself would be walked without end.
  void checkNodes() const {
    const std::size_t count = array("nodes").size();
    std::vector<std::size_t> parents(count, 0);
    for (const Json& node : array("nodes")) {
      if (node.contains("mesh")) (void)at("meshes", number(node, "mesh"));
      for (const std::size_t child : indices(node, "children", count)) {
        if (++parents[child] > 1)
          throw inputError(file_, "node " + std::to_string(child) + " has more than one parent");
      }
    }
    std::vector<std::size_t> level;
    for (std::size_t i = 0; i < count; ++i)
      if (parents[i] == 0) level.push_back(i);
    std::size_t reached = 0;
    for (std::size_t depth = 0; !level.empty(); ++depth) {
      if (depth > kDeepestNode) throw inputError(file_, "its nodes are nested too deeply");
      reached += level.size();
      std::vector<std::size_t> below;
      for (const std::size_t i : level)
        for (const std::size_t child : indices(array("nodes")[i], "children", count))
          below.push_back(child);
      level = std::move(below);
    }
    if (reached != count) throw inputError(file_, "a node lies within itself");
    for (const Json& scene : array("scenes")) (void)indices(scene, "nodes", count);
  }

 private:
  // Assimp leaves out faces whose indices are out of range.
  void checkIndices(const Json& accessor, std::size_t vertices) const {
    const std::size_t size = elementBytes(accessor), type = number(accessor, "componentType");
    if (accessor.value("type", Json()) != "SCALAR" ||
        (type != 5121 && type != 5123 && type != 5125))
      throw inputError(file_, "a mesh's 'indices' are not unsigned whole numbers");
    if (!accessor.contains("bufferView")) return;
    const Json& view = at("bufferViews", number(accessor, "bufferView"));
    const std::string& buffer = buffers_[number(view, "buffer")];
    const std::size_t stride = std::max(number(view, "byteStride"), size);
    const std::size_t count = number(accessor, "count");
    std::size_t from = number(view, "byteOffset") + number(accessor, "byteOffset");
    for (std::size_t i = 0; i < count; ++i, from += stride) {
      std::size_t index = 0;
      for (std::size_t k = size; k-- > 0;)
        index = index << 8 | static_cast<unsigned char>(buffer[from + k]);
      if (index >= vertices) {
        throw inputError(file_, "face uses vertex " + std::to_string(index) + ", its mesh has " +
                                    std::to_string(vertices));
      }
    }
  }

  // An array of node numbers.
  std::vector<std::size_t> indices(const Json& object, const char* name, std::size_t count) const {
    std::vector<std::size_t> out;
    for (const Json& value : member(object, name, Json::value_t::array)) {
      if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
        throw inputError(
            file_, "refers to node " + value.dump() + ", the file has " + std::to_string(count));
      out.push_back(value.get<std::size_t>());
    }
    return out;
  }

  std::size_t elementBytes(const Json& accessor) const {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kParts{{{"SCALAR", 1},
                                                                              {"VEC2", 2},
                                                                              {"VEC3", 3},
                                                                              {"VEC4", 4},
                                                                              {"MAT2", 4},
                                                                              {"MAT3", 9},
                                                                              {"MAT4", 16}}};
    const Json type = accessor.value("type", Json());
    const auto* parts =
        std::find_if(kParts.begin(), kParts.end(), [&](const auto& p) { return type == p.first; });
    if (parts == kParts.end()) throw inputError(file_, "an accessor is of type " + type.dump());
    switch (number(accessor, "componentType")) {
      case 5120:
      case 5121:
        return parts->second;  // bytes
      case 5122:
      case 5123:
        return 2 * parts->second;  // shorts
      case 5125:
      case 5126:
        return 4 * parts->second;  // unsigned int, float
      default:
        throw inputError(file_, "an accessor has an unknown 'componentType'");
    }
  }

  const MeshFile& file_;
  const Json& json_;
  std::vector<std::string> buffers_;
};

}  // namespace

std::string percentDecoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16).ptr ==
            text.data() + i + 3) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string readGltfBuffer(const MeshFile& file, std::string_view uri) {
  const std::filesystem::path relative = percentDecoded(uri);
  if (relative.empty() || relative.is_absolute() || *relative.lexically_normal().begin() == "..")
    throw inputError(file,
                     "its buffer " + inQuotes(uri) + " does not lie in or below the file's folder");
  try {
    return readFileBytes(file.path.parent_path() / relative);
  } catch (const Error& e) {
    throw inputError(file, "its buffer cannot be read: " + std::string(e.what()));
  }
}

FileCounts checkGltf(const MeshFile& file) {
  const Chunks chunks = file.format == MeshFormat::glb ? splitGlb(file) : Chunks{file.bytes, {}};
  try {
    const Json json = parseJson(file, chunks.json);
    Document document(file, json);
    document.checkShape();
    document.checkVersion();
    document.checkBuffers(chunks.binary);
    document.checkAccessors();
    document.checkMeshes();
    document.checkNodes();
  } catch (const Json::exception& e) {  // a number too large, a value of another type
    throw inputError(file, "its JSON cannot be used: " + plainText(e.what()));
  }
  return {};  // primitives may be strips and fans, and nodes show a mesh many times
}

}  // namespace sherd
