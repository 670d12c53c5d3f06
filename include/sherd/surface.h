// How fragments get their surfaces.
#pragma once

namespace sherd {

/// How the surface between two fragments is made.
enum class Interface {
  shared,  ///< one mesh of all fragments at once: what two share is the same vertices and faces,
           ///< bit for bit, seen from both sides
  independent  ///< each fragment's level set meshed by itself, as OpenVDB would
};

struct SurfaceOptions {
  Interface interface = Interface::shared;
};

}  // namespace sherd
