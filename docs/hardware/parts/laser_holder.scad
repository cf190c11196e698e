// Clamps a laser module so that it looks at the platform's axis: side is 1 for the left one, -1 for the right one, seen
// from the platform. z = 0 is the laser board's front; z points to the platform, x up.
include <shapes.scad>

module along_laser(side) {
  translate([0, 0, laser_from_board]) rotate([side * laser_azimuth, 0, 0]) rotate([0, -laser_pitch, 0]) children();
}

module laser_holder(side) {
  outer = laser_module + 2 * wall + 2;
  ahead = laser_clamp_length / 2 + 4;
  difference() {
    union() {
      plate(laser_plate, 5);
      hull() {
        disc(outer + 8, 1, laser_plate.z - 1.5);
        along_laser(side) disc(outer, 10, ahead - 10);
      }
      along_laser(side) translate([0, -4.5, ahead - 12]) cube([outer / 2 + 9, 9, 12]);
    }
    along_laser(side) {
      // Through, so that the wires leave at the back.
      disc(laser_module + fit, 3 * laser_clamp_length, -26);
      translate([0, -1, -2]) cube([outer, 2, laser_clamp_length]);
      translate([outer / 2 + 4.5, 10, ahead - 6]) rotate([90, 0, 0]) {
        cylinder(d = m3_core, h = 20, $fn = facets / 2);
        cylinder(d = m3_hole, h = 10, $fn = facets / 2);
      }
    }
    for (x = [-1, 1]) hole(m6_hole, laser_plate.z, [x * laser_screws / 2, 0]);
  }
}
