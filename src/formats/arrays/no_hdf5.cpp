// In place of the HDF5 files, in a build without HDF5.
#include <sherd/error.h>

#include "formats/arrays/hdf5_file.h"

namespace sherd {
namespace {

constexpr const char* kFault = "this program was built without HDF5 (-DSHERD_HDF5=OFF)";

}  // namespace

std::string hdf5Fault() { return kFault; }

Hdf5Writer::Hdf5Writer(const std::filesystem::path&, std::string) {
  throw Error(ErrorCode::output, kFault);
}
Hdf5Writer::~Hdf5Writer() = default;
void Hdf5Writer::add(const std::string&, const Hdf5Array&) {}
void Hdf5Writer::close() {}

Hdf5Reader::Hdf5Reader(const std::filesystem::path&) { throw Error(ErrorCode::input, kFault); }
Hdf5Reader::~Hdf5Reader() = default;
std::optional<Hdf5Array> Hdf5Reader::read(const std::string&) const { return {}; }

}  // namespace sherd
