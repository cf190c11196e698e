// CuraEngine without Cura has no defaults and needs every setting that it may read. These are all settings that its
// versions 4.13 and 5.0 need to slice a model into one wall a layer and nothing else: no infill, no supports, no
// combing.

/** Settings by value. */
const set = {
  '0.3': 'layer_height layer_height_0',
  'middle': 'slicing_tolerance',
  '300': `
    machine_depth machine_max_feedrate_e machine_max_feedrate_x machine_max_feedrate_y machine_max_feedrate_z
    machine_width`,
  '500': 'machine_height',
  'true': 'machine_center_is_zero',
  'none': 'adhesion_type',
  '1': 'meshfix_maximum_travel_resolution wall_distribution_count wall_line_count',
  '0.4': 'machine_nozzle_size wall_line_width_0 wall_line_width_x wall_transition_length',
  '1.75': 'material_diameter',
  '[[1,0,0],[0,1,0],[0,0,1]]': 'mesh_rotation_matrix',
  '100': `
    bridge_wall_material_flow initial_layer_line_width_factor material_flow_layer_0 material_shrinkage_percentage
    material_shrinkage_percentage_xy material_shrinkage_percentage_z small_feature_speed_factor
    small_feature_speed_factor_0 speed_travel wall_0_material_flow wall_overhang_speed_factor
    wall_transition_filter_distance wall_x_material_flow`,
  '0.5': 'meshfix_maximum_resolution',
  '0.025': 'meshfix_maximum_deviation',
  '2000': 'meshfix_maximum_extrusion_area_deviation',
  '50': 'speed_print_layer_0 speed_travel_layer_0 speed_wall_0 speed_wall_x wall_split_middle_threshold',
  '10': 'wall_transition_angle',
  '75': 'wall_add_middle_threshold',
  '0.1': 'min_feature_size wall_transition_filter_deviation',
  '0.2': 'min_bead_width',
  '90': 'wall_overhang_angle',
  '3000': `
    machine_acceleration machine_max_acceleration_e machine_max_acceleration_x machine_max_acceleration_y
    machine_max_acceleration_z`,
  '20': 'machine_max_jerk_e machine_max_jerk_xy machine_max_jerk_z',
  'off': 'retraction_combing',
  '0.6': 'travel_avoid_distance',
};

