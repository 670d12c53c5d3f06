// What sherd-assimp reads, and what becomes of a program in its place that dies, hangs or lies.
#include "formats/mesh_files/read_assimp.h"

#include <gtest/gtest.h>
#include <sherd/files.h>
#include <sherd/mesh.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <iterator>
#include <random>
#include <sstream>
#include <string>

#include "formats/mesh/mesh_stream.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

constexpr std::uint64_t kMegabyte = 1'000'000;

class ReadAssimp : public MeshFolder {
 protected:
  ReadAssimp() { ::setenv("SHERD_ASSIMP", SHERD_ASSIMP_PROGRAM, 1); }

  // In the program's place: a shell script.
  void pretend(const std::string& script) const {
    const std::filesystem::path file = write("program", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    ::setenv("SHERD_ASSIMP", file.c_str(), 1);
  }
};

// The tetrahedron in two nodes, the second scaled by 2 and moved by (5, 0, 0), its faces as
// polygons with texture coordinates; z is up.
std::string dae() {
  std::ostringstream out;
  out << R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Z_UP</up_axis></asset>
<library_images><image id="i"><init_from>skin.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><newparam sid="f"><surface type="2D"><init_from>i</init_from></surface>
</newparam><newparam sid="m"><sampler2D><source>f</source></sampler2D></newparam><technique sid="t"><lambert><diffuse>
<texture texture="m" texcoord="c"/></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="clay" name="clay"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="6">0.25 0.5 1 0 0 1</float_array><technique_common>
<accessor source="#ua" count="3" stride="2"><param name="S" type="float"/><param name="T" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="4" material="s"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/>
<vcount>3 3 3 3</vcount><p>0 0 2 1 1 2  0 0 1 1 3 2  0 0 3 1 2 2  1 0 2 1 3 2</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene">)";
  for (const char* place :
       {R"(<node id="one" name="one">)",
        R"(<node id="two" name="two"><translate>5 0 0</translate><scale>2 2 2</scale>)"}) {
    out << place << R"(<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#clay"/></technique_common></bind_material></instance_geometry></node>)";
  }
  out << R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>)";
  return out.str();
}

TEST_F(ReadAssimp, NodesTransformNormals) {
  const std::string source =
      R"(<source id="n"><float_array id="na" count="9">0 0 1 0.6 0 0.8 0 -3 4</float_array><technique_common>
<accessor source="#na" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">)";
  std::string text = replaced(dae(), R"(<vertices id="v">)", source);
  text =
      replaced(text, R"(<vcount>)", R"(<input semantic="NORMAL" source="#n" offset="1"/><vcount>)");
  text = replaced(text, "<scale>2 2 2", "<scale>1 2 4");
  const TriangleMesh mesh = read("a.dae", text).mesh;
  ASSERT_EQ(mesh.attributes.normals.size(), 8u);
  const std::array<glm::dvec3, 3> given{
      {{0, 0, 1}, {0.6, 0, 0.8}, {0, -0.6, 0.8}}};  // each face of <p> has these in order
  for (std::size_t t = 0; t < 8; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 expected =
          glm::normalize(given[k] / (t < 4 ? glm::dvec3(1) : glm::dvec3(1, 2, 4)));
      EXPECT_LT(glm::distance(glm::dvec3(mesh.attributes.normals[t][k]), expected), 1e-6) << t;
    }
  }
}

TEST_F(ReadAssimp, ReadsColladaWithNodesAndLooks) {
  write("skin.png", "\x89PNG\r\n\x1a\n");
  const SourceMesh source = read("a.dae", dae());
  EXPECT_EQ(source.mesh.triangles.size(), 8u);
  EXPECT_EQ(openEdges(source.mesh), 0u);
  EXPECT_NEAR(volume(source.mesh), (1.0 + 8.0) / 6.0, 1e-6);
  EXPECT_EQ(bounds(source.mesh).max, glm::dvec3(7, 2, 2));  // z stays up
  EXPECT_EQ(source.objects, (std::vector<std::string>{"one", "two"}));
  ASSERT_EQ(source.mesh.attributes.texcoords.size(), 8u);
  EXPECT_EQ(source.mesh.attributes.texcoords[0][0], glm::vec2(0.25f, 0.5f));
  ASSERT_EQ(source.appearance.materials.size(), 1u);
  EXPECT_EQ(source.appearance.materials[0].name, "clay");
  EXPECT_EQ(source.appearance.materials[0].texture, 0);
  std::filesystem::remove(folder_ / "skin.png");
  EXPECT_EQ(read("a.dae", dae()).warnings,
            (std::vector<std::string>{"a.dae: its texture 'skin.png' is not there, so it is left "
                                      "out"}));
}

