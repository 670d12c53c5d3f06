// A glTF file as a whole: its JSON and its buffers.
#include "formats/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/files/parsed_json.h"
#include "base/little_endian.h"
#include "base/text/text_scan.h"
#include "formats/mesh/beside.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

constexpr int kDeepestJson = 64;
constexpr std::uint64_t kBytesPerValue = 128;  // of JSON: itself, its key, its look-up

std::uint32_t wordAt(std::string_view bytes, std::size_t at) {
  return loadLittle<std::uint32_t>(bytes.data() + at);
}

Json parseJson(const MeshFile& file, std::string_view text) {
  const JsonExtent extent = extentOf(text);
  if (extent.depth > kDeepestJson) throw inputError(file, "its JSON is nested too deeply");
  charge(file, extent.values, kBytesPerValue);
  charge(file, text.size());  // its strings
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& e) {
    throw inputError(file, "cut short or malformed: its JSON is invalid at byte " +
                               std::to_string(e.byte) + " of " + std::to_string(text.size()));
  }
}

}  // namespace

GltfDocument::GltfDocument(const MeshFile& file) : file_(&file) {
  json_ =
      parseJson(file, file.format == MeshFormat::glb ? split() : withoutByteOrderMark(file.bytes));
  checkShape();
  checkVersion();
  loadBuffers();
  checkViews();
  checkAccessors();
}

// Returns the JSON of a GLB file and keeps its binary chunk.
std::string_view GltfDocument::split() {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  const std::string_view bytes = file_->bytes;
  if (bytes.size() < kHeader + kChunkHeader)
    throw bad("cut short: the file ends within its header");
  if (bytes.substr(0, 4) != "glTF") throw bad("found no 'glTF' at its beginning");
  if (wordAt(bytes, 4) != 2) {
    throw bad("is GLB of version " + std::to_string(wordAt(bytes, 4)) + ", version 2 is needed");
  }
  const std::size_t length = wordAt(bytes, 8);
  if (length != bytes.size()) {
    throw bad(std::string(bytes.size() < length ? "cut short: " : "") + "the header announces " +
              std::to_string(length) + " bytes, the file holds " + std::to_string(bytes.size()));
  }
  std::string_view json;
  for (std::size_t at = kHeader; at < bytes.size();) {
    if (bytes.size() - at < kChunkHeader)
      throw bad("cut short: the file ends within a chunk's header");
    const std::size_t size = wordAt(bytes, at);
    const std::uint32_t type = wordAt(bytes, at + 4);
    const bool first = at == kHeader;
    at += kChunkHeader;
    if (bytes.size() - at < size) {
      throw bad("cut short: a chunk announces " + std::to_string(size) + " bytes, the file holds " +
                std::to_string(bytes.size() - at));
    }
    if (first != (type == kJson)) throw bad("its first chunk, and only it, must be JSON");
    if (first) json = bytes.substr(at, size);
    if (type == kBinary && !binaryChunk_) binaryChunk_ = bytes.substr(at, size);
    at += size;
  }
  return json;
}

const Json& GltfDocument::member(const Json& object, const char* name) {
  static const Json kNone = Json::object();  // for members that are absent
  const auto found = object.find(name);
  return found == object.end() ? kNone : *found;
}

std::size_t GltfDocument::number(const Json& object, const char* name,
                                 std::size_t otherwise) const {
  const auto found = object.find(name);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > 0xffffffffu)
    throw bad("'" + std::string(name) + "' is " + plainText(found->dump().substr(0, 40)) +
              ", not a whole number below 2^32");
  return found->get<std::size_t>();
}

const Json& GltfDocument::at(const char* name, std::size_t index) const {
  const Json& objects = array(name);
  if (index >= objects.size()) {
    throw bad("refers to number " + std::to_string(index) + " of '" + name + "', the file has " +
              std::to_string(objects.size()));
  }
  return objects[index];
}

// Every array that is iterated must hold objects, or reading their members would fail.
void GltfDocument::checkShape() const {
  if (!json_.is_object()) throw bad("its JSON is not an object");
  for (const char* name : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes",
                           "materials", "textures", "images", "samplers"}) {
    const auto found = json_.find(name);
    if (found == json_.end()) continue;
    if (!found->is_array() ||
        !std::all_of(found->begin(), found->end(), [](const Json& o) { return o.is_object(); }))
      throw bad("'" + std::string(name) + "' is not an array of objects");
  }
}

void GltfDocument::checkVersion() const {
  const Json& asset = member(json_, "asset");
  const std::string version = asset.is_object() ? asset.value("version", Json()).dump() : "";
  if (!version.starts_with("\"2."))
    throw bad("is glTF of version " + plainText(version.substr(0, 40)) + ", version 2 is needed");
  for (const Json& extension : array("extensionsRequired")) {
    if (extension == "EXT_meshopt_compression")
      throw bad("needs the extension EXT_meshopt_compression, which is not supported");
  }
}

