// Small files made by hand: what no writer of ours writes.
#pragma once

#include <string>
#include <vector>

namespace sherd::fuzz::handmade {

using Files = std::vector<std::string>;

inline Files ply() {
  return {
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment material 0 m 0\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\n"
      "property float t\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nproperty int material\nend_header\n"
      "0 0 0 1 2 3 0 0\n1 0 0 4 5 6 0 1\n0 1 0 7 8 9 1 1\n3 0 1 2 6 0 0 1 0 1 1 0\n"};
}

inline Files stl() {
  return {std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, '\0'),
          "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
          "endloop\nendfacet\nendsolid s\n"};
}

inline Files obj() {
  return {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf -1 -2 -3\n",
          "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0\nvt 0 1\nvt 1 1\nvt 1 0\n"
          "usemtl m\nf 1/1 2/2/ 3/3\nusemtl n\nf -1/-1 -2/-2 -3//\n"};
}

inline Files guideObj() {
  return {"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\nl -1 -2\n",
          "l 1/1 2/2\nv 0 0 0 1\nv 1 0 0 # end\nv 0 1 0\nf 1 2 3\nl 2 3 1\n"};
}

inline Files guidePly() {
  return {
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement edge 2\nproperty int vertex1\nproperty int vertex2\n"
      "property uchar red\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 1 9\n1 2 9\n"};
}

inline Files off() { return {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}; }

inline Files gltf() {
  return {R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36}],)"
          R"("meshes":[{"primitives":[{}]}]})",
          R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
          R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
          R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,)"
          R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,)"
          R"("type":"VEC3"},{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"},)"
          R"({"bufferView":0,"componentType":5121,"count":3,"type":"VEC4","normalized":true}],)"
          R"("images":[{"bufferView":0,"mimeType":"image/png"},{"uri":"x.png"}],)"
          R"("textures":[{"source":0},{"source":1}],"materials":[{"name":"m",)"
          R"("pbrMetallicRoughness":{"baseColorTexture":{"index":1,"texCoord":0},)"
          R"("baseColorFactor":[1,0.5,0,1]}}],"meshes":[{"primitives":[{"attributes":)"
          R"({"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},"material":0}]}]})"};
}

/// obj()'s first, packed.
inline Files gz() {
  return {
      std::string("\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x2b\x53\x30\x00\x41\xae\x32\x05"
                  "\x43\x28\x6d\x00\x62\x71\xa5\x01\x49\x23\x05\x63\x20\xad\x6b\xa8\xa0\x6b"
                  "\xa4\xa0\x6b\xcc\x05\x00\x74\x16\xf1\xd2\x2b\x00\x00\x00",
                  50)};
}

/// Of an object that was broken once, with a fragment that is withheld.
inline Files dataset() {
  return {R"({"schema":"sherd-dataset/1","layout":"sherd","seed":7,"split":[80,10,10],)"
          R"("options":"pieces 2..3","objects":[{"key":"a/b.obj","folder":"a/b","bytes":12}]})"};
}

inline Files hdf5Part() {
  return {
      R"({"schema":"sherd-hdf5-part/1","arrays":[{"path":"pieces/00/faces","type":"int32","item":4,)"
      R"("shape":[2,3],"bytes":5},{"path":"pieces_names","type":"text","item":8,"shape":[1],"bytes":3}]})"
      "\n12345abc"};
}

inline Files toml() {
  return {
      "# fractures\n[schedule]\npieces = \"2..10\"\r\nseed = 1_000\nposes = true\n",
      "impact = [\"1,0,0\", 'ray:1,0,0,1,0,0', # two\n]\nsplit = \"80/10\\t/10\"\n\"x\" = -1.5e3"};
}

inline Files json() {
  return {R"({"pieces": "2..10", "seed": 7, "poses": true, "impact": ["1,0,0", 2, -1.5e3]})"};
}

