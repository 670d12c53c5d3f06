// What options say of a mesh's coordinates.
#include <sherd/options.h>

namespace sherd {

CoordinateSystem coordinatesOf(const CoordinateSystem& read, const WriteOptions& write) {
  CoordinateSystem coordinates = read;
  if (write.metersPerUnit) {
    coordinates.metersPerUnit = *write.metersPerUnit;
    coordinates.unitFrom = CoordinateBasis::option;
  }
  if (write.up) {
    coordinates.up = *write.up;
    coordinates.upFrom = CoordinateBasis::option;
  }
  return coordinates;
}

}  // namespace sherd
