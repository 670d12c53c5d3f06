// Sherd breaks 3D models: mesh -> solid -> labels -> fragments -> files.  This header includes the
// whole library.
#pragma once

#include <sherd/appearance.h>
#include <sherd/coords.h>
#include <sherd/dataset.h>
#include <sherd/device.h>
#include <sherd/erode.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/fit.h>
#include <sherd/fracture.h>
#include <sherd/fragments.h>
#include <sherd/io.h>
#include <sherd/kernel_cache.h>
#include <sherd/labels.h>
#include <sherd/leaf_blocks.h>
#include <sherd/memory.h>
#include <sherd/memory_estimate.h>
#include <sherd/mesh.h>
#include <sherd/mesh_files.h>
#include <sherd/mesh_quality.h>
#include <sherd/metric.h>
#include <sherd/point_files.h>
#include <sherd/points.h>
#include <sherd/progress.h>
#include <sherd/read_options.h>
#include <sherd/refracture.h>
#include <sherd/render.h>
#include <sherd/seeds.h>
#include <sherd/shares.h>
#include <sherd/solid.h>
#include <sherd/surface.h>
#include <sherd/vdb_files.h>
#include <sherd/version.h>
#include <sherd/volume.h>
#include <sherd/voxel_files.h>
