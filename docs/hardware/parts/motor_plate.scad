// Holds the motor below the base; slots let it slide until the belt is tight. z = 0 is its lower side.
include <shapes.scad>

module motor_plate() {
  linear_extrude(height = motor_plate) difference() {
    offset(r = 5, $fn = facets) square(motor_plate_size - [10, 10], center = true);
    circle(d = motor_boss + 2 * loose, $fn = facets);
    at_corners([motor_screws, motor_screws]) circle(d = m3_hole, $fn = facets / 2);
    at_corners(motor_plate_screws) slot(2 * motor_travel, m4_hole);
  }
}
