// Distances between voxels as integers.  The host fills metrics in, devices measure by them.
//
// A metric is a kind (euclidean squared, chebyshev, manhattan) and an integer matrix that the difference is multiplied
// by first: the identity, or SHERD_GRAIN_ONE times a stretching for anisotropic growth.  A distance is 64 bits wide;
// shifted right by `shift` (0 for the identity) it fits 32 bits in a box of 4096 voxels.
#ifndef SHERD_VOXEL_METRIC_H
#define SHERD_VOXEL_METRIC_H

#define SHERD_EUCLIDEAN 0
#define SHERD_CHEBYSHEV 1
#define SHERD_MANHATTAN 2
#define SHERD_GRAIN_ONE 64

// Rows of the matrix.
struct sherd_metric {
  int kind;
  int shift;
  int row[9];
};

#ifdef __OPENCL_VERSION__

// One row of the matrix times a difference.
inline long sherd_row(const struct sherd_metric* metric, const int i, const long x, const long y, const long z) {
  return metric->row[3 * i] * x + metric->row[3 * i + 1] * y + metric->row[3 * i + 2] * z;
}

// The distance of a stretched difference of absolute values a, b, c: it grows with each.
inline long sherd_norm(const int kind, const long a, const long b, const long c) {
  if (kind == SHERD_EUCLIDEAN) return a * a + b * b + c * c;
  if (kind == SHERD_MANHATTAN) return a + b + c;
  return max(max(a, b), c);
}

// max and abs are called, not written as comparisons: a compiler makes llvm.smax and llvm.abs of those, which oclgrind
// does not know.
inline long sherd_distance(const struct sherd_metric* metric, const int x, const int y, const int z) {
  const long a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z),
             c = sherd_row(metric, 2, x, y, z);
  return sherd_norm(metric->kind, (long)abs(a), (long)abs(b), (long)abs(c));
}

#endif  // __OPENCL_VERSION__

#endif
