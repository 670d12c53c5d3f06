// Destinations of files: paths or sinks.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace sherd {

/// Receives the bytes of a file in chunks.
using ByteSink = std::function<void(std::string_view)>;

/// Writes the bytes of a file to a sink.
using Content = std::function<void(const ByteSink&)>;

/// Receives files by name, from any thread.
class FileSink {
 public:
  virtual ~FileSink() = default;

  /// Stores a file completely, or not at all if `content` throws.
  ///   name    components separated by '/', relative unless the sink documents otherwise
  ///   throws  Error(output)
  virtual void take(const std::string& name, const Content& content) = 0;
};

/// One file: a path, written atomically, or a name in a sink.
class OutputFile {
 public:
  OutputFile(std::filesystem::path path) : name_(std::move(path)) {}
  OutputFile(const char* path) : name_(path) {}
  OutputFile(const std::string& path) : name_(path) {}
  OutputFile(FileSink& sink, std::filesystem::path name) : sink_(&sink), name_(std::move(name)) {}

  /// The name used in messages.
  std::string string() const { return name_.string(); }

  /// Writes the file.
  ///   throws  Error(output), the message starts with the name
  void write(std::string_view bytes) const;
  void write(const Content& content) const;

 private:
  FileSink* sink_ = nullptr;
  std::filesystem::path name_;
};

/// A destination for several files: a folder, or a sink.
class OutputFolder {
 public:
  OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  OutputFolder(FileSink& sink) : sink_(&sink) {}

  OutputFile operator/(const std::string& name) const {
    return sink_ ? OutputFile(*sink_, name) : OutputFile(folder_ / name);
  }

 private:
  FileSink* sink_ = nullptr;
  std::filesystem::path folder_;
};

}  // namespace sherd