TEST_F(ReadAssimp, RefusesWhatAssimpRefuses) {
  EXPECT_EQ(refusal("a.fbx", "not an FBX").find("a.fbx: cannot be read (Assimp says: "), 0u);
  const std::string whole = dae();
  for (std::size_t length = 1; length < whole.size(); length += 197)
    EXPECT_EQ(refusal("c.dae", whole.substr(0, length)).find("c.dae: "), 0u);
}

TEST_F(ReadAssimp, SurvivesWhateverTheProgramDoes) {
  pretend("kill -SEGV $$");
  EXPECT_EQ(refusal("a.fbx", "x"), "a.fbx: cannot be read (Assimp stopped with signal 11)");
  pretend("kill -XCPU $$");
  EXPECT_EQ(refusal("a.fbx", "x"), "a.fbx: cannot be read (Assimp took more than 30 s)");
  pretend("echo 'half a\tsentence'; exit 3");
  EXPECT_EQ(refusal("a.fbx", "x"), "a.fbx: cannot be read (Assimp says: half a?sentence?)");
  pretend("echo sherd mesh 1");
  EXPECT_EQ(refusal("a.fbx", "x"), "a.fbx: cannot be read (Assimp gave an invalid answer)");
  pretend("exec 0<&-; exit 0");
  EXPECT_EQ(refusal("a.fbx", "x"), "a.fbx: cannot be read (Assimp gave an invalid answer)");
  ::setenv("SHERD_ASSIMP", (folder_ / "absent").c_str(), 1);
  EXPECT_NE(refusal("a.fbx", "x")
                .find("the program sherd-assimp, which reads this format, is not "
                      "at "),
            std::string::npos);
}

TEST_F(ReadAssimp, StopsAProgramThatTakesOrAnswersTooMuch) {
  const MeshFile file{folder_ / "a.fbx", "a.fbx", MeshFormat::fbx, "x"};
  const auto sentence = [&](const AssimpLimits& limits) -> std::string {
    try {
      (void)readByAssimp(file, limits);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      return e.what();
    }
    return "";
  };
  const auto begin = std::chrono::steady_clock::now();
  pretend("exec sleep 100");
  EXPECT_EQ(sentence({64, 10, 1}),
            "a.fbx: cannot be read (Assimp took more than 1 s or answered more than 64 MiB)");
  pretend("exec cat /dev/zero");
  EXPECT_EQ(sentence({4, 10, 50}),
            "a.fbx: cannot be read (Assimp took more than 50 s or answered more than 4 MiB)");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(40));
  ::setenv("SHERD_ASSIMP", SHERD_ASSIMP_PROGRAM, 1);
  EXPECT_EQ(sentence({1, 10, 50}).find("a.fbx: cannot be read (Assimp "), 0u);
}

TEST_F(ReadAssimp, ASignalToTheProgramCancels) {
  const auto handler = std::signal(SIGINT, SIG_DFL);  // background jobs of a shell ignore it
  pretend("kill -INT $$");
  try {
    (void)read("a.fbx", "x");
    ADD_FAILURE() << "it was read";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  std::signal(SIGINT, handler);
}

TEST_F(ReadAssimp, TheProgramsCopyOfTheFileIsCharged) {
  const auto file = write("a.fbx", std::string(4'000'000, 'x'));
  try {
    (void)readMesh(file, {.maxMemory = 6'000'000});
    ADD_FAILURE() << "it was read";
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find("a.fbx: reading it takes 0.008 GB"), 0u) << e.what();
  }
}

// No file may be longer than 64 KiB.
TEST_F(ReadAssimp, AFailedCopyOfTheFileLeavesNoDescriptorOpen) {
  const auto open = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                         std::filesystem::directory_iterator());
  };
  const auto file = write("a.fbx", std::string(1'000'000, 'x'));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1 << 16, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const auto descriptors = open();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string said;
  try {
    (void)readMesh(file);
  } catch (const Error& e) {
    said = e.what();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(said, "sherd-assimp cannot be started: its input: File too large");
  EXPECT_EQ(open(), descriptors);
}

