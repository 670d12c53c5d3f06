// What tools/bench/python_overhead.py compares the Python module with: fractures of one solid, and
// their meshes.
//
// usage: fracture_loop MESH RESOLUTION FRACTURES
// Prints for each fracture the seconds that pass and those of the processors, and all faces.
#include <sherd/sherd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <iostream>

int main(int, char** arguments) {
  sherd::Device device("builtin");
  const int count = std::atoi(arguments[3]);
  const sherd::PreparedSolid ready = sherd::prepared(
      sherd::voxelize(sherd::readMesh(arguments[1]).mesh, {.resolution = std::atoi(arguments[2])}),
      device);
  const auto run = [&](int fractures) {
    std::size_t faces = 0;
    for (int seed = 0; seed < fractures; ++seed) {
      sherd::FractureOptions options{.pieces = 8, .seed = static_cast<std::uint64_t>(seed)};
      options.surface.levelSets = false;
      for (const sherd::Fragment& f : sherd::fracture(ready, options, device).fragments) {
        faces += f.mesh.triangles.size();
      }
    }
    return faces;
  };
  run(2);  // threads and memory
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t own = std::clock();
  const std::size_t faces = run(count);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const double processors = static_cast<double>(std::clock() - own) / CLOCKS_PER_SEC;
  std::cout << seconds.count() / count << " " << processors / count << " " << faces << "\n";
}
