// Breaks a mesh into fragments and writes their files.
//
//     break_a_mesh bowl.obj pieces
#include <sherd/sherd.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: break_a_mesh MESH FOLDER\n";
    return 2;
  }
  try {
    sherd::provideKernelCache();  // once, before the first device
    sherd::Device device;
    const sherd::SourceMesh source = sherd::readMesh(argv[1]);
    const sherd::FractureOptions options{.pieces = 5, .seed = 7, .solid = {.resolution = 64}};
    const sherd::FractureResult result = sherd::fracture(source.mesh, options, device);
    for (const sherd::Fragment& fragment : result.fragments) {
      std::cout << "fragment " << fragment.id << ": volume " << fragment.mass.volume << ", touches "
                << fragment.contacts.size() << " others\n";
    }
    const sherd::WrittenFolder written = sherd::writeFracture(argv[2], source, options, result);
    std::cout << written.manifest.string() << '\n';
    return 0;
  } catch (const sherd::Error& error) {  // one sentence: what, where, what to try
    std::cerr << error.what() << '\n';
    return static_cast<int>(error.code());
  }
}
