// The HDF5 library's functions, found when the library is first used.
#pragma once

#include <hdf5.h>

// The header's constants call functions of the library otherwise.
#undef H5CHECK
#define H5CHECK
#undef H5OPEN
#define H5OPEN

#include <mutex>
#include <string>

// Every function that is used: its type comes from the library's header, its address from the
// library.  All are in versions 1.10.3 to 2.0.
#define SHERD_HDF5_FUNCTIONS(use)                                                                 \
  use(H5dont_atexit) use(H5open) use(H5get_libversion) use(H5Eset_auto2) use(H5Pcreate)           \
      use(H5Pclose) use(H5Pset_libver_bounds) use(H5Pset_link_phase_change)                       \
          use(H5Pset_char_encoding) use(H5Pset_chunk) use(H5Gcreate2) use(H5Gclose)               \
              use(H5Pset_shuffle) use(H5Pset_deflate) use(H5Pset_obj_track_times)                 \
                  use(H5Pset_fill_time) use(H5Fcreate) use(H5Fopen) use(H5Fclose)                 \
                      use(H5Screate_simple) use(H5Sclose) use(H5Sget_simple_extent_ndims)         \
                          use(H5Sget_simple_extent_dims) use(H5Dcreate2) use(H5Dopen2)            \
                              use(H5Dclose) use(H5Dget_space) use(H5Dget_type)                    \
                                  use(H5Dget_chunk_storage_size) use(H5Dwrite_chunk)              \
                                      use(H5Dread_chunk) use(H5Tcopy) use(H5Tset_size)            \
                                          use(H5Tset_cset) use(H5Tset_strpad) use(H5Tenum_create) \
                                              use(H5Tenum_insert) use(H5Tget_class)               \
                                                  use(H5Tget_size) use(H5Tclose) use(H5Lexists)

namespace sherd {

/// The opened library.  Its functions may be called by one thread at a time: hold `mutex`.
struct Hdf5Library {
#define SHERD_HDF5_MEMBER(name) decltype(&::name) name = nullptr;
  SHERD_HDF5_FUNCTIONS(SHERD_HDF5_MEMBER)
#undef SHERD_HDF5_MEMBER

  // Classes of property lists, and types.
  hid_t fileCreation = -1, fileAccess = -1, linkCreation = -1, groupCreation = -1,
        datasetCreation = -1;
  hid_t float32 = -1, int8 = -1, int16 = -1, int32 = -1, int64 = -1, text = -1;

  std::mutex mutex;
  std::string fault;  ///< why the library cannot be used; empty if it can
};

/// Opens the library at the first call.
[[nodiscard]] Hdf5Library& hdf5Library();

}  // namespace sherd
