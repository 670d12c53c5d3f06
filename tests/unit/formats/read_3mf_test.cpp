// What is read of 3MF files: geometry, units, colors and materials of triangles.
#include "formats/mesh_files/read_3mf.h"

#include <gtest/gtest.h>
#include <sherd/files.h>
#include <sherd/mesh.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/memory_budget.h"
#include "formats/arrays/zip_reader.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

// A ZIP file of stored entries.
std::string zip(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string out, directory;
  const auto entry = [](std::string& to, const std::string& name, const std::string& bytes) {
    put(to, std::uint16_t{20});
    put(to, std::uint16_t{0}), put(to, std::uint16_t{0});  // flags, stored
    put(to, std::uint32_t{0x00210000});                    // 1980-01-01
    put(to, static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()),
                                               static_cast<uInt>(bytes.size()))));
    put(to, static_cast<std::uint32_t>(bytes.size()));
    put(to, static_cast<std::uint32_t>(bytes.size()));
    put(to, static_cast<std::uint16_t>(name.size()));
    put(to, std::uint16_t{0});
  };
  for (const auto& [name, bytes] : files) {
    const auto at = static_cast<std::uint32_t>(out.size());
    out += "PK\3\4";
    entry(out, name, bytes);
    out += name + bytes;
    directory += "PK\1\2";
    put(directory, std::uint16_t{20});
    entry(directory, name, bytes);
    directory += std::string(10, '\0');
    put(directory, at);
    directory += name;
  }
  const auto from = static_cast<std::uint32_t>(out.size());
  out += directory + "PK\5\6" + std::string(4, '\0');
  put(out, static_cast<std::uint16_t>(files.size()));
  put(out, static_cast<std::uint16_t>(files.size()));
  put(out, static_cast<std::uint32_t>(directory.size()));
  put(out, from);
  return out + std::string(2, '\0');
}

constexpr const char* kRels =
    R"(<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
    R"(<Relationship Id="r" Target="/3D/part.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>)"
    R"(</Relationships>)";

// A model of resources and items.
std::string model(const std::string& resources,
                  const std::string& items = R"(<item objectid="1"/>)") {
  return R"(<?xml version="1.0"?><!-- <model unit="foot"> --><model unit="inch" xmlns="core" xmlns:m="material"><metadata name="a">1 &lt; 2</metadata><resources>)" +
         resources + "</resources><build>" + items + "</build></model>\n";
}

std::string package(const std::string& text) {
  return zip({{"_rels/.rels", kRels}, {"3D/part.model", text}});
}

// The tetrahedron as an object; each triangle has one of the properties in turn.
std::string object(const std::string& attributes, const std::vector<std::string>& properties = {},
                   const std::string& id = "1") {
  std::string text = "<object id=\"" + id + "\" " + attributes + "><mesh><vertices>";
  for (const char* v : {R"(x="0" y="0" z="0")", R"(x="1" y="0" z="0")", R"(z="0" y="1" x="0")",
                        R"(x="0" y="0" z='1')"})
    text += "<vertex " + std::string(v) + "/>";
  text += "</vertices><triangles>";
  for (std::size_t t = 0; t < 4; ++t) {
    const glm::uvec3 corners = tetrahedron().triangles[t];
    text += "<triangle v1=\"" + std::to_string(corners.x) + "\" v2=\"" + std::to_string(corners.y) +
            "\" v3=\"" + std::to_string(corners.z) + "\" " +
            (properties.empty() ? "" : properties[t % properties.size()]) + "/>";
  }
  return text + "</triangles></mesh></object>";
}

constexpr const char* kColors =
    R"(<m:colorgroup id="7"><m:color color="#FF0000"/><m:color color="#00ff00FF"/><m:color color="#0000FF80"/></m:colorgroup>)";
constexpr const char* kMaterials =
    R"(<basematerials id="8"><base name="a &amp; b" displaycolor="#BCBCBC"/><base name="red" displaycolor="#FF0000"/></basematerials>)";

using Corners = std::array<glm::u8vec3, 3>;
const glm::u8vec3 kRed(255, 0, 0), kGreen(0, 255, 0), kBlue(0, 0, 255), kWhite(255);

