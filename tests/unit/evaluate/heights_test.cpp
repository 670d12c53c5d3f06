// The correlation of heights on surfaces whose Hurst exponents are known.
#include "evaluate/cracks/heights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

namespace sherd {
namespace {

// Discrete Fourier transform of a line, in place; a power of two long.
void transform(std::vector<std::complex<double>>& line) {
  const std::size_t n = line.size();
  for (std::size_t i = 1, k = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; k & bit; bit >>= 1) k ^= bit;
    k ^= bit;
    if (i < k) std::swap(line[i], line[k]);
  }
  std::vector<std::complex<double>> root(n);
  for (std::size_t k = 0; k < n; ++k) {
    root[k] =
        std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    for (std::size_t start = 0; start < n; start += length) {
      for (std::size_t k = 0; k < length / 2; ++k) {
        const auto a = line[start + k], b = root[k * (n / length)] * line[start + k + length / 2];
        line[start + k] = a + b;
        line[start + k + length / 2] = a - b;
      }
    }
  }
}

// A self-affine surface by spectral synthesis.  Where C(du, 0) ~ du^a and C(0, dv) ~ dv^b, the
// spectrum is homogeneous: (|ku|^2a + |kv|^2b)^-(1 + 1/2a + 1/2b).  A quarter of a periodic field
// is used, so that it has waves longer than itself.
HeightGrid selfAffine(int side, double a, double b, std::uint64_t seed) {
  const auto n = static_cast<std::size_t>(2 * side);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::vector<std::complex<double>>> rows(n, std::vector<std::complex<double>>(n));
  const auto wave = [&](std::size_t i) { return static_cast<double>(std::min(i, n - i)); };
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t u = 0; u < n; ++u) {
      const double k = std::pow(wave(u), 2.0 * a) + std::pow(wave(v), 2.0 * b);
      const double amplitude = k > 0.0 ? std::pow(k, -0.5 * (1.0 + 0.5 / a + 0.5 / b)) : 0.0;
      rows[v][u] = amplitude * std::complex<double>(normal(random), normal(random));
    }
  }
  for (auto& row : rows) transform(row);
  for (std::size_t u = 0; u < n; ++u) {
    std::vector<std::complex<double>> column(n);
    for (std::size_t v = 0; v < n; ++v) column[v] = rows[v][u];
    transform(column);
    for (std::size_t v = 0; v < n; ++v) rows[v][u] = column[v];
  }
  HeightGrid grid{side, side, 1.0, {}, {}};
  for (std::size_t v = 0; v < n / 2; ++v) {
    for (std::size_t u = 0; u < n / 2; ++u)
      grid.height.push_back(static_cast<float>(rows[v][u].real()));
  }
  return grid;
}

HeightGrid transposed(const HeightGrid& grid) {
  HeightGrid result{grid.down, grid.across, grid.spacing, {}, {}};
  for (int u = 0; u < grid.across; ++u) {
    for (int v = 0; v < grid.down; ++v) result.height.push_back(grid.at(u, v));
  }
  return result;
}

// A slope over less than a decade of a finite surface is low for a high exponent, and high for a
// low one, by some hundredths.
TEST(Heights, HaveTheHurstExponentsOfTheirTwoDirections) {
  constexpr int kSurfaces = 4;
  for (const auto& [a, b] : {std::pair(0.75, 0.6), {0.8, 0.8}, {0.4, 0.4}, {0.6, 0.75}}) {
    double along = 0.0, across = 0.0;
    for (int k = 0; k < kSurfaces; ++k) {
      const HeightGrid grid = selfAffine(512, a, b, static_cast<std::uint64_t>(k));
      along += *correlationAlong(grid).slope / kSurfaces;
      across += *correlationAlong(transposed(grid)).slope / kSurfaces;
    }
    EXPECT_NEAR(along, a, 0.06) << a << ", " << b;
    EXPECT_NEAR(across, b, 0.06) << a << ", " << b;
  }
}

