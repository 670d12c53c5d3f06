// A dataset with a writer of one's own: each object of a library is voxelized once and broken many
// times; of each fracture, a line per fragment goes to standard output.
//
//     own_dataset LIBRARY > fragments.csv
#include <sherd/sherd.h>

#include <iostream>

namespace {

void writeLines(const std::string& object, const sherd::PlannedFracture& planned,
                const sherd::FractureResult& result) {
  for (const sherd::Fragment& fragment : result.fragments) {
    const glm::dvec3& at = fragment.mass.centroid;
    std::cout << object << ',' << planned.name() << ',' << fragment.id << ',' << fragment.voxels
              << ',' << fragment.mass.volume << ',' << at.x << ',' << at.y << ',' << at.z << '\n';
  }
}

void breakObject(const sherd::LibraryObject& object, const sherd::Schedule& schedule,
                 sherd::Device& device) {
  const sherd::SourceMesh source = sherd::readMesh(object.file);
  sherd::PreparedSolid ready =
      sherd::prepared(sherd::voxelize(source.mesh, {.resolution = 48}), device);
  ready.surface = sherd::intactSurface(ready.solid);  // meshed once, copied by every fracture
  for (const sherd::PlannedFracture& planned : sherd::fracturesOf(schedule)) {
    const sherd::FractureOptions options{
        .pieces = planned.pieces,
        .seed = sherd::fractureSeed(/*runSeed=*/0, source.sha256, planned)};
    writeLines(object.key, planned, sherd::fracture(ready, options, device));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: own_dataset LIBRARY\n";
    return 2;
  }
  try {
    sherd::provideKernelCache();
    sherd::Device device;
    const sherd::Schedule schedule{
        .fewest = 2, .most = 4, .repeatsOfFewest = 3, .repeatsOfMost = 1};
    std::cout << "object,fracture,fragment,voxels,volume,x,y,z\n";
    for (const sherd::LibraryObject& object : sherd::findObjects(argv[1])) {
      try {
        breakObject(object, schedule, device);
      } catch (const sherd::Error& error) {
        if (error.code() != sherd::ErrorCode::input) throw;
        std::cerr << object.key << ": " << error.what() << '\n';  // continue with the next object
      }
    }
    return 0;
  } catch (const sherd::Error& error) {
    std::cerr << error.what() << '\n';
    return static_cast<int>(error.code());
  }
}
