// Where a file goes: to a path, or to whoever takes its bytes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace sherd {

/// Takes bytes, piece by piece.
using ByteSink = std::function<void(std::string_view)>;

/// Hands bytes over to a sink.
using Content = std::function<void(const ByteSink&)>;

/// Takes files by name, from any thread.
class FileSink {
 public:
  virtual ~FileSink() = default;

  /// Take a file whole, or not at all where `content` throws.
  ///   name  parts separated by '/', relative unless the sink says otherwise
  ///   throws  Error(output)
  virtual void take(const std::string& name, const Content& content) = 0;
};

/// One file: a path, which appears whole or not at all, or a name in a sink.
class OutputFile {
 public:
  OutputFile(std::filesystem::path path) : name_(std::move(path)) {}
  OutputFile(const char* path) : name_(path) {}
  OutputFile(const std::string& path) : name_(path) {}
  OutputFile(FileSink& sink, std::filesystem::path name) : sink_(&sink), name_(std::move(name)) {}

  /// As messages name it.
  std::string string() const { return name_.string(); }

  /// Write it.
  ///   throws  Error(output) with its name in front
  void write(std::string_view bytes) const;
  void write(const Content& content) const;

 private:
  FileSink* sink_ = nullptr;
  std::filesystem::path name_;
};

/// Where files go together: a folder, or a sink.
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
