// Tries whether sherd-assimp reads a triangle.
#include <sherd/error.h>
#include <sherd/files.h>

#include <string>

#include "formats/mesh_files/read_assimp.h"

namespace sherd {
namespace {

// A COLLADA file with one triangle.
constexpr const char* kTriangle =
    R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="f" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#f" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)";

}  // namespace

std::string assimpFault(const Progress* progress) {
  try {
    MeshFile file{"triangle.dae", "triangle.dae", MeshFormat::dae, kTriangle};
    file.progress = progress;
    const RawMesh mesh = readByAssimp(file, assimpLimits(file.bytes.size()));
    return mesh.triangles.size() == 1 ? "" : "sherd-assimp does not read a triangle";
  } catch (const Error& e) {
    if (e.code() == ErrorCode::cancelled) throw;
    return e.what();
  }
}

}  // namespace sherd
