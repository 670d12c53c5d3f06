// Files that a mesh file names: only those in or below its folder are read.
#include "formats/mesh/beside.h"

#include <algorithm>

#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/text/text_scan.h"

namespace sherd {

NamedFile fileBeside(const MeshFile& file, std::string_view name) {
  constexpr const char* kOutside = "does not lie in or below the file's folder";
  std::string text(name);
  if (text.find('\0') != std::string::npos) return {{}, kOutside};
  std::replace(text.begin(), text.end(), '\\', '/');
  const std::filesystem::path relative = std::filesystem::path(text).lexically_normal();
  if (relative.empty() || relative.is_absolute() || *relative.begin() == "..")
    return {{}, kOutside};
  const std::filesystem::path folder = file.path.parent_path();
  try {
    if (!staysWithin(folder, relative)) return {{}, "leaves the file's folder by a symbolic link"};
  } catch (const Error&) {
    return {{}, "cannot be read"};
  }
  return {folder / relative, ""};
}

std::optional<std::string> readBeside(const MeshFile& file, std::string_view name,
                                      const std::string& kind, std::vector<std::string>& warnings) {
  const std::string what = file.name + ": its " + kind + " " + inQuotes(name) + " ";
  const NamedFile named = fileBeside(file, name);
  if (!named.refusal.empty()) {
    warnings.push_back(what + named.refusal + ", so it is left out");
    return std::nullopt;
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(named.path, error)) {
    warnings.push_back(what + "is not there, so it is left out");
    return std::nullopt;
  }
  const std::uintmax_t size = std::filesystem::file_size(named.path, error);
  if (!error && file.memory != nullptr && size > file.memory->left()) {
    warnings.push_back(what + "takes more memory than may be used, so it is left out");
    return std::nullopt;
  }
  try {
    return readFileBytes(named.path, file.memory);
  } catch (const Error&) {
    warnings.push_back(what + "cannot be read, so it is left out");
    return std::nullopt;
  }
}

int textureBeside(const MeshFile& file, std::string_view name, RawMesh& mesh) {
  checkpoint(file);
  const auto known = std::find_if(mesh.appearance.textures.begin(), mesh.appearance.textures.end(),
                                  [&](const Texture& t) { return t.name == name; });
  if (known != mesh.appearance.textures.end())
    return static_cast<int>(known - mesh.appearance.textures.begin());
  std::optional<std::string> bytes = readBeside(file, name, "texture", mesh.warnings);
  if (bytes && bytes->empty()) {
    mesh.warnings.push_back(file.name + ": its texture " + inQuotes(name) +
                            " is empty, so it is left out");
    bytes.reset();
  }
  if (!bytes) return -1;
  mesh.appearance.textures.push_back({std::string(name), std::move(*bytes)});
  return static_cast<int>(mesh.appearance.textures.size()) - 1;
}

bool isGrayImage(std::string_view bytes) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  constexpr std::size_t kColorType = 25;  // of PNG: 0 gray, 4 gray with alpha
  const ImageType type = imageType(bytes);
  if (type == ImageType::png) {
    return bytes.size() > kColorType && (at(kColorType) == 0 || at(kColorType) == 4);
  }
  if (type != ImageType::jpeg) return false;
  // Segments of JPEG: ff, kind, length; a frame's header is of a kind from c0 to cf, but for three.
  for (std::size_t i = 2; i + 9 < bytes.size() && at(i) == 0xff;) {
    const unsigned kind = at(i + 1);
    if (kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc) {
      return at(i + 9) == 1;  // components
    }
    i += 2 + 256u * at(i + 2) + at(i + 3);
  }
  return false;
}

}  // namespace sherd
