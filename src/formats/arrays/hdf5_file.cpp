// Writes and reads HDF5 files.
#include "formats/arrays/hdf5_file.h"

#include <sherd/error.h>

#include <array>
#include <cerrno>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/input_error.h"
#include "formats/arrays/hdf5_library.h"

namespace sherd {
namespace {

/// An identifier of the library, closed at the end of a scope.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// The library while this thread alone uses it, and without messages on standard error.
class Use {
 public:
  ///   code  of the error if it cannot be opened
  explicit Use(ErrorCode code) : library_(hdf5Library()), lock_(library_.mutex) {
    if (!library_.fault.empty()) throw Error(code, library_.fault);
    library_.H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    errno = 0;
  }
  const Hdf5Library& operator*() const { return library_; }

 private:
  Hdf5Library& library_;
  std::lock_guard<std::mutex> lock_;
};

// Formats of versions 1.10 only, whatever the library's version: they store a chunk without a tree
// (2 to 3 kB less for each array), and small groups within their header.
constexpr auto kFormat = H5F_LIBVER_V110;
constexpr unsigned kMostInHeader = 64;  // members of a group, and parts of a fracture mostly

Id typeOf(const Hdf5Library& library, const Hdf5Array& array) {
  const auto copied = [&](hid_t type) { return Id(library.H5Tcopy(type), library.H5Tclose); };
  switch (array.type) {
    case Hdf5Type::float32:
      return copied(library.float32);
    case Hdf5Type::int32:
      return copied(library.int32);
    case Hdf5Type::int16:
      return copied(library.int16);
    case Hdf5Type::int64:
      return copied(library.int64);
    case Hdf5Type::boolean: {
      Id type(library.H5Tenum_create(library.int8), library.H5Tclose);
      const signed char no = 0, yes = 1;
      library.H5Tenum_insert(type, "FALSE", &no);
      library.H5Tenum_insert(type, "TRUE", &yes);
      return Id(library.H5Tcopy(type), library.H5Tclose);
    }
    case Hdf5Type::text:
      break;
  }
  Id type(library.H5Tcopy(library.text), library.H5Tclose);
  library.H5Tset_size(type, array.itemBytes);
  library.H5Tset_strpad(type, H5T_STR_NULLPAD);
  library.H5Tset_cset(type, H5T_CSET_UTF8);
  return Id(library.H5Tcopy(type), library.H5Tclose);
}

// How an array is stored: as one chunk, or an empty one without any.
Id storageOf(const Hdf5Library& library, const Hdf5Array& array) {
  const hid_t list = library.H5Pcreate(library.datasetCreation);
  library.H5Pset_obj_track_times(list, false);
  library.H5Pset_fill_time(list, H5D_FILL_TIME_NEVER);
  if (!array.packed.empty()) {
    const std::vector<hsize_t> chunk(array.shape.begin(), array.shape.end());
    library.H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data());
    if (array.itemBytes > 1 && array.type != Hdf5Type::text) library.H5Pset_shuffle(list);
    library.H5Pset_deflate(list, 4);  // a note only: arrays are packed already
  }
  return Id(list, library.H5Pclose);
}

Id utf8Names(const Hdf5Library& library) {
  const hid_t list = library.H5Pcreate(library.linkCreation);
  library.H5Pset_char_encoding(list, H5T_CSET_UTF8);
  return Id(list, library.H5Pclose);
}

}  // namespace

std::string hdf5Fault() { return hdf5Library().fault; }

Hdf5Writer::Hdf5Writer(const std::filesystem::path& file, std::string name)
    : name_(std::move(name)) {
  const Use use(ErrorCode::output);
  const Hdf5Library& library = *use;
  const Id access(library.H5Pcreate(library.fileAccess), library.H5Pclose);
  library.H5Pset_libver_bounds(access, kFormat, kFormat);
  const Id creation(library.H5Pcreate(library.fileCreation), library.H5Pclose);
  library.H5Pset_obj_track_times(creation, false);
  library.H5Pset_link_phase_change(creation, kMostInHeader, kMostInHeader / 2);
  file_ = library.H5Fcreate(file.c_str(), H5F_ACC_TRUNC, creation, access);
  if (file_ < 0) fail();
}

Hdf5Writer::~Hdf5Writer() {
  if (file_ < 0) return;
  const std::lock_guard lock(hdf5Library().mutex);
  hdf5Library().H5Fclose(file_);
}

void Hdf5Writer::fail() const {
  const int number = errno;
  throw Error(ErrorCode::output,
              name_ + ": cannot be written" + (number == 0 ? "" : ": " + reasonOf(number)));
}

