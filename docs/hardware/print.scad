// One printed part, as it lies on the printer's bed: openscad -o hub.stl -D 'part="platform_hub"' print.scad
include <parameters.scad>
use <parts/platform_hub.scad>
use <parts/pulley.scad>
use <parts/motor_plate.scad>
use <parts/kinect_bracket.scad>
use <parts/electronics_plate.scad>
use <parts/laser_holder.scad>
use <parts/camera_holder.scad>
use <parts/gauge_block.scad>

part = "";
parts = [
  "platform_hub", "pulley", "motor_plate", "electronics_plate", "kinect_bracket_1414", "kinect_bracket_1473",
  "kinect_bracket_1517", "laser_holder_left", "laser_holder_right", "camera_holder", "gauge_block"];
if (part == "") echo(parts = parts);

module upside_down(height) {
  translate([0, 0, height]) rotate([180, 0, 0]) children();
}

if (part == "platform_hub") upside_down(hub_height) platform_hub();
if (part == "pulley") upside_down(pulley_height) pulley();
if (part == "motor_plate") motor_plate();
if (part == "electronics_plate") electronics_plate();
for (model = kinect_models) if (part == str("kinect_bracket_", model)) kinect_bracket(model);
if (part == "laser_holder_left") laser_holder(1);
if (part == "laser_holder_right") laser_holder(-1);
if (part == "camera_holder") camera_holder();
if (part == "gauge_block") gauge_block();
