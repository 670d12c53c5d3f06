// An octave of the noise of a rough crack.  The host fills in the octaves, coarsest first, kernels evaluate them.
#ifndef SHERD_NOISE_OCTAVE_H
#define SHERD_NOISE_OCTAVE_H

struct sherd_octave {
  long step[3];   // spacings per voxel of its lattice along x, y and z, in units of 2^-32, at most 2^31
  int amplitude;  // 1/256 voxel, the largest lattice value
  int number;     // octave k has a least spacing of S / 2^k
};

#endif
