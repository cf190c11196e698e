// Every dimension of the rig. Millimetres and degrees.
//
// Frame: the origin is where the platform's axis leaves the base's top; z points up, x to the tower, y to the left.
// "Not measured" marks what was taken from data sheets, articles or other people's drawings: measure yours.

// --- Printing -------------------------------------------------------------------------------------------------------
fit = 0.2;        // clearance around a part that is pushed in by hand
loose = 0.5;      // clearance on each side of a part that must drop in
wall = 3;         // thinnest wall that carries load
facets = 48;      // of a circle
m3_core = 2.5;    // hole into which an M3 screw cuts its own thread
m3_hole = 3.4;
m3_head = 5.9;    // of a socket head, with clearance
m3_head_height = 3.2;
m4_hole = 4.4;
m6_hole = 6.6;
m8_hole = 8.4;

// --- Boards: birch plywood. 12 mm; 12.7 mm (1/2 inch) does, too: set it here, and the drawing follows ------------------
board = 12;
platform_diameter = 280;
base_width = 348;
base_behind = 175;           // from the axis away from the tower
base_ahead = 730;            // from the axis to the end below the tower
rail_height = 40;            // the base stands on two rails, and the motor hangs between them
rail_inset = 30;

// --- Sensor: the pose that Octurn begins with (docs/settings.md, platform_from_sensor) --------------------------------
sensor_distance = 620;       // from the axis to the Kinect's front
sensor_height = 360;         // above the platform's surface
sensor_pitch = 25;           // downwards

// --- Bearing and axle: two 608 on an M8 x 55 bolt ----------------------------------------------------------------------
bearing_outer = 22;
bearing_bore = 8;
bearing_width = 7;
bearing_seat = 18;           // hole in the shoulder that carries the outer ring
axle_length = 55;
m8_nut = 6.5;
m8_lock_nut = 8;
m8_washer = 1.6;
nut_room = 20;               // diameter for the socket that turns the lock nut
nut_room_height = 10;

// --- Belt drive: GT2, 2 mm pitch, 6 mm wide ------------------------------------------------------------------------------
belt_pitch = 2;
belt_teeth = 140;            // a closed loop of 280 mm
belt_width = 6;
belt_room = 7.5;             // between the flanges
pitch_line = 0.254;          // of the belt's cords, outside the teeth's tips
tooth_depth = 0.75;
tooth_radius = 0.555;
platform_teeth = 60;
motor_teeth = 20;
gear_ratio = platform_teeth / motor_teeth;
motor_pulley_diameter = 16;  // its flanges
motor_pulley_height = 16;
motor_pulley_belt = 4.5;     // from its end to the middle of its teeth
pulley_flange = 1.5;
pulley_overhang = 1.5;       // of the flanges beyond the teeth
pitch_diameter_platform = platform_teeth * belt_pitch / PI;
pitch_diameter_motor = motor_teeth * belt_pitch / PI;
// Length of an open belt round two pulleys, solved for the distance of their axes.
belt_straight = belt_teeth * belt_pitch - PI * (pitch_diameter_platform + pitch_diameter_motor) / 2;
axes = (belt_straight + sqrt(pow(belt_straight, 2) - 2 * pow(pitch_diameter_platform - pitch_diameter_motor, 2))) / 4;

// --- Motor: NEMA 17 ------------------------------------------------------------------------------------------------------
motor_side = 42.3;
motor_length = 40;
motor_boss = 22;
motor_boss_height = 2;
motor_screws = 31;           // side of their square
motor_shaft = 5;
motor_shaft_length = 24;
motor_travel = 5;            // either way, to tension the belt
motor_plate = 5;
motor_plate_size = [86, 84];
motor_plate_screws = [66, 68];

// --- Hub and pulley --------------------------------------------------------------------------------------------------------
pulley_height = 2 * pulley_flange + belt_room;
hub_height = 24;
hub_flange = 6;
hub_diameter = 100;
boss_diameter = 44;
joint_radius = 14.5;         // of the four M3 x 20 that hold hub and pulley together
joint_depth = 16;
platform_screws_radius = 40; // of the four M4 x 25 through the platform
pulley_bottom = m8_washer + m8_nut;
hub_bottom = pulley_bottom + pulley_height;
platform_bottom = hub_bottom + hub_height;
platform_top = platform_bottom + board;
belt_middle = pulley_bottom + pulley_flange + belt_room / 2;

