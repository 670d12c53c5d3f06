// Pickles arrays of arrays.
#include "formats/arrays/npy_objects.h"

#include <utility>

#include "base/little_endian.h"

namespace sherd {
namespace {

/// A pickle, opcode by opcode.
class Pickle {
 public:
  Pickle() : bytes_("\x80\x03") {}

  void global(const char* module, const char* name) {
    bytes_.append("c").append(module).append("\n").append(name).append("\n");
  }
  void op(char code) { bytes_ += code; }
  void number(std::uint32_t value) {
    op('J');  // BININT
    storeLittle(bytes_, value);
  }
  void text(std::string_view value) {
    op('X');  // BINUNICODE
    storeLittle(bytes_, static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
  }
  void data(std::string_view value) {
    op('B');  // BINBYTES
    storeLittle(bytes_, static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
  }

  // dtype(name, False, True), with its byte order and flags as the state
  void dtype(const char* name, const char* order, std::uint32_t flags) {
    global("numpy", "dtype");
    text(name);
    op(kFalse);
    op(kTrue);
    op(kTuple3);
    op(kReduce);
    op(kMark);
    number(3);
    text(order);
    for (int i = 0; i < 3; ++i) op('N');  // None
    number(0xffffffff);                   // -1
    number(0xffffffff);
    number(flags);
    op(kTuple);
    op(kBuild);
  }

  // _reconstruct(ndarray, (0,), b'b'), and what its state begins with
  void beginArray(std::span<const std::uint32_t> shape) {
    global("numpy.core.multiarray", "_reconstruct");
    global("numpy", "ndarray");
    number(0);
    op(kTuple1);
    data("b");
    op(kTuple3);
    op(kReduce);
    op(kMark);
    number(1);
    op(kMark);
    for (const std::uint32_t length : shape) number(length);
    op(kTuple);
  }
  void endArray() {
    op(kTuple);
    op(kBuild);
  }

  static constexpr char kMark = '(', kTuple = 't', kTuple1 = '\x85', kTuple3 = '\x87',
                        kReduce = 'R', kBuild = 'b', kFalse = '\x89', kTrue = '\x88', kList = ']',
                        kAppends = 'e', kStop = '.';

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

void addTable(Pickle& pickle, const NpyTable& table) {
  const auto rows = static_cast<std::uint32_t>(table.numbers.size() / table.columns);
  const std::uint32_t shape[] = {rows, static_cast<std::uint32_t>(table.columns)};
  pickle.beginArray(shape);
  pickle.dtype("i8", "<", 0);
  pickle.op(Pickle::kFalse);  // not Fortran's order
  std::string bytes;
  for (const std::int64_t number : table.numbers) {
    storeLittle(bytes, static_cast<std::uint64_t>(number));
  }
  pickle.data(bytes);
  pickle.endArray();
}

}  // namespace

NpyArray npyObjects(std::string name, std::span<const NpyTable> tables) {
  Pickle pickle;
  const std::uint32_t shape[] = {static_cast<std::uint32_t>(tables.size())};
  pickle.beginArray(shape);
  pickle.dtype("O8", "|", 63);
  pickle.op(Pickle::kFalse);
  pickle.op(Pickle::kList);
  pickle.op(Pickle::kMark);
  for (const NpyTable& table : tables) addTable(pickle, table);
  pickle.op(Pickle::kAppends);
  pickle.endArray();
  pickle.op(Pickle::kStop);
  return {std::move(name), "|O", {tables.size()}, pickle.take()};
}

}  // namespace sherd
