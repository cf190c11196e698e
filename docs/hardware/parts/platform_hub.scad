// Carries the platform on the upper of two 608 bearings. Printed with its flange on the bed.
// z = 0 is its lower end, where the pulley begins.
include <shapes.scad>

module platform_hub() {
  pocket = hub_height - nut_room_height - bearing_width;
  difference() {
    union() {
      disc(boss_diameter, hub_height);
      disc(hub_diameter, hub_flange, hub_height - hub_flange);
    }
    hole(bearing_seat, hub_height);
    disc(bearing_outer + fit, hub_height, pocket);
    at_quarters(joint_radius) hole(m3_core, joint_depth - 1);
    at_quarters(platform_screws_radius, 0) hole(m4_hole, hub_height);
  }
}


