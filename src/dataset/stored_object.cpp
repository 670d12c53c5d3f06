// Where a layout stores the files of an object.
#include "dataset/stored_object.h"

#include <utility>

#include "dataset/assemblage/draw.h"
#include "dataset/index.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/pfpp.h"
#include "dataset/layouts/split_of.h"

namespace sherd {

StorePlace storeOf(const std::filesystem::path& out, const LibraryObject& object,
                   const DatasetOptions& options, std::vector<FileRecord> kept,
                   std::uint64_t archive) {
  StorePlace place{.root = out,
                   .folder = objectFolder(options.layout, object),
                   .isArchive = options.layout == DatasetLayout::packed,
                   .compression = options.compression,
                   .kept = std::move(kept),
                   .archive = archive};
  if (options.layout == DatasetLayout::pfpp) {
    place.folder.clear();
    place.names =
        pfppFilesOf(object, splitOf(object, options.split), fracturesOf(object, options).size());
  }
  return place;
}

}  // namespace sherd
