// Opens the HDF5 library.
#include "formats/arrays/hdf5_library.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>

namespace sherd {
namespace {

// Debian's names, then those of other systems; versions 1.10, 1.14, 1.12 and 2.0.
constexpr std::array kNames{"libhdf5_serial.so.103", "libhdf5_serial.so.310", "libhdf5.so.103",
                            "libhdf5.so.310",        "libhdf5.so.200",        "libhdf5.so.320"};

// The library's file, instead of those.
constexpr const char* kFileVariable = "SHERD_HDF5_LIBRARY";

constexpr unsigned kLeastMinor = 10, kLeastRelease = 3;  // 1.10.3, with H5Dread_chunk

void* opened(const char* name) {
  return ::dlopen(name, RTLD_NOW | RTLD_LOCAL);  // never closed
}

// Version 2.0 has a function of the former signature by a name of its own where it was changed.
void* functionOf(void* handle, const std::string& name) {
  void* const found = ::dlsym(handle, name.c_str());
  return found != nullptr ? found : ::dlsym(handle, (name + "1").c_str());
}

bool isKnown(unsigned major, unsigned minor, unsigned release) {
  if (major == 2) return true;
  return major == 1 && (minor > kLeastMinor || (minor == kLeastMinor && release >= kLeastRelease));
}

void find(Hdf5Library& library) {
  void* handle = nullptr;
  if (const char* const file = std::getenv(kFileVariable); file != nullptr && *file != '\0') {
    handle = opened(file);
    if (handle == nullptr) {
      library.fault = std::string("the HDF5 library cannot be opened: ") + ::dlerror();
      return;
    }
  }
  for (const char* name : kNames) {
    if (handle == nullptr) handle = opened(name);
  }
  if (handle == nullptr) {
    library.fault = "the HDF5 library cannot be opened (Debian's libhdf5-103-1)";
    return;
  }
  bool good = true;
#define SHERD_HDF5_FIND(name)                                                         \
  library.name = reinterpret_cast<decltype(library.name)>(functionOf(handle, #name)); \
  good = good && library.name != nullptr;
  SHERD_HDF5_FUNCTIONS(SHERD_HDF5_FIND)
#undef SHERD_HDF5_FIND
  unsigned major = 0, minor = 0, release = 0;
  // All files are closed before the program ends; nothing is left for the library to do then.
  good = good && library.H5dont_atexit() >= 0 && library.H5open() >= 0 &&
         library.H5get_libversion(&major, &minor, &release) >= 0 && isKnown(major, minor, release);
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
  if (!good) library.fault = "the HDF5 library here is not of a version from 1.10.3 to 2";
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

}  // namespace sherd