// The first buffer of a GLB file is its binary chunk.
void GltfDocument::loadBuffers() {
  std::size_t index = 0;
  for (const Json& buffer : array("buffers")) {
    const std::size_t announced = number(buffer, "byteLength");
    const auto uri = buffer.find("uri");
    if (uri != buffer.end()) {
      buffers_.push_back(loadBuffer(uri->get_ref<const std::string&>()));
    } else if (index == 0 && binaryChunk_) {
      buffers_.push_back(*binaryChunk_);
    } else {
      throw bad("buffer " + std::to_string(index) + " has no data");
    }
    if (buffers_.back().size() < announced) {
      throw bad("cut short: buffer " + std::to_string(index) + " announces " +
                std::to_string(announced) + " bytes, there are " +
                std::to_string(buffers_.back().size()));
    }
    buffers_.back() = buffers_.back().substr(0, announced);
    ++index;
  }
}

// A file that several buffers name is read once.
std::string_view GltfDocument::loadBuffer(const std::string& uri) {
  if (uri.starts_with("data:")) {
    const auto known = loaded_.find(uri);
    if (known != loaded_.end()) return known->second;
    charge(*file_, uri.size(), 2);  // the key and the decoded bytes
    return loaded_.emplace(uri, dataUriBytes(uri)).first->second;
  }
  const NamedFile named = fileBeside(*file_, percentDecoded(uri));
  if (!named.refusal.empty()) throw bad("its buffer " + inQuotes(uri) + " " + named.refusal);
  const auto known = loaded_.find(named.path.string());
  if (known != loaded_.end()) return known->second;
  try {
    return loaded_.emplace(named.path.string(), readFileBytes(named.path, file_->memory))
        .first->second;
  } catch (const Error& e) {
    throw bad("its buffer cannot be read: " + std::string(e.what()));
  }
}

void GltfDocument::checkViews() const {
  std::size_t index = 0;
  for (const Json& view : array("bufferViews")) {
    const std::size_t size = number(at("buffers", number(view, "buffer")), "byteLength");
    if (number(view, "byteOffset") + number(view, "byteLength") > size)
      throw bad("buffer view " + std::to_string(index) + " reaches beyond its buffer");
    ++index;
  }
}

void GltfDocument::checkAccessors() const {
  std::size_t index = 0;
  for (const Json& accessor : array("accessors")) {
    const std::size_t count = number(accessor, "count");
    const std::size_t element = components(accessor) * componentBytes(accessor);
    if (accessor.contains("bufferView")) {
      const Json& view = at("bufferViews", number(accessor, "bufferView"));
      const std::size_t stride = std::max(number(view, "byteStride"), element);
      const std::size_t end =
          number(accessor, "byteOffset") + (count == 0 ? 0 : (count - 1) * stride + element);
      if (end > number(view, "byteLength"))
        throw bad("accessor " + std::to_string(index) + " reaches beyond its buffer view");
    }
    ++index;
  }
}

std::size_t GltfDocument::bytes() const {
  std::size_t sum = file_->bytes.size();
  for (const std::string_view& buffer : buffers_) sum += buffer.size();
  return sum;
}

std::string_view GltfDocument::bufferView(std::size_t index) const {
  const Json& view = at("bufferViews", index);
  return buffers_[number(view, "buffer")].substr(number(view, "byteOffset"),
                                                 number(view, "byteLength"));
}

std::size_t GltfDocument::components(const Json& accessor) const {
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
  if (parts == kParts.end())
    throw bad("an accessor is of type " + plainText(type.dump().substr(0, 40)));
  return parts->second;
}

std::size_t GltfDocument::componentBytes(const Json& typed) const {
  switch (number(typed, "componentType")) {
    case 5120:
    case 5121:
      return 1;  // bytes
    case 5122:
    case 5123:
      return 2;  // shorts
    case 5125:
    case 5126:
      return 4;  // unsigned int, float
    default:
      throw bad("an accessor has an unknown 'componentType'");
  }
}

std::string dataUriBytes(std::string_view uri) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::int8_t, 256> digitOf{};
  digitOf.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    digitOf[static_cast<unsigned char>(kDigits[i])] = static_cast<std::int8_t>(i);
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : uri.substr(std::min(uri.size(), uri.find(',') + 1))) {
    const int digit = digitOf[static_cast<unsigned char>(c)];
    if (digit < 0) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += static_cast<char>(bits >> count & 0xff);
  }
  return out;
}

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

}  // namespace sherd