class Read3mf : public MeshFolder {
 protected:
  SourceMesh read(const std::string& resources) const {
    return MeshFolder::read("a.3mf", package(model(resources)));
  }
};

TEST_F(Read3mf, ReadsTheSurfaceAndItsUnit) {
  const SourceMesh source = read(object(""));
  expectSameSurface(source.mesh, tetrahedron());
  EXPECT_EQ(source.coordinates.metersPerUnit, 0.0254);
  EXPECT_EQ(source.coordinates.up, 'z');
  EXPECT_TRUE(source.mesh.attributes.hasOnlyNormals());
  EXPECT_TRUE(source.warnings.empty());
}

TEST_F(Read3mf, CornersHaveColorsOfTheirTrianglesOrTheirObjects) {
  const SourceMesh source =
      read(kColors + object(R"(pid="7" pindex="2")", {R"(pid="7" p1="0" p2="1" p3="2")",
                                                      R"(p1="1")", "", R"(pid="7" p1="0")"}));
  const std::vector<Corners> expected{
      {kRed, kGreen, kBlue}, {kGreen, kGreen, kGreen}, {kBlue, kBlue, kBlue}, {kRed, kRed, kRed}};
  EXPECT_EQ(source.mesh.attributes.colors, expected);
  EXPECT_TRUE(source.appearance.materials.empty());
  EXPECT_TRUE(source.warnings.empty());
}

TEST_F(Read3mf, TrianglesWithoutAColorAreWhite) {
  const SourceMesh source = read(kColors + object("", {"", R"(pid="7" p1="1")"}));
  EXPECT_EQ(source.mesh.attributes.colors[0], (Corners{kWhite, kWhite, kWhite}));
  EXPECT_EQ(source.mesh.attributes.colors[1], (Corners{kGreen, kGreen, kGreen}));
  EXPECT_EQ(source.mesh.attributes.colors[2], (Corners{kWhite, kWhite, kWhite}));
}

TEST_F(Read3mf, BaseMaterialsAreMaterials) {
  const SourceMesh source =
      read(kMaterials + object(R"(pid="8" pindex="0")", {"", R"(pid="8" p1="1")"}));
  const std::vector<Material>& materials = source.appearance.materials;
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[0].name, "a & b");
  EXPECT_NEAR(materials[0].color.r, 0.5029, 1e-4);  // ((0xbc / 255 + 0.055) / 1.055)^2.4
  EXPECT_EQ(materials[1].name, "red");
  EXPECT_EQ(materials[1].color, glm::vec3(1, 0, 0));
  EXPECT_EQ(source.mesh.attributes.material, (std::vector<std::uint32_t>{0, 1, 0, 1}));
  EXPECT_TRUE(source.mesh.attributes.colors.empty());
}

TEST_F(Read3mf, TrianglesWithoutAMaterialHaveOneWithoutAName) {
  const SourceMesh source = read(kMaterials + object("", {R"(pid="8" p1="1")", ""}));
  ASSERT_EQ(source.appearance.materials.size(), 2u);
  EXPECT_EQ(source.appearance.materials[1].name, "");
  EXPECT_EQ(source.appearance.materials[1].color, glm::vec3(1));
  EXPECT_EQ(source.mesh.attributes.material, (std::vector<std::uint32_t>{0, 1, 0, 1}));
}

TEST_F(Read3mf, SaysWhichPropertiesAreLost) {
  const std::string groups =
      R"(<m:texture2dgroup id="2" texid="3"><m:tex2coord u="0" v="0"/></m:texture2dgroup>)"
      R"(<m:compositematerials id="4" matid="8" matindices="0 1"><m:composite values="0.5 0.5"/></m:compositematerials>)"
      R"(<m:multiproperties id="5" pids="7 8"><m:multi pindices="0 0"/></m:multiproperties>)";
  const SourceMesh source =
      read(kMaterials + groups +
           object(R"(pid="2" pindex="0")",
                  {"", R"(pid="4" p1="0")", R"(pid="5" p1="0")", R"(pid="99" p1="0")"}));
  EXPECT_EQ(source.warnings,
            (std::vector<std::string>{
                "a.3mf: the mixtures of materials (compositematerials) of 1 triangle are left out",
                "a.3mf: the layers of properties (multiproperties) of 1 triangle are left out",
                "a.3mf: the textures (texture2dgroup) of 1 triangle are left out",
                "a.3mf: the colors or materials of 1 triangle are left out: the file does not have "
                "them"}));
}

