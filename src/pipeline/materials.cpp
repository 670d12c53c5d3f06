// Presets of materials.  docs/materials.md has the source of each value.
#include <sherd/fracture.h>

namespace sherd {
namespace {

// How pieces of brittle solids break: one after another, so that a crack ends at an older one.
constexpr Growth kInOrder = Growth::sequential;

// The axis along which the grain of wood stands, and cracks propagate.
constexpr glm::dvec3 kUp{0.0, 1.0, 0.0};

// Resets what materials set.
void setDefaults(FractureOptions& options) {
  const FractureOptions usual;
  options.grow.growth = kInOrder;
  options.grow.anisotropy = usual.grow.anisotropy;
  options.grow.split = usual.grow.split;
  options.grow.roughness = usual.grow.roughness;
  options.grow.hurst = usual.grow.hurst;
  options.grow.roughnessWindow = usual.grow.roughnessWindow;
  options.grow.propagationHurst = usual.grow.propagationHurst;
  options.grow.propagation = usual.grow.propagation;
  options.shares.sizes = usual.shares.sizes;
  options.shares.sizeParameter = usual.shares.sizeParameter;
  options.erode = usual.erode;
}

// Cracks with an rms height of so many percent of the longest side.
void setRelief(GrowOptions& grow, double percent, double hurst) {
  grow.roughness = Length::ofSide(percent);
  grow.hurst = hurst;
}

// Another Hurst exponent along the up axis.
void setRelief(GrowOptions& grow, double percent, double hurst, double upHurst) {
  setRelief(grow, percent, hurst);
  grow.propagationHurst = upHurst;
  grow.propagation = kUp;
}

// Wear of cracks, deepest at their edges and corners; the original surface stays.
void setWear(ErodeOptions& erode, double depthPercent, double sizePercent, double threshold,
             double probability) {
  erode.iterations = Length::ofSide(depthPercent);
  erode.size = Length::ofSide(sizePercent);
  erode.threshold = threshold;
  erode.probability = probability;
}

}  // namespace

FractureOptions materialOptions(MaterialPreset material, FractureOptions options) {
  if (material == MaterialPreset::none) return options;
  setDefaults(options);
  options.material = material;
  GrowOptions& grow = options.grow;
  switch (material) {
    case MaterialPreset::none:
      break;
    case MaterialPreset::ceramic:
      setRelief(grow, 0.7, 0.8);
      break;
    case MaterialPreset::stone:
      setRelief(grow, 1.0, 0.8);
      break;
    case MaterialPreset::glass:
      grow.split = {.power = 1.0, .offset = 0.25, .tilt = 60.0};
      options.shares.sizes = Sizes::lognormal;
      options.shares.sizeParameter = 0.8;
      break;
    case MaterialPreset::tempered:
      grow.growth = Growth::euclid;
      options.shares.sizes = Sizes::exponential;
      break;
    case MaterialPreset::plaster:
      setRelief(grow, 0.4, 0.8);
      setWear(options.erode, 1.2, 3.0, 0.6, 1.0);
      options.erode.on = ErodeOn::rims;
      break;
    case MaterialPreset::wood:
      setRelief(grow, 0.8, 0.5, 1.0);
      grow.anisotropy = {kUp, 7.0};
      break;
    case MaterialPreset::concrete:
      setRelief(grow, 0.32, 0.75, 0.6);
      grow.roughnessWindow = Length::ofSide(2.0);
      setWear(options.erode, 1.2, 3.0, 0.75, 0.35);
      break;
    case MaterialPreset::ice:
      setRelief(grow, 2.0, 1.0);
      break;
  }
  return options;
}

}  // namespace sherd