RawMesh decorated() {
  RawMesh mesh;
  mesh.vertices = {{0, 0.1, -1e300}, {1, 2, 3}, {4, 5, 6}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
  mesh.attributes.texcoords = {{glm::vec2(1, 2), glm::vec2(3, 4), glm::vec2(5, 6)}, {}};
  mesh.attributes.colors = {{glm::u8vec3(1, 2, 3)}, {}};
  mesh.attributes.material = {1, 0};
  mesh.attributes.normals = {{glm::vec3(0, 3, 0)}, {}};
  mesh.appearance.materials = {{"a", glm::vec3(0.5f), 0}, {"", glm::vec3(1.0f), -1}};
  mesh.appearance.textures = {{"t.png", "bytes"}};
  mesh.objects = {"x", ""};
  mesh.objectOfTriangle = {0, 1};
  mesh.warnings = {"w"};
  return mesh;
}

TEST(MeshStream, GivesBackWhatWasPutIn) {
  const RawMesh mesh = decorated();
  const auto back = meshFromStream(streamOf(mesh));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->vertices, mesh.vertices);
  EXPECT_EQ(back->triangles, mesh.triangles);
  EXPECT_EQ(back->attributes.texcoords, mesh.attributes.texcoords);
  EXPECT_EQ(back->attributes.colors, mesh.attributes.colors);
  EXPECT_EQ(back->attributes.material, mesh.attributes.material);
  EXPECT_EQ(back->attributes.normals, mesh.attributes.normals);
  ASSERT_EQ(back->appearance.materials.size(), 2u);
  EXPECT_EQ(back->appearance.materials[0].name, "a");
  EXPECT_EQ(back->appearance.materials[0].color, glm::vec3(0.5f));
  EXPECT_EQ(back->appearance.materials[1].texture, -1);
  EXPECT_EQ(back->appearance.textures[0].bytes, "bytes");
  EXPECT_EQ(back->objects, mesh.objects);
  EXPECT_EQ(back->objectOfTriangle, mesh.objectOfTriangle);
  EXPECT_EQ(back->warnings, mesh.warnings);
}

TEST(MeshStream, WhatTakesMoreThanItsBytesIsCharged) {
  RawMesh mesh = decorated();
  mesh.appearance.textures.resize(10'000);
  const std::string stream = streamOf(mesh);
  MemoryBudget enough("a", kMegabyte), little("a", kMegabyte / 4);
  EXPECT_TRUE(meshFromStream(stream, &enough));
  EXPECT_GE(enough.taken(), 10'000 * sizeof(Texture));
  EXPECT_THROW((void)meshFromStream(stream, &little), Error);
}

TEST(MeshStream, RefusesWhatIsCutOrPointsNowhere) {
  const std::string whole = streamOf(decorated());
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(meshFromStream(whole.substr(0, length))) << length;
  EXPECT_FALSE(meshFromStream(whole + "x"));
  for (const auto& spoil : std::vector<void (*)(RawMesh&)>{
           [](RawMesh& m) { m.triangles[1].y = 3; }, [](RawMesh& m) { m.objectOfTriangle[0] = 2; },
           [](RawMesh& m) { m.attributes.material[0] = 2; },
           [](RawMesh& m) { m.attributes.colors.pop_back(); },
           [](RawMesh& m) { m.attributes.normals.pop_back(); },
           [](RawMesh& m) { m.attributes.texcoords[0][0].x = std::nanf(""); },
           [](RawMesh& m) { m.appearance.materials[0].texture = 1; },
           [](RawMesh& m) { m.appearance.materials[0].texture = -2; }}) {
    RawMesh mesh = decorated();
    spoil(mesh);
    EXPECT_FALSE(meshFromStream(streamOf(mesh)));
  }
  std::minstd_rand random(7);
  for (int round = 0; round < 20000; ++round) {
    std::string bytes = whole;
    for (auto edits = 1 + random() % 3; edits > 0; --edits)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto mesh = meshFromStream(bytes);
    if (mesh) {
      EXPECT_EQ(streamOf(*mesh).size(), bytes.size());
    }
  }
}

}  // namespace
}  // namespace sherd
