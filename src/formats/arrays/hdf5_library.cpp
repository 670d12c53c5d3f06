// Opens the HDF5 library.
#include "formats/arrays/hdf5_library.h"

#include <dlfcn.h>

#include <array>

#include "formats/arrays/hdf5_file.h"

namespace sherd {
namespace {

// Debian's names, then those of other systems; versions 1.10, 1.14 and 1.12.
constexpr std::array kNames{"libhdf5_serial.so.103", "libhdf5_serial.so.310", "libhdf5.so.103",
                            "libhdf5.so.310", "libhdf5.so.200"};

constexpr unsigned kLeastMinor = 10, kLeastRelease = 3;  // 1.10.3, with H5Dread_chunk

void find(Hdf5Library& library) {
  void* handle = nullptr;
  for (const char* name : kNames) {
    if (handle == nullptr) handle = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);  // never closed
  }
  if (handle == nullptr) {
    library.fault = "the HDF5 library cannot be opened (Debian's libhdf5-103-1)";
    return;
  }
  bool good = true;
#define SHERD_HDF5_FIND(name)                                                      \
  library.name = reinterpret_cast<decltype(library.name)>(::dlsym(handle, #name)); \
  good = good && library.name != nullptr;
  SHERD_HDF5_FUNCTIONS(SHERD_HDF5_FIND)
#undef SHERD_HDF5_FIND
  unsigned major = 0, minor = 0, release = 0;
  // All files are closed before the program ends; nothing is left for the library to do then.
  good = good && library.H5dont_atexit() >= 0 && library.H5open() >= 0 &&
         library.H5get_libversion(&major, &minor, &release) >= 0 && major == 1 &&
         (minor > kLeastMinor || (minor == kLeastMinor && release >= kLeastRelease));
  const auto number = [&](hid_t& to, const char* name) {
    const auto* const found = static_cast<const hid_t*>(::dlsym(handle, name));
    good = good && found != nullptr;
    if (good) to = *found;
  };
  number(library.fileCreation, "H5P_CLS_FILE_CREATE_ID_g");
  number(library.fileAccess, "H5P_CLS_FILE_ACCESS_ID_g");
  number(library.linkCreation, "H5P_CLS_LINK_CREATE_ID_g");
  number(library.groupCreation, "H5P_CLS_GROUP_CREATE_ID_g");
  number(library.datasetCreation, "H5P_CLS_DATASET_CREATE_ID_g");
  number(library.float32, "H5T_IEEE_F32LE_g");
  number(library.int8, "H5T_STD_I8LE_g");
  number(library.int16, "H5T_STD_I16LE_g");
  number(library.int32, "H5T_STD_I32LE_g");
  number(library.int64, "H5T_STD_I64LE_g");
  number(library.text, "H5T_C_S1_g");
  if (!good) library.fault = "the HDF5 library here is not of a version from 1.10.3 to 1.14";
}

}  // namespace

Hdf5Library& hdf5Library() {
  static Hdf5Library& library = *[] {
    auto* const opened = new Hdf5Library;  // never destroyed, as the library is never closed
    find(*opened);
    return opened;
  }();
  return library;
}

std::string hdf5Fault() { return hdf5Library().fault; }

}  // namespace sherd
