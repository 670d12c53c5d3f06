// Gives meshes their licenses.
#pragma once

#include <sherd/dataset.h>

#include <vector>

namespace sherd {

/// Sets the license of each object, of LibraryOptions::licenses.
void addLicenses(std::vector<LibraryObject>& objects, const std::vector<MeshLicense>& licenses);

}  // namespace sherd