TEST_F(Read3mf, ComponentsAndItemsAreTransformedAndMirroredOnesStayOutside) {
  const std::string resources =
      kColors + object(R"(name="a &#x26; b")", {R"(pid="7" p1="0" p2="1" p3="2")"}, "2") +
      R"(<object id="1" name="both"><components><component objectid="2" transform="2 0 0 0 2 0 0 0 2 5 0 0"/>)"
      R"(<component objectid="2" transform="-1 0 0 0 1 0 0 0 1 -5 0 0"/></components></object>)";
  const SourceMesh source = read(resources);
  EXPECT_EQ(source.mesh.triangles.size(), 8u);
  EXPECT_EQ(openEdges(source.mesh), 0u);
  EXPECT_EQ(source.objects, (std::vector<std::string>{"a & b", "a & b"}));
  EXPECT_NEAR(volume(source.mesh), (8.0 + 1.0) / 6.0, 1e-12);
  EXPECT_EQ(bounds(source.mesh).min, glm::dvec3(-6, 0, 0));
  EXPECT_EQ(bounds(source.mesh).max, glm::dvec3(7, 2, 2));
  // A corner has its color where the mirror puts it.
  const auto colorsByCorner = [&](std::size_t t) {
    std::vector<std::pair<double, glm::u8vec3>> all;  // distance to the apex of the three axes
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 v = source.mesh.vertices[source.mesh.triangles[t][k]];
      const glm::dvec3 local = t < 4 ? (v - glm::dvec3(5, 0, 0)) / 2.0
                                     : (v + glm::dvec3(5, 0, 0)) * glm::dvec3(-1, 1, 1);
      all.emplace_back(glm::dot(local, glm::dvec3(1, 2, 3)),
                       source.mesh.attributes.colors[t][static_cast<std::size_t>(k)]);
    }
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    return all;
  };
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(colorsByCorner(t), colorsByCorner(t + 4)) << t;
}

TEST_F(Read3mf, ReadsOtherModelsOfThePackageAndNoPreviews) {
  const std::string root = model(
      R"(<object id="1"><components><component objectid="4" p:path="/3D/Objects/One.model"/></components></object>)");
  const std::string other = model(object("", {}, "4"), "");
  const std::string bytes = zip({{"Metadata/thumbnail.png", "\x89PNG"},
                                 {"_rels/.rels", kRels},
                                 {"3D/Objects/one.model", other},
                                 {"3D/part.model", root}});
  expectSameSurface(MeshFolder::read("b.3mf", bytes).mesh, tetrahedron());
  const std::string absent = zip({{"_rels/.rels", kRels}, {"3D/part.model", root}});
  EXPECT_EQ(refusal("b.3mf", absent),
            "b.3mf: refers to the model '3d/objects/one.model', which is not in it");
}

TEST_F(Read3mf, RefusesWhatContradictsItself) {
  const auto refused = [&](const std::string& text) { return refusal("a.3mf", package(text)); };
  const std::string whole = object("");
  EXPECT_EQ(refused(model(
                R"(<object id="1"><components><component objectid="1"/></components></object>)")),
            "a.3mf: has objects within objects without an end: object 1");
  EXPECT_EQ(refused(model(whole, R"(<item objectid="2"/>)")),
            "a.3mf: shows object 2, which its model '3d/part.model' does not have");
  EXPECT_EQ(refused(model(whole + whole)),
            "a.3mf: its model '3d/part.model' has two objects of the id 1");
  EXPECT_NE(refused(replaced(model(whole), R"(v1="1")", R"(v1="4")"))
                .find("has a triangle of vertex 4, its object has 4"),
            std::string::npos);
  EXPECT_NE(refused(replaced(model(whole), R"(x="1")", R"(x="one")"))
                .find("has a vertex whose x is 'one', a number is needed"),
            std::string::npos);
  EXPECT_NE(refused(replaced(model(kColors + whole), "#FF0000", "red")).find("#RRGGBB is needed"),
            std::string::npos);
  EXPECT_EQ(refusal("b.3mf", "PK\3\4").find("b.3mf: "), 0u);
  EXPECT_EQ(refusal("b.3mf", zip({{"a.txt", "x"}})), "b.3mf: has no model: it is no 3MF file");
}