// The library would add the groups of a path by itself, but with the time in each.
void Hdf5Writer::addGroups(const std::string& path) {
  const Hdf5Library& library = hdf5Library();
  const std::size_t last = path.rfind('/');
  const std::string groups = last == std::string::npos ? "" : path.substr(0, last + 1);
  const Id creation(library.H5Pcreate(library.groupCreation), library.H5Pclose);
  library.H5Pset_obj_track_times(creation, false);
  library.H5Pset_link_phase_change(creation, kMostInHeader, kMostInHeader / 2);
  const Id names = utf8Names(library);
  for (std::size_t end = groups.find('/'); end != std::string::npos;
       end = groups.find('/', end + 1)) {
    if (groups_.compare(0, end + 1, groups, 0, end + 1) == 0) continue;
    const std::string group = groups.substr(0, end);
    if (library.H5Lexists(file_, group.c_str(), H5P_DEFAULT) > 0) continue;
    const Id added(library.H5Gcreate2(file_, group.c_str(), names, creation, H5P_DEFAULT),
                   library.H5Gclose);
    if (added < 0) fail();
  }
  groups_ = groups;
}

void Hdf5Writer::add(const std::string& path, const Hdf5Array& array) {
  const Use use(ErrorCode::output);
  const Hdf5Library& library = *use;
  addGroups(path);
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Id type = typeOf(library, array), storage = storageOf(library, array);
  const Id space(library.H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                 library.H5Sclose);
  const Id names = utf8Names(library);
  const Id dataset(
      library.H5Dcreate2(file_, path.c_str(), type, space, names, storage, H5P_DEFAULT),
      library.H5Dclose);
  if (dataset < 0) fail();
  if (array.packed.empty()) return;
  const std::array<hsize_t, kMostHdf5Axes> origin{};
  if (library.H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, origin.data(), array.packed.size(),
                             array.packed.data()) < 0) {
    fail();
  }
}

void Hdf5Writer::close() {
  const Use use(ErrorCode::output);
  if ((*use).H5Fclose(std::exchange(file_, -1)) < 0) fail();
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& file) : name_(file) {
  const Use use(ErrorCode::input);
  const Hdf5Library& library = *use;
  file_ = library.H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file_ < 0) inputError(name_, "is not an HDF5 file, or cut");
}

Hdf5Reader::~Hdf5Reader() {
  if (file_ < 0) return;
  const std::lock_guard lock(hdf5Library().mutex);
  hdf5Library().H5Fclose(file_);
}

namespace {

// Whether every component of a path exists: H5Lexists fails where one before the last does not.
bool hasPath(const Hdf5Library& library, hid_t file, const std::string& path) {
  for (std::size_t end = path.find('/');; end = path.find('/', end + 1)) {
    if (library.H5Lexists(file, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

std::optional<Hdf5Type> typeFrom(const Hdf5Library& library, hid_t type, std::size_t bytes) {
  switch (library.H5Tget_class(type)) {
    case H5T_FLOAT:
      return bytes == 4 ? std::optional(Hdf5Type::float32) : std::nullopt;
    case H5T_INTEGER:
      if (bytes == 2) return Hdf5Type::int16;
      if (bytes == 4) return Hdf5Type::int32;
      return bytes == 8 ? std::optional(Hdf5Type::int64) : std::nullopt;
    case H5T_ENUM:
      return bytes == 1 ? std::optional(Hdf5Type::boolean) : std::nullopt;
    case H5T_STRING:
      return Hdf5Type::text;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<Hdf5Array> Hdf5Reader::read(const std::string& path) const {
  const Use use(ErrorCode::input);
  const Hdf5Library& library = *use;
  if (!hasPath(library, file_, path)) return std::nullopt;
  const auto refuse = [&] { inputError(name_, path + " is damaged, or not as sherd writes it"); };
  const Id dataset(library.H5Dopen2(file_, path.c_str(), H5P_DEFAULT), library.H5Dclose);
  if (dataset < 0) refuse();
  const Id type(library.H5Dget_type(dataset), library.H5Tclose);
  const Id space(library.H5Dget_space(dataset), library.H5Sclose);
  Hdf5Array array;
  array.itemBytes = library.H5Tget_size(type);
  const std::optional<Hdf5Type> found = typeFrom(library, type, array.itemBytes);
  const int axes = library.H5Sget_simple_extent_ndims(space);
  if (!found || axes < 1 || axes > static_cast<int>(kMostHdf5Axes)) refuse();
  array.type = *found;
  std::array<hsize_t, kMostHdf5Axes> shape{};
  library.H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  array.shape.assign(shape.begin(), shape.begin() + axes);
  for (const std::uint64_t length : array.shape) {
    if (length == 0) return array;
  }
  const std::array<hsize_t, kMostHdf5Axes> origin{};
  hsize_t bytes = 0;
  std::uint32_t filters = 0;
  if (library.H5Dget_chunk_storage_size(dataset, origin.data(), &bytes) < 0) refuse();
  if (bytes == 0 || bytes > std::filesystem::file_size(name_)) refuse();
  array.packed.resize(bytes);
  if (library.H5Dread_chunk(dataset, H5P_DEFAULT, origin.data(), &filters, array.packed.data()) <
          0 ||
      filters != 0) {
    refuse();
  }
  return array;
}

}  // namespace sherd
