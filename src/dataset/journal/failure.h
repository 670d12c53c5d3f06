// Failures of objects: any exception that an object meets is its own, and the library goes on.
#pragma once

#include <sherd/error.h>

#include <exception>
#include <filesystem>

#include "dataset/journal/journal.h"

namespace sherd {

/// Returns an exception as an error of the object that met it.
[[nodiscard]] Error objectError(const std::exception_ptr& met);

/// Whether an error ends the whole run: it was canceled, or the dataset can't be written.
[[nodiscard]] bool endsRun(const Error& error);

/// Whether another run may break an object that failed so: for want of memory, time or a device, or
/// by a fault of the program.
[[nodiscard]] bool isPassing(const Error& error);

/// Returns a file's SHA-256; empty if it can't be read.
[[nodiscard]] std::string sumOfFile(const std::filesystem::path& file);

/// Returns the sum of an assemblage, by those of the files of its parts.
[[nodiscard]] std::string sumOfSums(const std::vector<std::string>& sums);

/// Returns the sum of an object's file, or of an assemblage; empty if a file can't be read.
[[nodiscard]] std::string sumOfObject(const LibraryObject& object);

/// Whether a failed object is broken again: its failure may pass, or its file has changed.
[[nodiscard]] bool isTriedAgain(const FailedObject& failed, const LibraryObject& object);

}  // namespace sherd