/** Settings that are off or 0. */
const unset = `
  acceleration_enabled acceleration_infill acceleration_ironing acceleration_prime_tower acceleration_print_layer_0
  acceleration_roofing acceleration_skirt_brim acceleration_support_bottom acceleration_support_infill
  acceleration_support_roof acceleration_topbottom acceleration_travel acceleration_travel_layer_0
  acceleration_wall_0 acceleration_wall_x adaptive_layer_height_enabled adhesion_extruder_nr alternate_carve_order
  alternate_extra_perimeter anti_overhang_mesh bottom_layers bottom_skin_expand_distance bottom_skin_preshrink
  bridge_fan_speed bridge_fan_speed_2 bridge_fan_speed_3 bridge_settings_enabled bridge_skin_density
  bridge_skin_material_flow bridge_skin_material_flow_2 bridge_skin_material_flow_3 bridge_skin_speed
  bridge_skin_speed_2 bridge_skin_speed_3 bridge_sparse_infill_max_density bridge_wall_coast bridge_wall_min_length
  bridge_wall_speed brim_gap brim_line_count brim_outside_only carve_multiple_volumes center_object
  clean_between_layers coasting_enable conical_overhang_enabled connect_infill_polygons connect_skin_polygons
  cool_fan_enabled cool_fan_full_layer cool_fan_speed_0 cool_fan_speed_max cool_fan_speed_min cool_lift_head
  cool_min_layer_time cool_min_layer_time_fan_speed_max cool_min_speed cross_infill_pocket_size cutting_mesh
  draft_shield_enabled extruder_nr fill_outline_gaps fill_perimeter_gaps filter_out_tiny_gaps
  flow_rate_extrusion_offset_factor flow_rate_max_extrusion_offset gradual_infill_step_height gradual_infill_steps
  gradual_support_infill_step_height gradual_support_infill_steps hole_xy_offset infill_angles infill_before_walls
  infill_enable_travel_optimization infill_extruder_nr infill_line_distance infill_line_width infill_material_flow
  infill_mesh infill_mesh_order infill_multiplier infill_offset_x infill_offset_y infill_overlap_mm infill_pattern
  infill_randomize_start_location infill_sparse_thickness infill_support_enabled infill_wall_line_count
  infill_wipe_dist initial_bottom_layers inset_direction ironing_enabled ironing_flow ironing_line_spacing
  ironing_only_highest_layer jerk_enabled jerk_infill jerk_ironing jerk_prime_tower jerk_print_layer_0 jerk_roofing
  jerk_skirt_brim jerk_support_bottom jerk_support_infill jerk_support_roof jerk_topbottom jerk_travel
  jerk_travel_layer_0 jerk_wall_0 jerk_wall_x layer_start_x layer_start_y limit_support_retractions
  machine_always_write_active_tool machine_buildplate_type machine_end_gcode machine_extruder_cooling_fan_number
  machine_extruder_start_code machine_extruders_share_heater machine_extruders_share_nozzle machine_firmware_retract
  machine_gcode_flavor machine_heated_bed machine_heated_build_volume machine_minimum_feedrate machine_name
  machine_nozzle_cool_down_speed machine_nozzle_offset_x machine_nozzle_offset_y machine_nozzle_temp_enabled
  machine_nozzle_tip_outer_diameter machine_scale_fan_speed_zero_to_one machine_shape machine_start_gcode
  machine_use_extruder_offset_to_offset_coords magic_fuzzy_skin_enabled magic_mesh_surface_mode magic_spiralize
  material_alternate_walls material_bed_temp_prepend material_bed_temperature_layer_0
  material_extrusion_cool_down_speed material_flow_dependent_temperature material_flow_temp_graph material_guid
  material_initial_print_temperature material_print_temp_prepend material_print_temp_wait material_print_temperature
  material_print_temperature_layer_0 max_extrusion_before_wipe mesh_position_x mesh_position_y mesh_position_z
  meshfix_extensive_stitching meshfix_keep_open_polygons meshfix_union_all meshfix_union_all_remove_holes
  min_infill_area min_skin_width_for_expansion minimum_polygon_circumference minimum_support_area mold_enabled
  ooze_shield_enabled optimize_wall_printing_order outer_inset_first prime_blob_enable prime_tower_brim_enable
  prime_tower_enable prime_tower_flow prime_tower_line_width raft_base_acceleration raft_base_extruder_nr
  raft_base_jerk raft_base_line_width raft_base_speed raft_base_thickness raft_interface_acceleration
  raft_interface_extruder_nr raft_interface_jerk raft_interface_line_width raft_interface_speed
  raft_interface_thickness raft_surface_acceleration raft_surface_extruder_nr raft_surface_jerk
  raft_surface_line_width raft_surface_speed raft_surface_thickness relative_extrusion remove_empty_first_layers
  retract_at_layer_change retraction_amount retraction_combing_max_distance retraction_count_max retraction_enable
  retraction_extra_prime_amount retraction_extrusion_window retraction_hop
  retraction_hop_after_extruder_switch_height retraction_hop_enabled retraction_hop_only_when_collides
  retraction_min_travel retraction_prime_speed retraction_retract_speed roofing_angles roofing_extruder_nr
  roofing_layer_count roofing_line_width roofing_material_flow roofing_monotonic roofing_pattern skin_angles
  skin_edge_support_layers skin_line_width skin_material_flow skin_monotonic skin_no_small_gaps_heuristic
  skin_outline_count skin_overlap_mm skirt_brim_extruder_nr skirt_brim_line_width skirt_brim_material_flow
  skirt_brim_minimal_length skirt_brim_speed small_feature_max_length speed_equalize_flow_enabled
  speed_equalize_flow_width_factor speed_infill speed_ironing speed_prime_tower speed_roofing speed_slowdown_layers
  speed_support_bottom speed_support_infill speed_support_roof speed_topbottom speed_z_hop support_bottom_angles
  support_bottom_enable support_bottom_extruder_nr support_bottom_height support_bottom_line_width
  support_bottom_material_flow support_bottom_pattern support_brim_enable support_enable support_extruder_nr_layer_0
  support_infill_angles support_infill_extruder_nr support_infill_sparse_thickness support_line_width
  support_material_flow support_mesh support_pattern support_roof_angles support_roof_enable
  support_roof_extruder_nr support_roof_height support_roof_line_width support_roof_material_flow
  support_roof_pattern support_structure support_top_distance support_tree_angle support_tree_collision_resolution
  support_wall_count support_xy_distance support_xy_distance_overhang support_xy_overrides_z
  switch_extruder_prime_speed switch_extruder_retraction_amount switch_extruder_retraction_speed
  top_bottom_extruder_nr top_bottom_pattern top_bottom_pattern_0 top_layers top_skin_expand_distance
  top_skin_preshrink travel_avoid_other_parts travel_avoid_supports travel_compensate_overlapping_walls_0_enabled
  travel_compensate_overlapping_walls_x_enabled travel_retract_before_outer_wall wall_0_extruder_nr wall_0_inset
  wall_0_wipe_dist wall_min_flow wall_min_flow_retract wall_x_extruder_nr wipe_brush_pos_x wipe_hop_amount
  wipe_hop_enable wipe_hop_speed wipe_move_distance wipe_pause wipe_repeat_count wipe_retraction_amount
  wipe_retraction_enable wipe_retraction_extra_prime_amount wipe_retraction_prime_speed
  wipe_retraction_retract_speed wireframe_enabled xy_offset xy_offset_layer_0 z_seam_corner z_seam_relative
  z_seam_type z_seam_x z_seam_y zig_zaggify_infill`;

const named = (names, value) => names.trim().split(/\s+/).flatMap((name) => ['-s', `${name}=${value}`]);

/** @returns {string[]} CuraEngine's arguments with the settings */
export function curaSettings() {
  return [...Object.entries(set).flatMap(([value, names]) => named(names, value)), ...named(unset, 0)];
}
