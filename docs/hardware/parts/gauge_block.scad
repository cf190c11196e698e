// A body of known sizes, to scan on the first day: three different lengths and a cylinder. Measure it with calipers.
include <shapes.scad>

module gauge_block() {
  translate([0, 0, gauge.z / 2]) cube(gauge, center = true);
  disc(gauge_cylinder, gauge_cylinder_height + 1, gauge.z - 1);
}
