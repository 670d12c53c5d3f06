// HDF5 files.  tests/cli/training_layouts_test.py reads them by h5py.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <zlib.h>

#include <fstream>
#include <random>
#include <thread>

#include "base/files/file_bytes.h"
#include "formats/arrays/hdf5_file.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// What the filters of HDF5 do when they read.
std::string unpacked(const Hdf5Array& array) {
  std::size_t items = 1;
  for (const std::uint64_t length : array.shape) items *= length;
  std::string shuffled(items * array.itemBytes, '\0');
  uLongf size = shuffled.size();
  const int result =
      ::uncompress(reinterpret_cast<Bytef*>(shuffled.data()), &size,
                   reinterpret_cast<const Bytef*>(array.packed.data()), array.packed.size());
  EXPECT_EQ(result, Z_OK);
  if (array.type == Hdf5Type::text) return shuffled;
  std::string bytes(shuffled.size(), '\0');
  for (std::size_t i = 0; i < items; ++i) {
    for (std::size_t k = 0; k < array.itemBytes; ++k) {
      bytes[i * array.itemBytes + k] = shuffled[k * items + i];
    }
  }
  return bytes;
}

std::string randomBytes(std::size_t count) {
  std::mt19937 random(3);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

class Hdf5 : public TempFolder {
 protected:
  void SetUp() override {
    const std::string fault = hdf5Fault();
    if (fault.find("SHERD_HDF5=OFF") != std::string::npos) GTEST_SKIP() << fault;
    ASSERT_EQ(fault, "");  // the library is among the packages of the tests
  }
};

TEST(Hdf5Packed, UnpacksToTheSameBytes) {
  const std::string bytes = randomBytes(120);
  EXPECT_EQ(unpacked(packedHdf5(Hdf5Type::float32, {10, 3}, bytes)), bytes);
  EXPECT_EQ(unpacked(packedHdf5(Hdf5Type::int64, {15}, bytes)), bytes);
  EXPECT_EQ(unpacked(packedHdf5(Hdf5Type::int16, {60}, bytes)), bytes);
  EXPECT_EQ(unpacked(packedHdf5(Hdf5Type::boolean, {120}, bytes)), bytes);
  const Hdf5Array texts = packedHdf5({"a", "longer", "", "two"}, 2);
  EXPECT_EQ(texts.shape, (std::vector<std::uint64_t>{2, 2}));
  EXPECT_EQ(unpacked(texts), std::string("a\0\0\0\0\0longer\0\0\0\0\0\0two\0\0\0", 24));
}

TEST_F(Hdf5, ArraysReadBackAsTheyWereStored) {
  const fs::path file = folder_ / "a.hdf5";
  const std::vector<std::pair<std::string, Hdf5Array>> arrays{
      {"deep/er/floats", packedHdf5(Hdf5Type::float32, {10, 3}, randomBytes(120))},
      {"deep/er/masks", packedHdf5(Hdf5Type::boolean, {2, 3, 4}, randomBytes(24))},
      {"deep/longs", packedHdf5(Hdf5Type::int64, {15}, randomBytes(120))},
      {"texts", packedHdf5({"a", "longer"})},
      {"none", packedHdf5(std::vector<std::string>{})},
      {"deep/er/labels", packedHdf5(Hdf5Type::int16, {60}, randomBytes(120))}};
  Hdf5Writer writer(file, "a.hdf5");
  for (const auto& [path, array] : arrays) writer.add(path, array);
  EXPECT_THROW(writer.add("texts", arrays[0].second), Error);
  writer.close();
  const Hdf5Reader reader(file);
  for (const auto& [path, array] : arrays) {
    const auto read = reader.read(path);
    ASSERT_TRUE(read) << path;
    EXPECT_EQ(read->type, array.type);
    EXPECT_EQ(read->itemBytes, array.itemBytes);
    EXPECT_EQ(read->shape, array.shape);
    EXPECT_EQ(read->packed, array.packed);
  }
  EXPECT_FALSE(reader.read("deep/absent"));
  EXPECT_FALSE(reader.read("absent/er/floats"));
  EXPECT_THROW((void)reader.read("deep"), Error);
}

TEST_F(Hdf5, EqualArraysGiveEqualBytes) {
  const auto write = [&](const char* name) {
    Hdf5Writer writer(folder_ / name, name);
    for (int i = 0; i < 300; ++i) {  // more members than a group has in its header
      writer.add("group/" + std::to_string(i) + "/array",
                 packedHdf5(Hdf5Type::int32, {50}, randomBytes(200)));
    }
    writer.close();
    return readFileBytes(folder_ / name);
  };
  const std::string first = write("first");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // times have whole seconds
  EXPECT_EQ(write("second"), first);
}

TEST_F(Hdf5, FilesThatAreCutAreRefused) {
  const fs::path file = folder_ / "a.hdf5";
  {
    Hdf5Writer writer(file, "a.hdf5");
    writer.add("group/array", packedHdf5(Hdf5Type::int32, {5000}, randomBytes(20000)));
    writer.close();
  }
  const std::string whole = readFileBytes(file);
  for (std::size_t size = 0; size < whole.size(); size += 777) {
    fs::resize_file(file, size);
    EXPECT_THROW(Hdf5Reader{file}, Error) << size;
    std::ofstream(file, std::ios::binary) << whole;
  }
  EXPECT_NO_THROW(Hdf5Reader{file});
}

TEST_F(Hdf5, AFullDiskIsReported) {
  try {
    Hdf5Writer writer("/dev/full", "x.hdf5");
    writer.add("array", packedHdf5(Hdf5Type::int32, {5000}, randomBytes(20000)));
    writer.close();
    ADD_FAILURE() << "nothing was reported";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::output);
    EXPECT_EQ(std::string(e.what()).find("x.hdf5: cannot be written"), 0U) << e.what();
  }
}

}  // namespace
}  // namespace sherd
