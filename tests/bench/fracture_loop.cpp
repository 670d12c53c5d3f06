// What tools/python_overhead.py compares the Python module with: fractures of one solid, and their
// meshes.
//
// usage: fracture_loop MESH RESOLUTION FRACTURES    prints seconds for each
#include <sherd/sherd.h>

#include <chrono>
#include <cstdlib>
#include <iostream>

int main(int, char** arguments) {
  sherd::Device device("builtin");
  const int count = std::atoi(arguments[3]);
  const sherd::PreparedSolid ready = sherd::prepared(
      sherd::voxelize(sherd::readMesh(arguments[1]).mesh, {.resolution = std::atoi(arguments[2])}),
      device);
  std::size_t faces = 0;
  const auto start = std::chrono::steady_clock::now();
  for (int seed = 0; seed < count; ++seed) {
    sherd::FractureOptions options{.pieces = 8, .seed = static_cast<std::uint64_t>(seed)};
    options.surface.levelSets = false;
    for (const sherd::Fragment& f : sherd::fracture(ready, options, device).fragments) {
      faces += f.mesh.triangles.size();
    }
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::cout << seconds.count() / count << " " << faces << "\n";
}
