// Integer distances between voxels.  The host fills in a metric, kernels evaluate it.
//
// A metric is a kind (squared euclidean, chebyshev, manhattan) and an integer 3x3 matrix that multiplies the difference
// first: the identity, or SHERD_ANISOTROPY_ONE times a stretch for anisotropic growth.  A distance has 64 bits; shifted
// right by `shift` (0 for the identity) it fits 32 bits in a box of 4096 voxels.
#ifndef SHERD_VOXEL_METRIC_H
#define SHERD_VOXEL_METRIC_H

#define SHERD_EUCLIDEAN 0
#define SHERD_CHEBYSHEV 1
#define SHERD_MANHATTAN 2
#define SHERD_ANISOTROPY_ONE 64
#define SHERD_SEED_BITS 6  // points of seeds are in 1/64 voxel

struct sherd_metric {
  int kind;
  int shift;
  int row[9];  // the matrix, row by row
};

#ifdef __OPENCL_VERSION__

// Returns row i of the matrix times a difference.
inline long sherd_row(const struct sherd_metric* metric, const int i, const long x, const long y, const long z) {
  return metric->row[3 * i] * x + metric->row[3 * i + 1] * y + metric->row[3 * i + 2] * z;
}

// Returns the distance for a transformed difference with absolute values a, b, c; monotone in each.
inline long sherd_norm(const int kind, const long a, const long b, const long c) {
  if (kind == SHERD_EUCLIDEAN) return a * a + b * b + c * c;
  if (kind == SHERD_MANHATTAN) return a + b + c;
  return max(max(a, b), c);
}

// Calls max and abs instead of comparing: a compiler turns comparisons into llvm.smax and llvm.abs, which oclgrind does
// not implement.
inline long sherd_distance(const struct sherd_metric* metric, const int x, const int y, const int z) {
  const long a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z),
             c = sherd_row(metric, 2, x, y, z);
  return sherd_norm(metric->kind, (long)abs(a), (long)abs(b), (long)abs(c));
}

#endif  // __OPENCL_VERSION__

#endif