// Short cracks too: those of 30 to 60 nodes, over the plane that fits them best.
TEST(Heights, OfShortCracksHaveTheirExponentsToo) {
  constexpr int kSurfaces = 200;
  for (const double exponent : {0.4, 0.6, 0.8}) {
    for (const int side : {32, 64}) {
      double mean = 0.0;
      for (int k = 0; k < kSurfaces; ++k) {
        const HeightGrid grid = selfAffine(side, exponent, exponent, static_cast<std::uint64_t>(k));
        const auto slope = correlationAlong(grid).slope;
        ASSERT_TRUE(slope);
        mean += *slope / kSurfaces;
      }
      EXPECT_NEAR(mean, exponent, side == 32 ? 0.15 : 0.07) << side;
    }
  }
}

// A plane rises by its slope: C(d) is proportional to d.  Neither it nor a parabola has second
// differences that vary, so the tilt and the bend of a crack change no exponent.
TEST(Heights, OfAPlaneAndAParabolaHaveNoExponent) {
  HeightGrid plane{200, 50, 0.5, {}, {}}, parabola{60, 30, 1.0, {}, {}};
  for (int v = 0; v < plane.down; ++v) {
    for (int u = 0; u < plane.across; ++u) plane.height.push_back(0.25f * static_cast<float>(u));
  }
  for (int v = 0; v < parabola.down; ++v) {
    for (int u = 0; u < parabola.across; ++u) {
      parabola.height.push_back(static_cast<float>(u * u + 7 * u - 3 * v));
    }
  }
  const Correlation found = correlationAlong(plane);
  EXPECT_FALSE(found.slope);
  EXPECT_FALSE(correlationAlong(parabola).slope);
  for (std::size_t i = 0; i < found.lags.size(); ++i) {
    EXPECT_NEAR(found.values[i], 0.5 * found.lags[i], 1e-9);
  }
}

TEST(Heights, OfFewerThanThirtyNodesHaveNoExponent) {
  HeightGrid grid = selfAffine(32, 0.8, 0.8, 1);
  EXPECT_TRUE(correlationAlong(grid).slope);
  HeightGrid shorter{29, 32, 1.0, {}, {}};
  for (int v = 0; v < 32; ++v) {
    for (int u = 0; u < 29; ++u) shorter.height.push_back(grid.at(u, v));
  }
  EXPECT_FALSE(correlationAlong(shorter).slope);
}

// A saddle x y over the plane z = 0, of triangles: nodes of the grid are its corners.
TEST(Heights, AreThoseOfTheTriangles) {
  constexpr int kSide = 20;
  TriangleMesh mesh;
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) mesh.vertices.emplace_back(x, y, 0.1 * x * y);
  }
  std::vector<std::uint32_t> all;
  for (unsigned y = 0; y < kSide; ++y) {
    for (unsigned x = 0; x < kSide; ++x) {
      const unsigned i = y * (kSide + 1) + x;
      mesh.triangles.emplace_back(i, i + 1, i + kSide + 2);
      mesh.triangles.emplace_back(i, i + kSide + 2, i + kSide + 1);
    }
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) all.push_back(t);
  const auto grid = heightsOver(mesh, all, {{0, 0, 1}, 2.0}, {1, 0, 0}, 1.0);
  ASSERT_TRUE(grid);
  ASSERT_EQ(grid->across, kSide + 1);
  ASSERT_EQ(grid->down, kSide + 1);
  for (int v = 0; v <= kSide; ++v) {
    for (int u = 0; u <= kSide; ++u) EXPECT_NEAR(grid->at(u, v), 0.1 * u * v - 2.0, 1e-5);
  }
  EXPECT_FALSE(heightsOver(mesh, all, {{0, 0, 1}, 0.0}, {1, 0, 0}, 1e-6));  // too many nodes
}

}  // namespace
}  // namespace sherd