// --- Kinect: head and foot, not measured --------------------------------------------------------------------------------------
kinect_head = [65, 283, 38]; // depth, width, height
kinect_height = 72;          // on its foot, level
kinect_models = ["1414", "1473", "1517"];
kinect_feet = [[66, 84], [66, 84], [64, 82]];  // depth and width of the foot of each model
kinect_cable = 30;           // gap in the fence, behind the foot
function kinect_foot(model) = kinect_feet[search([model], kinect_models)[0]];
kinect_fence = 8;            // height of the fence round the foot
kinect_pad = 2;              // of foam between head and braces
kinect_plate = 5;
kinect_plate_size = [90, 200];
kinect_plate_screws = [70, 120];
kinect_brace_at = 82;        // from the middle to the middle of a brace
kinect_brace_width = 20;
strap = [4, 26];             // slot for a hook-and-loop strap of 25 mm

// The Kinect's head turns about a point in its middle, above the middle of the foot.
sensor_top = platform_top + sensor_height;
head_middle_x = sensor_distance + cos(sensor_pitch) * kinect_head.x / 2;
head_middle_z = sensor_top + sin(sensor_pitch) * kinect_head.x / 2;
head_above_foot = kinect_height - kinect_head.z / 2;
shelf_top = head_middle_z - head_above_foot - kinect_plate;

// --- Tower of the Kinect ---------------------------------------------------------------------------------------------------------
tower_inside = 300;          // between the uprights
upright_depth = 100;
upright_height = 500;
upright_pitch = 25;          // of the two rows of holes
upright_rows = 60;           // between the rows
upright_holes = 12;
upright_first = 160;         // height of the lowest pair above the upright's foot
tower_foot_depth = 140;
shelf_depth = 130;
cheek_height = 70;
brace_height = 150;
tower_screws = [100, 240];
tower_middle = head_middle_x;
// The cheeks' bolts meet the holes at the shelf's nominal height.
cheek_bolt_z = board + upright_first + upright_pitch * 6;

// --- Laser rig: a camera and two line lasers on one board (docs/settings.md, laser) ----------------------------------------------
camera_distance = 280;
camera_height = 180;         // above the platform's surface
camera_pitch = 25;
camera_board = 38;           // a square UVC module
camera_screws = [28, 34];    // sides of the two squares of M2 screws that such modules have
camera_lens = 18;            // from the board to the lens's front, not measured
laser_radius = 350;          // from the axis
laser_height = 250;
laser_azimuth = 30;
laser_aim = 60;              // height on the axis at which the middle of its line aims
laser_module = 12;           // diameter
laser_clamp_length = 24;
laser_plate = [60, 36, 5];
laser_board_distance = 350;  // of the board's front
laser_board_width = 440;
laser_board_height = 360;
laser_board_pitch = 25;      // holes above and below the nominal ones
laser_pitch = atan((laser_height - laser_aim) / laser_radius);
laser_foot_depth = 120;
laser_gusset = 150;
laser_screws = 40;           // between the two M6 of a laser's holder, upright
camera_screws_apart = 60;    // between the two M6 of the camera's, level
// Where the holders' middles are on the board, so that the lasers cross the axis, and the camera is at its distance.
laser_from_board = 34;       // from the board's front to the middle of the clamp
laser_board_y = (laser_board_distance - laser_from_board) * tan(laser_azimuth);
laser_board_z = platform_top + laser_aim
  + (laser_board_distance - laser_from_board) / cos(laser_azimuth) * tan(laser_pitch);
camera_face = 4;             // thickness of the plate below the camera
camera_from_board = laser_board_distance - camera_distance - (camera_face / 2 + camera_lens) * cos(camera_pitch);
camera_board_z = platform_top + camera_height + (camera_face / 2 + camera_lens) * sin(camera_pitch);

// --- Electronics plate --------------------------------------------------------------------------------------------------------
electronics = [180, 100, 3];
pi_screws = [58, 49];        // of a Raspberry Pi of full size; M2.5
pi_board = [85, 56];
perfboard = [70, 50];
perfboard_screws = [65.5, 45.5];  // not measured
standoff = 6;
m25_core = 2.1;
m2_core = 1.8;

// --- Gauge block -----------------------------------------------------------------------------------------------------------------
gauge = [100, 60, 40];
gauge_cylinder = 40;
gauge_cylinder_height = 50;
