// Shapes that several parts share.
include <../parameters.scad>

module disc(diameter, height, z = 0) {
  translate([0, 0, z]) cylinder(d = diameter, h = height, $fn = facets);
}

module hole(diameter, height, at = [0, 0], z = -1) {
  translate([at.x, at.y, z]) cylinder(d = diameter, h = height + 2, $fn = facets / 2);
}

/// At the four corners of a rectangle of this size.
module at_corners(size) {
  for (x = [-1, 1], y = [-1, 1]) translate([x * size.x / 2, y * size.y / 2, 0]) children();
}

/// At four places round the axis, the first of them `from` degrees from x.
module at_quarters(radius, from = 45) {
  for (i = [0:3]) rotate(from + 90 * i) translate([radius, 0, 0]) children();
}

/// A plate in the middle of x and y, with its corners rounded.
module plate(size, radius = 6) {
  linear_extrude(height = size.z) offset(r = radius, $fn = facets)
    square([size.x - 2 * radius, size.y - 2 * radius], center = true);
}

/// A slot along x, cut from a 2D shape or extruded.
module slot(length, width) {
  hull() for (x = [-1, 1]) translate([x * length / 2, 0]) circle(d = width, $fn = facets / 2);
}
