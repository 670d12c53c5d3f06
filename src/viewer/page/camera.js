// A camera that orbits a point.  Units as in shaders.js, y upwards.

const FIELD = 30 * Math.PI / 180;  // of the height of the view

class Camera {
  constructor() {
    this.home();
  }

  home() {
    this.azimuth = 35 * Math.PI / 180;
    this.elevation = 20 * Math.PI / 180;
    this.target = [0, 0, 0];
    this.distance = 6;
    this.isFitted = true;  // until the reader zooms or pans
  }

  axes() {
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    const back = [sa * ce, se, ca * ce], right = [ca, 0, -sa];
    return {back, right, up: cross(back, right)};
  }

  eye() { return add(this.target, scale(this.axes().back, this.distance)); }

  // radius: of what is to be seen around the target; aspect: width / height of the free part of the view
  fit(radius, aspect) {
    const half = Math.atan(Math.tan(FIELD / 2) * Math.min(1, aspect));
    this.distance = radius / Math.sin(half);
  }

  view() {
    const {back, right, up} = this.axes();
    return lookFrom(this.eye(), right, up, back);
  }

  // rise: where the target is seen, as a share of half the height above the center of the view
  projection(aspect, radius, rise) {
    const reach = length(this.target) + radius + 0.5;
    const far = this.distance + reach, near = Math.max(this.distance - reach, far / 2000);
    const matrix = perspective(FIELD, aspect, near, far);
    matrix[9] = -rise;
    return matrix;
  }

  rotate(x, y) {
    this.azimuth -= x;
    this.elevation = clamp(this.elevation + y, -1.55, 1.55);
  }

  // Moves the target by a share of the height of the view.
  pan(x, y) {
    const {right, up} = this.axes(), height = 2 * this.distance * Math.tan(FIELD / 2);
    this.target = add(this.target, add(scale(right, -x * height), scale(up, y * height)));
    this.isFitted = false;
  }

  zoom(factor) {
    this.distance = clamp(this.distance * factor, 0.02, 400);
    this.isFitted = false;
  }

  // Units of a pixel at the target.
  unitsPerPixel(height) { return 2 * this.distance * Math.tan(FIELD / 2) / height; }
}
