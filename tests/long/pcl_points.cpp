// The Point Cloud Library's own reading and writing of .binp files, for tools/test_long.sh.
//
// usage: pcl_points decode IN.binp            points as text to standard output, a line "x y z"
// each
//        pcl_points encode OUT.binp < POINTS   the same text as a .binp with voxels of 1e-4
#include <pcl/compression/octree_pointcloud_compression.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Codec = pcl::io::OctreePointCloudCompression<pcl::PointXYZ>;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string mode = argv[1];
  Cloud::Ptr cloud(new Cloud);
  if (mode == "decode") {
    std::ifstream in(argv[2], std::ios::binary);
    Codec codec;
    codec.decodePointCloud(in, cloud);
    for (const pcl::PointXYZ& p : *cloud) std::printf("%.9g %.9g %.9g\n", p.x, p.y, p.z);
    return cloud->empty();
  }
  for (pcl::PointXYZ p; std::cin >> p.x >> p.y >> p.z;) cloud->push_back(p);
  // As the paper's authors call it: one whole frame of voxels' centers without colors.
  Codec codec(pcl::io::MANUAL_CONFIGURATION, false, 1e-4f, 1e-4, true, 1, false, 8);
  std::ofstream out(argv[2], std::ios::binary);
  codec.encodePointCloud(cloud, out);
  return out.good() ? 0 : 1;
}
