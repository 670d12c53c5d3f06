// Bytes of `.vdb` files, for tests to damage.
#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace sherd {

/// Returns a file of grids as OpenVDB writes it, with offsets.
///   compression  flags of openvdb::io
inline std::string vdbBytes(const std::vector<openvdb::GridBase::Ptr>& grids,
                            std::uint32_t compression) {
  class Bytes : public openvdb::io::Archive {
   public:
    using Archive::write;
    std::string of(const openvdb::GridPtrVec& grids) const {
      std::ostringstream out(std::ios::binary);
      Archive::write(out, grids, /*seekable=*/true);
      return std::move(out).str();
    }
  };
  openvdb::initialize();
  Bytes archive;
  archive.setCompression(compression);
  return archive.of({grids.begin(), grids.end()});
}

}  // namespace sherd