// 2^40 copies of a triangle, or of nothing.
TEST_F(Read3mf, RefusesObjectsThatMultiplyWithoutMeasure) {
  for (const bool isEmpty : {false, true}) {
    std::string resources = isEmpty ? R"(<object id="100"/>)" : object("", {}, "100");
    for (int i = 99; i > 59; --i) {
      const std::string component = "<component objectid=\"" + std::to_string(i + 1) + "\"/>";
      resources += "<object id=\"" + std::to_string(i) + "\"><components>" + component + component +
                   "</components></object>";
    }
    const std::filesystem::path file =
        write("a.3mf", package(model(resources, R"(<item objectid="60"/>)")));
    EXPECT_THROW((void)readMesh(file, {.maxMemory = 100'000'000}), Error);
  }
}

// A tetrahedron shown 10^4 times.
std::string shownOften(const std::string& attributes) {
  std::string resources = object(attributes, {}, "5");
  for (int i = 4; i > 0; --i) {
    resources += "<object id=\"" + std::to_string(i) + "\"><components>";
    for (int k = 0; k < 10; ++k)
      resources += "<component objectid=\"" + std::to_string(i + 1) + "\"/>";
    resources += "</components></object>";
  }
  return package(model(resources));
}

TEST_F(Read3mf, NamesAreChargedAsOftenAsTheyAreShown) {
  const ReadOptions limit{.maxMemory = 12'000'000};
  const SourceMesh source = readMesh(write("a.3mf", shownOften(R"(name="n")")), limit);
  EXPECT_EQ(source.objects.size(), 10'000u);
  const std::string name(1000, 'n');  // 10 MB
  const std::filesystem::path file = write("b.3mf", shownOften("name=\"" + name + "\""));
  EXPECT_THROW((void)readMesh(file, limit), Error);
  EXPECT_EQ(readMesh(file).objects.back(), name);
}

TEST_F(Read3mf, LongNamesAreCutBetweenCharacters) {
  const auto named = [](const std::string& name) {
    return object("name=\"" + name + "\"") +
           R"(<object id="2"><components><component objectid="1"/><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/></components></object>)";
  };
  const auto readNamed = [&](const std::string& name) {
    return MeshFolder::read("a.3mf", package(model(named(name), R"(<item objectid="2"/>)")));
  };
  const std::string longest(1024, 'n');
  EXPECT_EQ(readNamed(longest).objects.at(1), longest);
  EXPECT_TRUE(readNamed(longest).warnings.empty());
  std::string text = "n", entities = "n";  // of two bytes each, an odd number before them
  for (int i = 0; i < 5000; ++i) text += "\u00e9", entities += "&#x000e9;";
  for (const std::string& name : {text, entities}) {
    const SourceMesh source = readNamed(name);
    EXPECT_EQ(source.objects.at(0), text.substr(0, 1023));
    EXPECT_EQ(source.warnings,
              std::vector<std::string>{"a.3mf: names of more than 1024 bytes are cut to that"});
  }
}

TEST_F(Read3mf, RefusesTagsOfMoreThanAThousandAttributes) {
  const auto item = [](std::size_t attributes) {
    std::string text = R"(<item objectid="1")";
    for (std::size_t i = 1; i < attributes; ++i) text += R"( a="")";
    return package(model(object(""), text + "/>"));
  };
  expectSameSurface(MeshFolder::read("a.3mf", item(1000)).mesh, tetrahedron());
  EXPECT_EQ(refusal("b.3mf", item(1001)),
            "b.3mf: its model '3d/part.model' has a tag of more than 1000 attributes");
}

// A comment of the same length takes no more than its text.
TEST_F(Read3mf, EmptyObjectsAndGroupsAreCharged) {
  const ReadOptions limit{.maxMemory = 2'000'000};
  for (const std::string tag : {"object", "colorgroup"}) {
    std::string empty;
    for (int i = 2; i < 20'000; ++i) empty += "<" + tag + " id=\"" + std::to_string(i) + "\"/>";
    const std::string comment = "<!--" + std::string(empty.size(), 'x') + "-->";
    EXPECT_NO_THROW((void)readMesh(write("a.3mf", package(model(comment + object("")))), limit));
    EXPECT_THROW((void)readMesh(write("b.3mf", package(model(empty + object("")))), limit), Error)
        << tag;
    EXPECT_NO_THROW((void)readMesh(write("b.3mf", package(model(empty + object(""))))));
  }
}

// Names of parts have no case; the first of a name counts.
TEST_F(Read3mf, MaterialsOfTwoModelsWithTheSameIdsAreTwo) {
  const std::string root = model(
      R"(<object id="1"><components><component objectid="1" p:path="/3D/A.model"/><component objectid="1" p:path="3d/b.model"/>)"
      R"(<component objectid="1" p:path="3D/a.MODEL"/></components></object>)");
  const auto other = [](const std::string& material) {
    return model(R"(<basematerials id="8"><base name=")" + material +
                     R"(" displaycolor="#FF0000"/></basematerials>)" +
                     object(R"(pid="8" pindex="0")"),
                 "");
  };
  const std::string bytes = zip({{"_rels/.rels", kRels},
                                 {"3D/part.model", root},
                                 {"3D/a.model", other("a")},
                                 {"3D/a.Model", other("second of its name")},
                                 {"3D/B.model", other("b")}});
  const SourceMesh source = MeshFolder::read("a.3mf", bytes);
  ASSERT_EQ(source.appearance.materials.size(), 2u);
  EXPECT_EQ(source.appearance.materials[0].name, "a");
  EXPECT_EQ(source.appearance.materials[1].name, "b");
  EXPECT_EQ(source.mesh.attributes.material,
            (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0}));
}

