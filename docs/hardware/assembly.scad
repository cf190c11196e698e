// The rig put together: view is "kinect", "laser" or "drive", the drive cut open and pulled apart.
include <boards.scad>
use <parts/shapes.scad>
use <parts/platform_hub.scad>
use <parts/pulley.scad>
use <parts/motor_plate.scad>
use <parts/kinect_bracket.scad>
use <parts/electronics_plate.scad>
use <parts/laser_holder.scad>
use <parts/camera_holder.scad>

view = "kinect";

module wood() color([0.87, 0.74, 0.55]) children();
module dark_wood() color([0.80, 0.66, 0.47]) children();
module printed() color([0.16, 0.47, 0.55]) children();
module steel() color([0.72, 0.74, 0.77]) children();
module black() color([0.16, 0.17, 0.19]) children();

/// Stands a board that lies on z = 0 upright: its y becomes z, and its front is at y = 0.
module upright() rotate([90, 0, 0]) children();

module bearing() steel() difference() {
  disc(bearing_outer, bearing_width);
  hole(bearing_bore, bearing_width);
}

module nut(height) difference() {
  cylinder(d = 15, h = height, $fn = 6);
  hole(bearing_bore, height);
}

module base() {
  wood() translate([-base_axis.x, -base_axis.y, -board]) board_flat("Base");
  for (side = [-1, 1]) dark_wood()
    translate([-base_axis.x, side * (base_width / 2 - rail_inset) + board / 2, -board - rail_height])
      upright() board_flat("Rail");
}

module motor() {
  black() translate([-motor_side / 2, -motor_side / 2, -motor_length]) cube([motor_side, motor_side, motor_length]);
  steel() disc(motor_boss, motor_boss_height);
  steel() disc(motor_shaft, motor_shaft_length);
}

module motor_pulley() {
  steel() disc(pitch_diameter_motor, motor_pulley_height);
  steel() disc(motor_pulley_diameter, 1, 0);
  steel() disc(motor_pulley_diameter, motor_pulley_height - 8, 8);
}

module belt() {
  module path(more) hull() {
    circle(d = pitch_diameter_platform + more, $fn = 90);
    translate([-axes, 0]) circle(d = pitch_diameter_motor + more, $fn = 60);
  }
  black() translate([0, 0, belt_middle - belt_width / 2]) linear_extrude(height = belt_width) difference() {
    path(1.5);
    path(-0.2);
  }
}

/// The lifts pull the drive apart: of the pulley, the hub and the platform.
module drive(lift = 0) {
  steel() {
    translate([0, 0, -board - m8_washer - 5.3]) cylinder(d = 15, h = 5.3, $fn = 6);
    disc(16, m8_washer, -board - m8_washer);
    disc(bearing_bore, axle_length, -board - m8_washer);
    disc(16, m8_washer);
    translate([0, 0, m8_washer]) nut(m8_nut);
  }
  translate([0, 0, pulley_bottom + lift]) {
    if (lift > 0) translate([0, 0, -lift / 3]) bearing(); else bearing();
    printed() pulley();
  }
  translate([0, 0, hub_bottom + 2 * lift]) {
    printed() platform_hub();
    translate([0, 0, hub_height - nut_room_height - bearing_width + lift]) {
      bearing();
      steel() translate([0, 0, bearing_width + lift / 2]) nut(m8_lock_nut);
    }
  }
  wood() translate([0, 0, platform_bottom + 4.6 * lift]) board_flat("Platform");
  translate([-axes, 0, 0]) {
    motor();
    printed() translate([0, 0, lift / 3]) motor_plate();
    translate([0, 0, belt_middle - motor_pulley_belt + lift]) motor_pulley();
  }
  translate([0, 0, lift]) belt();
}

module kinect() {
  black() translate([head_middle_x, 0, head_middle_z]) rotate([0, -sensor_pitch, 0])
    cube(kinect_head, center = true);
  steel() translate([head_middle_x, 0, head_middle_z]) rotate([0, -sensor_pitch, 0])
    for (y = [-75, 25, 55]) translate([-kinect_head.x / 2 - 1, y, 0]) rotate([0, 90, 0])
      cylinder(d = 18, h = 3, $fn = facets);
  foot = kinect_foot("1414");
  black() translate([tower_middle, 0, shelf_top + kinect_plate]) {
    translate([-foot.x / 2, -foot.y / 2, 0]) cube([foot.x, foot.y, 14]);
    disc(30, 40);
  }
}

