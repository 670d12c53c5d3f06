// Break a mesh with ten lines of C++.
#include <sherd/sherd.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const sherd::SourceMesh source = sherd::readMesh(argv[1]);
  const sherd::FractureOptions options{.pieces = 5, .seed = 7, .solid = {.resolution = 64}};
  sherd::Device device;
  const sherd::FractureResult result = sherd::fracture(source.mesh, options, device);
  for (const sherd::Fragment& piece : result.fragments)
    std::cout << piece.id << ' ' << piece.mass.volume << '\n';
  sherd::writeFracture(argv[2], source, options, result);
}