inline Files journal() {
  const std::string sum = '"' + std::string(64, 'a') + '"';
  return {std::string() + R"({"object":"ball.obj","sha256":)" + sum +
          R"(})"
          "\n"
          R"({"fracture":"whole","pieces":0,"repeat":0,"attempt":0,"seed":0,"options":{},"l)"
          R"(abels":["objects/ball/whole/labels.rle"],"fragments":[{"id":1,"voxels":232,"sh)"
          R"(are":1.0,"volume":3.25,"vertices":282,"faces":560,"contacts":[],"pose":{"rotat)"
          R"(ion":[-0.36,0.47,0.72,-0.35],"center":[0.0,-0.0,0.0],"truth_rotation":[-0.36,-)"
          R"(0.47,-0.72,0.35],"truth_translation":[0.0,-0.0,0.0]},"files":["objects/ball/wh)"
          R"(ole/meshes/ball.ply"]}],"files":[["objects/ball/whole/labels.rle",450,)" +
          sum + R"(],["objects/ball/whole/meshes/ball.ply",17683,)" + sum +
          R"(]],"archive":0})"
          "\n"
          R"({"fracture":"2f_0","pieces":2,"repeat":0,"attempt":0,"seed":673444590034011187)"
          R"(4,"options":{"roughness":"0"},"labels":["objects/ball/2f_0/labels.rle"],"fragm)"
          R"(ents":[{"id":1,"voxels":114,"share":0.49,"volume":1.59,"vertices":200,"faces":)"
          R"(396,"contacts":[[2,3.18]],"pose":{"rotation":[-0.62,-0.76,-0.02,0.21],"center")"
          R"(:[-0.05,0.26,-0.24],"truth_rotation":[-0.62,0.76,0.02,-0.21],"truth_translatio)"
          R"(n":[-0.05,0.26,-0.24]},"files":["objects/ball/2f_0/meshes/ball_001.ply"]},{"id)"
          R"(":2,"voxels":118,"share":0.51,"volume":1.66,"vertices":200,"faces":396,"contac)"
          R"(ts":[[1,3.18]],"pose":{"rotation":[-0.14,0.79,0.35,-0.49],"center":[0.05,-0.25)"
          R"(,0.23],"truth_rotation":[-0.14,-0.79,-0.35,0.49],"truth_translation":[0.05,-0.)"
          R"(25,0.23]},"withheld":true,"files":[]}],"files":[["objects/ball/2f_0/labels.rle)"
          R"(",642,)" +
          sum + R"(],["objects/ball/2f_0/manifest.json",4169,)" + sum +
          R"(],["objects/ball/2f_0/meshes/ball_001.ply",12599,)" + sum +
          R"(]],"archive":0})"
          "\n"
          R"({"done":true,"files":[]})"
          "\n"};
}

inline Files mtl() {
  return {"newmtl a\nKd 1 0.5 0\nmap_Kd -s 1 1 1 -clamp on a b.png\nnewmtl b\nKd 1\nmap_Kd\n"};
}

inline Files model3mf() {
  return {
      "<?xml version=\"1.0\"?><!-- a --><model unit=\"inch\"><resources><m:colorgroup id=\"7\">"
      "<m:color color=\"#FF0000\"/></m:colorgroup><basematerials id=\"8\"><base name=\"a&amp;b\" "
      "displaycolor=\"#BCBCBC80\"/></basematerials><object id=\"1\" pid=\"8\" pindex=\"0\"><mesh>"
      "<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x='1' y='1e-3' z='0'/><vertex x=\"1\" "
      "y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"7\" "
      "p1=\"0\"/></triangles></mesh></object><object id=\"2\"><components><component "
      "objectid=\"1\" p:path=\"/a.model\" transform=\"1 0 0 0 1 0 0 0 1 0 0 0\"/></components>"
      "</object></resources><build><item objectid=\"2\"/></build></model>"};
}

}  // namespace sherd::fuzz::handmade
