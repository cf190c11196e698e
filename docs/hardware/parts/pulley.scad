// The platform's GT2 pulley, with the lower bearing. Printed upside down. z = 0 is its lower end.
include <shapes.scad>

outer_diameter = pitch_diameter_platform - 2 * pitch_line;

/// The gap for one tooth of the belt: a round bottom and straight sides, at the radius of the teeth's tips.
module tooth_gap() {
  translate([outer_diameter / 2 - tooth_depth + tooth_radius, 0]) {
    circle(r = tooth_radius, $fn = 16);
    translate([0, -tooth_radius]) square([1, 2 * tooth_radius]);
  }
}

module teeth() {
  difference() {
    circle(d = outer_diameter, $fn = 3 * platform_teeth);
    for (i = [0:platform_teeth - 1]) rotate(360 / platform_teeth * i) tooth_gap();
  }
}

module joints(diameter) {
  at_quarters(joint_radius) circle(d = diameter, $fn = facets / 2);
}

module layer(z, height) {
  translate([0, 0, z]) linear_extrude(height = height) children();
}

/// Every layer is drawn in the plane and extruded, and overlaps its neighbour by the same outline.
module pulley() {
  flange_diameter = outer_diameter + 2 * pulley_overhang;
  difference() {
    union() {
      layer(0, pulley_height) teeth();
      disc(flange_diameter, pulley_flange);
      disc(flange_diameter, pulley_flange, pulley_height - pulley_flange);
    }
    hole(bearing_seat, pulley_height);
    disc(bearing_outer + fit, bearing_width + 1, -1);
    layer(-1, pulley_height + 2) joints(m3_hole);
    layer(-1, m3_head_height + 1) joints(m3_head);
  }
}
