// Parsing of untrusted JSON.
#include "base/files/parsed_json.h"

#include <sherd/error.h>

#include <algorithm>
#include <string>

#include "base/files/file_bytes.h"
#include "base/input_error.h"
#include "base/memory.h"
#include "base/memory_budget.h"

namespace sherd {
namespace {

constexpr int kDeepest = 16;
constexpr std::uint64_t kBytesPerValue = 128;  // the value, its key, and its node in the map

}  // namespace

// The parser accepts any depth, but a value per level costs far more memory than its byte.  (The
// parser's callback could count, but makes parsing a list quadratic.)
JsonExtent extentOf(std::string_view text) {
  JsonExtent extent{0, 1};
  int depth = 0;
  bool inString = false, escaped = false;
  for (const char c : text) {
    if (escaped) {
      escaped = false;
    } else if (inString) {
      escaped = c == '\\';
      inString = c != '"';
    } else if (c == '"') {
      inString = true;
    } else if (c == '[' || c == '{') {
      extent.depth = std::max(extent.depth, ++depth);
      ++extent.values;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',') {
      ++extent.values;
    }
  }
  return extent;
}

namespace {

template <class Json>
Json parsed(std::string_view text) {
  if (extentOf(text).depth > kDeepest) {
    inputError("is nested too deeply: more than " + std::to_string(kDeepest) + " levels of JSON");
  }
  try {
    return Json::parse(text);
  } catch (const typename Json::parse_error& e) {
    inputError("is not JSON from byte " + std::to_string(e.byte) + " on");
  } catch (const typename Json::exception&) {
    inputError("holds a number that no double can hold");
  }
}

template <class Json>
Json readParsed(const std::filesystem::path& file, const char* kind, std::uintmax_t largestBytes) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(file, none);
  if (!none && size > largestBytes) {
    inputError(file, "has " + std::to_string(size) + " bytes, at most " +
                         std::to_string(largestBytes) + " are read");
  }
  MemoryBudget memory(file.string(), freeMemory());
  if (!none) memory.charge(size, 2);  // the text, and strings copied from it
  const std::string bytes = readFileBytes(file);
  memory.charge(extentOf(bytes).values, kBytesPerValue);
  try {
    return parsed<Json>(bytes);
  } catch (const Error& e) {
    inputError(file, std::string(e.what()) + ", so it is no " + kind, e.options());
  }
}

}  // namespace

nlohmann::json parsedJson(std::string_view text) { return parsed<nlohmann::json>(text); }

nlohmann::ordered_json parsedOrderedJson(std::string_view text) {
  return parsed<nlohmann::ordered_json>(text);
}

nlohmann::json readJson(const std::filesystem::path& file, const char* kind,
                        std::uintmax_t largestBytes) {
  return readParsed<nlohmann::json>(file, kind, largestBytes);
}

nlohmann::ordered_json readOrderedJson(const std::filesystem::path& file, const char* kind,
                                       std::uintmax_t largestBytes) {
  return readParsed<nlohmann::ordered_json>(file, kind, largestBytes);
}

}  // namespace sherd
