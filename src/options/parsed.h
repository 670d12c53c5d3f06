// Values of options with a syntax of their own.
#pragma once

#include <sherd/options.h>

#include <string>

namespace sherd {

/// K, or Kn for K per fragment.
void setExtraSeeds(SeedOptions& seeds, const std::string& text);
[[nodiscard]] std::string extraSeedsText(const SeedOptions& seeds);

/// x,y,z[,count[,sigma]][,merge], or ray:ox,oy,oz,dx,dy,dz[,...].  Sigma is a standard
/// deviation in world units, or a bias as n=5.
[[nodiscard]] Impact impactFrom(const std::string& text);
[[nodiscard]] std::string impactText(const Impact& impact);

/// dx,dy,dz,strength, or none
void setGrain(Anisotropy& grain, const std::string& text);
[[nodiscard]] std::string grainText(const Anisotropy& grain);

/// dx,dy,dz
void setDirection(Anisotropy& grain, const std::string& text);
[[nodiscard]] std::string directionText(const Anisotropy& grain);

/// grown, uniform, exponential, lognormal:s or power:t
void setSizes(ShareOptions& shares, const std::string& text);
[[nodiscard]] std::string sizesText(const ShareOptions& shares);

/// r, r,H or r,H,W; parts that are omitted get their defaults
void setRoughness(GrowOptions& grow, const std::string& text);
[[nodiscard]] std::string roughnessText(const GrowOptions& grow);

/// dx,dy,dz,H, or none
void setPropagation(GrowOptions& grow, const std::string& text);
[[nodiscard]] std::string propagationText(const GrowOptions& grow);

/// dx,dy,dz
void setPropagationDirection(GrowOptions& grow, const std::string& text);
[[nodiscard]] std::string propagationDirectionText(const GrowOptions& grow);

/// A whole number of fragments, or a share below 1.
void setMissing(double& missing, const std::string& text);

/// K, or Fk for F times the voxels along the longest side.
void setIterations(Iterations& iterations, const std::string& text);
[[nodiscard]] std::string iterationsText(const Iterations& iterations);

/// Names of files, separated by commas.
void setWritten(WriteOptions& write, const std::string& text);
[[nodiscard]] std::string writtenText(const WriteOptions& write);
[[nodiscard]] std::vector<std::string> writtenNames();

/// P%, P%,H or P%,H,W% of the diagonal; parts that are omitted get their defaults
void setNoise(NoiseOptions& noise, const std::string& text);
[[nodiscard]] std::string noiseText(const NoiseOptions& noise);

/// Numbers of triangles, separated by commas.
void setTriangles(std::vector<std::size_t>& triangles, const std::string& text);
[[nodiscard]] std::string trianglesText(const std::vector<std::size_t>& triangles);

}  // namespace sherd
