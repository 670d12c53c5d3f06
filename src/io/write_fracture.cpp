// A whole fracture to a folder.
#include <sherd/io.h>

#include "io/atomic_file.h"
#include "io/file_names.h"
#include "io/fracture_files.h"
#include "io/fracture_folder.h"
#include "io/manifest.h"
#include "io/read_manifest.h"

namespace sherd {

std::filesystem::path writeFracture(const std::filesystem::path& folder, const SourceMesh& source,
                                    const FractureOptions& options, const FractureResult& result,
                                    const WriteOptions& write, const Progress* progress) {
  checkWriteOptions(write, options);
  const FractureWriter writer(source, write);
  const FractureFiles files =
      fileNames(source, result.kept(), options.surface.triangles, writer.materials(), write);
  return replaceFracture(folder, files.all(), [&](const std::filesystem::path& aside) {
    writer.write(aside, files, options, result, progress);
    writeWhole(aside / kManifestName, manifestText(source, options, result, files, write));
  });
}

}  // namespace sherd
