// Carries the Raspberry Pi and a 5 x 7 cm board with the motor's driver; screwed to the base. z = 0 is its lower side.
include <shapes.scad>

pi_at = [-38, 0];
driver_at = [50, 0];

module post(core) {
  difference() {
    disc(6, standoff + 1, electronics.z - 1);
    hole(core, standoff, z = electronics.z + 1);
  }
}

module electronics_plate() {
  linear_extrude(height = electronics.z) difference() {
    offset(r = 5, $fn = facets) square([electronics.x - 10, electronics.y - 10], center = true);
    at_corners([electronics.x - 12, electronics.y - 12]) circle(d = m4_hole, $fn = facets / 2);
    for (x = [-60, -20, 30, 70], y = [-1, 1]) translate([x, y * (electronics.y / 2 - 8)]) slot(6, 3);
    translate(pi_at) square([pi_screws.x - 20, pi_screws.y - 18], center = true);
    translate(driver_at) square([perfboard_screws.y - 18, perfboard_screws.x - 24], center = true);
  }
  translate(pi_at) at_corners(pi_screws) post(m25_core);
  translate(driver_at) at_corners([perfboard_screws.y, perfboard_screws.x]) post(m25_core);
}