TEST_F(Read3mf, EntriesOfThePackageAreCharged) {
  std::vector<std::pair<std::string, std::string>> files;
  for (int i = 0; i < 10'000; ++i) files.emplace_back("f" + std::to_string(i), "");
  const std::string bytes = zip(files);
  MemoryBudget little("a.3mf", files.size() * sizeof(ZipEntry));
  EXPECT_THROW((void)zipEntries(bytes, "a.3mf", &little), Error);
  MemoryBudget enough("a.3mf", 10'000'000);
  EXPECT_EQ(zipEntries(bytes, "a.3mf", &enough).size(), files.size());
}

TEST_F(Read3mf, TakesTheFirstModelThatIsThereOfManyRelationships) {
  std::string rels = "<Relationships>";
  std::vector<std::pair<std::string, std::string>> files;
  for (int i = 0; i < 2000; ++i) {
    rels += "<Relationship Target=\"/none" + std::to_string(i) + "\" Type=\"x/3dmodel\"/>";
    files.emplace_back("f" + std::to_string(i), "");
  }
  rels += R"(<Relationship Target="/3D/OTHER.model" Type="x/3dmodel"/></Relationships>)";
  files.emplace_back("3D/3dmodel.model", "no model");
  files.emplace_back("3D/other.model", model(object("")));
  files.emplace_back("_rels/.rels", rels);
  expectSameSurface(MeshFolder::read("a.3mf", zip(files)).mesh, tetrahedron());
}

TEST_F(Read3mf, EveryPrefixOfAModelIsRefused) {
  const std::string whole = model(kMaterials + object(R"(pid="8" pindex="0")", {R"(p1="1")"}));
  const std::size_t end = whole.rfind("</model>") + std::string("</model>").size();
  for (std::size_t length = 0; length < end; ++length) {
    EXPECT_EQ(refusal("a.3mf", package(whole.substr(0, length))).find("a.3mf: "), 0u) << length;
  }
  const std::string bytes = package(whole);
  for (std::size_t length = 0; length < bytes.size(); length += 7)
    EXPECT_EQ(refusal("a.3mf", bytes.substr(0, length)).find("a.3mf: "), 0u) << length;
}

}  // namespace
}  // namespace sherd