module tower() {
  translate([tower_middle, 0, 0]) {
    dark_wood() translate([-tower_foot_depth / 2, -base_width / 2, 0]) board_flat("Tower foot");
    for (side = [-1, 1]) {
      wood() translate([-upright_depth / 2, side * (tower_inside + board) / 2 + board / 2, board])
        upright() board_flat("Upright");
      dark_wood() translate([-shelf_depth / 2, side * (tower_inside - board - 1) / 2 + board / 2, shelf_top - board - cheek_height])
        upright() board_flat("Cheek");
      steel() for (x = [-1, 1]) translate([x * upright_rows / 2, side * (tower_inside / 2 + board + 5), cheek_bolt_z])
        rotate([90, 0, 0]) cylinder(d = 11, h = 10, center = true, $fn = 6);
    }
    wood() translate([-shelf_depth / 2, -(tower_inside - 1) / 2, shelf_top - board]) board_flat("Shelf");
    dark_wood() translate([upright_depth / 2, -tower_inside / 2 - board, board])
      rotate([90, 0, 90]) board_flat("Tower back");
    printed() translate([0, 0, shelf_top]) kinect_bracket("1414");
  }
}

module electronics() {
  translate([520, 0, 0]) rotate(90) {
    printed() electronics_plate();
    color([0.15, 0.5, 0.3]) translate([-38 - pi_board.x / 2, -pi_board.y / 2, electronics.z + standoff])
      cube([pi_board.x, pi_board.y, 1.6]);
    steel() translate([-38 + pi_board.x / 2 - 18, -26, electronics.z + standoff + 1.6]) cube([20, 52, 15]);
    color([0.75, 0.62, 0.25]) translate([50 - perfboard.y / 2, -perfboard.x / 2, electronics.z + standoff])
      cube([perfboard.y, perfboard.x, 1.6]);
    color([0.6, 0.15, 0.15]) translate([44, -10, electronics.z + standoff + 8]) cube([15, 20, 2]);
  }
}

/// From a holder's frame to the laser board's front.
module on_laser_board(y, z) {
  translate([laser_board_distance, y, z]) rotate([0, -90, 0]) children();
}

module laser_rig() {
  dark_wood() translate([laser_foot_x, -base_width / 2, 0]) board_flat("Laser foot");
  wood() translate([laser_board_distance, -laser_board_width / 2, board]) rotate([90, 0, 90]) board_flat("Laser board");
  for (y = [-1, 1]) dark_wood()
    translate([laser_board_distance + board, y * 110 + board / 2, board]) upright() board_flat("Gusset");
  for (side = [-1, 1]) on_laser_board(side * laser_board_y, laser_board_z) {
    printed() laser_holder(side);
    steel() along_laser(side) disc(laser_module, 35, -17);
  }
  on_laser_board(0, camera_board_z) {
    printed() camera_holder();
    color([0.15, 0.5, 0.3]) along_camera() translate([0, 0, camera_face / 2 + 0.8])
      cube([camera_board, camera_board, 1.6], center = true);
    black() along_camera() disc(14, camera_lens, camera_face / 2);
  }
}

/// What the lasers light on the platform.
module light() {
  for (side = [-1, 1]) color([0.9, 0.1, 0.1]) rotate(side * laser_azimuth)
    translate([0, -0.6, platform_top]) cube([138, 1.2, 0.6]);
}

module block_on_platform() {
  color([0.93, 0.93, 0.9]) translate([-gauge.x / 2, -gauge.y / 2, platform_top]) cube(gauge);
  color([0.93, 0.93, 0.9]) disc(gauge_cylinder, gauge_cylinder_height, platform_top + gauge.z);
}

if (view == "kinect") {
  base();
  drive();
  electronics();
  tower();
  kinect();
  block_on_platform();
}
if (view == "laser") {
  base();
  drive();
  laser_rig();
  light();
  block_on_platform();
  electronics();
}
if (view == "drive") {
  drive(lift = 28);
  wood() render() translate([-base_axis.x, -base_axis.y, -board]) intersection() {
    board_flat("Base");
    translate([0, 70, -1]) cube([base_axis.x + 70, base_width - 140, board + 2]);
  }
}
