// Holds a square USB camera module at the camera's pitch, for M2 screws. z = 0 is the laser board's front; z points to the
// platform, x up.
include <shapes.scad>

module along_camera() {
  translate([0, 0, camera_from_board]) rotate([0, -camera_pitch, 0]) children();
}

module camera_holder() {
  face = camera_board + 4;
  difference() {
    union() {
      plate([face + 6, camera_screws_apart + 18, 5], 5);
      hull() {
        translate([0, 0, 4]) cube([face, face, 1], center = true);
        along_camera() cube([face, face, camera_face], center = true);
      }
    }
    // The cable and its plug leave the hollow downwards and through the sides.
    hull() {
      translate([0, 0, 7]) cube([face - 18, face - 18, 4], center = true);
      along_camera() cube([face - 18, face - 18, camera_face + 1], center = true);
    }
    translate([-face, -10, 8]) cube([face, 20, 18]);
    along_camera() for (side = camera_screws) at_corners([side, side])
      translate([0, 0, -8]) cylinder(d = m2_core, h = 20, $fn = 16);
    for (y = [-1, 1]) hole(m6_hole, 5, [0, y * camera_screws_apart / 2]);
  }
}
