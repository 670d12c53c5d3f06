// Writes AOVs as OpenEXR files.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <half.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/render.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>

namespace sherd {
namespace {

// A file in memory, so that OutputFile writes it and detects a full disk.
class Memory : public Imf::OStream {
 public:
  Memory() : Imf::OStream("image") {}
  void write(const char data[], int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (at_ + count > bytes.size()) bytes.resize(at_ + count);
    bytes.replace(at_, count, data, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t to) override { at_ = to; }

  std::string bytes;

 private:
  std::size_t at_ = 0;
};

// Reads a file in memory.
class MemoryToRead : public Imf::IStream {
 public:
  explicit MemoryToRead(const std::string& bytes) : Imf::IStream("image"), bytes_(bytes) {}
  bool read(char data[], int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (count > bytes_.size() - at_) throw std::runtime_error("ends too early");
    bytes_.copy(data, count, at_);
    at_ += count;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t to) override { at_ = std::min<std::size_t>(to, bytes_.size()); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

struct Channels {
  Imf::Header header;
  Imf::FrameBuffer buffer;
  std::size_t width;

  // Adds a channel with the values of all pixels, `stride` bytes apart.
  void add(const char* name, Imf::PixelType type, const void* first, std::size_t stride) {
    header.channels().insert(name, Imf::Channel(type));
    char* bytes = const_cast<char*>(static_cast<const char*>(first));  // Imf only reads it
    buffer.insert(name, Imf::Slice(type, bytes, stride, stride * width));
  }
};

}  // namespace

void writeExr(const OutputFile& file, const Aovs& aovs) {
  std::vector<half> rgba(aovs.rgba.begin(), aovs.rgba.end());
  Channels channels{Imf::Header(aovs.width, aovs.height), {}, static_cast<std::size_t>(aovs.width)};
  channels.header.compression() = Imf::ZIP_COMPRESSION;
  const char* const kColors[] = {"R", "G", "B", "A"};
  for (std::size_t k = 0; k < 4; ++k) {
    channels.add(kColors[k], Imf::HALF, &rgba[k], 4 * sizeof(half));
  }
  channels.add("Z", Imf::FLOAT, aovs.depth.data(), sizeof(float));
  const char* const kNormals[] = {"N.X", "N.Y", "N.Z"};
  const char* const kPositions[] = {"P.X", "P.Y", "P.Z"};
  for (int k = 0; k < 3; ++k) {
    channels.add(kNormals[k], Imf::FLOAT, &aovs.normal[0][k], sizeof(glm::vec3));
    channels.add(kPositions[k], Imf::FLOAT, &aovs.position[0][k], sizeof(glm::vec3));
  }
  channels.add("id", Imf::UINT, aovs.fragment.data(), sizeof(std::uint32_t));
  channels.add("neighbor", Imf::UINT, aovs.neighbor.data(), sizeof(std::uint32_t));
  Memory memory;
  try {
    {
      Imf::OutputFile out(memory, channels.header);
      out.setFrameBuffer(channels.buffer);
      out.writePixels(aovs.height);
    }
    // OpenEXR silently skips lines for which zlib has no memory.
    MemoryToRead written(memory.bytes);
    if (!Imf::InputFile(written).isComplete()) throw std::bad_alloc();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorCode::output, file.string() + ": OpenEXR cannot encode it: " + e.what());
  }
  file.write(memory.bytes);
}

}  // namespace sherd
