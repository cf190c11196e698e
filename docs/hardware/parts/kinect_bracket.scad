// Keeps a Kinect's foot in a fence, and its head at the sensor's pitch by two braces: its motor is too soft to hold
// still. A strap through the slots presses the head on the braces, with foam between. z = 0 is the shelf's top.
include <shapes.scad>

/// Side view of a brace, x and z: a column whose top is the head's underside, less the foam.
module brace_side() {
  run = 44;
  rise = run * tan(sensor_pitch);
  // The head's underside meets the foot's middle this high above the plate.
  middle = kinect_plate + head_above_foot - (kinect_head.z / 2 + kinect_pad) / cos(sensor_pitch);
  polygon([[-run / 2, 0], [run / 2, 0], [run / 2, middle + rise / 2], [-run / 2, middle - rise / 2]]);
}

module brace() {
  translate([0, kinect_brace_width / 2, 0]) rotate([90, 0, 0])
    linear_extrude(height = kinect_brace_width) difference() {
      brace_side();
      translate([0, kinect_plate + 5]) slot(strap.y - 8, 8);
    }
}

module kinect_bracket(model) {
  foot = kinect_foot(model) + [2 * loose, 2 * loose];
  linear_extrude(height = kinect_plate) difference() {
    offset(r = 6, $fn = facets) square(kinect_plate_size - [12, 12], center = true);
    at_corners(kinect_plate_screws) circle(d = m6_hole, $fn = facets / 2);
  }
  linear_extrude(height = kinect_plate + kinect_fence) difference() {
    square(foot + [2 * wall, 2 * wall], center = true);
    square(foot, center = true);
    translate([foot.x / 2 - 1, -kinect_cable / 2]) square([wall + 2, kinect_cable]);
  }
  for (side = [-1, 1]) translate([0, side * kinect_brace_at, 0]) brace();
}
