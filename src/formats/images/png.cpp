// Writes PNG files by libpng, without time or text: equal images give equal bytes.
#include <png.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/render.h>
#include <zlib.h>

#include <algorithm>
#include <csetjmp>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

namespace sherd {
namespace {

/// State of libpng's C callbacks.  They must not throw, so they record the failure and jump.
struct Target {
  std::string bytes;
  std::string problem;
  bool noMemory = false;
};

void append(png_structp png, png_bytep data, std::size_t size) {
  auto* const target = static_cast<Target*>(png_get_io_ptr(png));
  try {
    target->bytes.append(reinterpret_cast<const char*>(data), size);
  } catch (const std::bad_alloc&) {
    target->noMemory = true;
  }
  if (target->noMemory) png_error(png, "");
}

[[noreturn]] void fail(png_structp png, png_const_charp message) {
  try {
    static_cast<Target*>(png_get_error_ptr(png))->problem = message;
  } catch (const std::exception&) {  // the jump alone reports the failure
  }
  png_longjmp(png, 1);
}

void ignore(png_structp, png_const_charp) {}

png_voidp allocate(png_structp png, png_alloc_size_t size) {
  void* const memory = std::malloc(size);
  if (memory == nullptr) static_cast<Target*>(png_get_mem_ptr(png))->noMemory = true;
  return memory;
}

void release(png_structp, png_voidp memory) { std::free(memory); }

/// Returns false when libpng failed.  A longjmp skips destructors, so none may be pending here.
bool encode(const Image& image, png_structp png, png_infop info, Target* target) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, target, append, nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  // Run-length coding of differences: half the time of zlib's level 3, and files between a tenth
  // smaller and a tenth larger.
  png_set_compression_strategy(png, Z_RLE);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_write_info(png, info);
  const std::size_t row = 3 * static_cast<std::size_t>(image.width);
  for (int y = 0; y < image.height; ++y)
    png_write_row(png, &image.rgb[static_cast<std::size_t>(y) * row]);
  png_write_end(png, info);
  return true;
}

}  // namespace

void writePng(const OutputFile& file, const Image& image) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::output, file.string() + ": the image cannot be written: " + why);
  };
  const std::size_t bytes = 3 * static_cast<std::size_t>(std::max(image.width, 0)) *
                            static_cast<std::size_t>(std::max(image.height, 0));
  if (bytes == 0 || image.rgb.size() != bytes)
    refuse("it holds " + std::to_string(image.rgb.size()) + " bytes for " +
           std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels");
  Target target;
  png_structp png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &target, fail, ignore, &target,
                                              allocate, release);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool done = info && encode(image, png, info, &target);
  png_destroy_write_struct(png ? &png : nullptr, info ? &info : nullptr);
  if (target.noMemory) throw std::bad_alloc();
  if (!done) refuse(target.problem);
  file.write(target.bytes);
}

}  // namespace sherd
