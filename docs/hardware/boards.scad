// The wooden boards, for the drawing and for the assembly.
//
// A board is [name, pieces, outline, holes, windows]: the outline's corners, or one [diameter] of a disc; of each hole x, y
// and diameter; of each window its middle and its sides. The lower left corner of the outline is at 0, 0; a disc's middle.
include <parameters.scad>

function box(size) = [[0, 0], [size.x, 0], size, [0, size.y]];
function around(middle, size, diameter) =
  [for (x = [-1, 1], y = [-1, 1]) [middle.x + x * size.x / 2, middle.y + y * size.y / 2, diameter]];
function quarters(radius, diameter) = [for (a = [0:90:270]) [radius * cos(a), radius * sin(a), diameter]];

base_axis = [base_behind, base_width / 2];
tower_depth_middle = tower_foot_depth / 2;
laser_foot_x = laser_board_distance - 10;    // the foot begins 10 mm before the board

boards = [
  ["Base", 1, box([base_behind + base_ahead, base_width]),
    concat([[base_axis.x, base_axis.y, m8_hole]],
           around(base_axis + [-axes, 0], motor_plate_screws, m4_hole),
           around(base_axis + [tower_middle, 0], tower_screws, m6_hole),
           around(base_axis + [laser_foot_x + laser_foot_depth / 2, 0], tower_screws - [20, 0], m6_hole)),
    [[base_axis.x - axes, base_axis.y, motor_side + 2 + 2 * motor_travel, motor_side + 2]]],
  ["Rail", 2, box([base_behind + base_ahead, rail_height]), [], []],
  ["Platform", 1, [platform_diameter], quarters(platform_screws_radius, m4_hole), []],
  ["Upright", 2, box([upright_depth, upright_height]),
    [for (i = [0:upright_holes - 1], x = [-1, 1])
      [upright_depth / 2 + x * upright_rows / 2, upright_first + i * upright_pitch, m6_hole]], []],
  ["Tower foot", 1, box([tower_foot_depth, base_width]),
    around([tower_foot_depth, base_width] / 2, tower_screws, m6_hole), []],
  ["Tower back", 1, box([tower_inside + 2 * board, brace_height]), [], []],
  ["Shelf", 1, box([shelf_depth, tower_inside - 1]),
    around([shelf_depth, tower_inside - 1] / 2, kinect_plate_screws, m6_hole), []],
  ["Cheek", 2, box([shelf_depth, cheek_height]),
    [for (x = [-1, 1]) [shelf_depth / 2 + x * upright_rows / 2, cheek_height - (shelf_top - board - cheek_bolt_z), m6_hole]],
    []],
  ["Laser board", 1, box([laser_board_width, laser_board_height]),
    [for (up = [-1:1]) for (hole = concat(
        [for (side = [-1, 1], z = [-1, 1]) [side * laser_board_y, laser_board_z + z * laser_screws / 2]],
        [for (side = [-1, 1]) [side * camera_screws_apart / 2, camera_board_z]]))
      [laser_board_width / 2 + hole.x, hole.y - board + up * laser_board_pitch, m6_hole]], []],
  ["Laser foot", 1, box([laser_foot_depth, base_width]),
    around([laser_foot_depth, base_width] / 2, tower_screws - [20, 0], m6_hole), []],
  ["Gusset", 2, [[0, 0], [laser_foot_depth - 10 - board, 0], [0, laser_gusset]], [], []],
];

/// A board lying on z = 0.
module board_flat(name) {
  chosen = boards[search([name], boards)[0]];
  linear_extrude(height = board) difference() {
    if (len(chosen[2]) == 1) circle(d = chosen[2][0], $fn = 180);
    else polygon(chosen[2]);
    for (hole = chosen[3]) translate([hole[0], hole[1]]) circle(d = hole[2], $fn = 32);
    for (window = chosen[4]) translate([window[0], window[1]]) square([window[2], window[3]], center = true);
  }
}
