// Answers of the scanner, as web/API.md describes them, for tests without one.

export const settings = {
  snapshots: 36, filter: 'average', frames: 10, method: 'solid', leaf_size_mm: 1, threshold_m2: 0.0001, calibrate: 'auto',
  clip_mm: [-140, -140, 5, 140, 140, 400],
};

const device = {state: 'ready', name: 'Kinect v1', simulated: false, message: ''};

export const status = {version: '0.1.0', sensor: device, turntable: {...device, name: 'stepper'}, disk_free_bytes: 12.3e9, appliance: false, scan: null, newest: null, scans_revision: 1};

export const running = {
  id: 'run', name: '', notes: '', tags: [], inventory_number: '', author: '', licence: '', state: 'running', phase: 'capturing', created: '2026-11-21T08:15:00Z', snapshots_done: 9,
  snapshots_total: 36, seconds_elapsed: 12.3, seconds_left: 40.1, seconds_until_pause: null, late_pulses: 0, slips: 0, seconds_settling: 0, settings, error: null, model: null, pose_of: null, has_colours: false, has_views: true, poses: [],
  preview: null,
};

export const finished = {
  ...running, id: 'done', name: 'Owl', state: 'finished', phase: 'done', snapshots_done: 36, seconds_left: null,
  model: {
    url: '/api/v1/scans/done/Scan.stl', bytes: 50551684, triangles: 1011032, leaves: 130304, watertight: true, volume_cm3: 97.12,
    size_mm: [120.12, 94.9, 151], seconds: 0.08, parts: 1, filled_share: 0.21,
  },
};

export const calibration = {
  platform_from_sensor: [[1, 0, 0, 0], [0, -0.4226, 0.9063, -0.62], [0, -0.9063, -0.4226, 0.36], [0, 0, 0, 1]],
  source: 'default', at: null, shift_mm: null, tilt_deg: null, sigma_mm: null, sigma_deg: null, before_mm: null, after_mm: null,
  scale: 1, sensor_map: null, sensor_on_s: null, optics: null, history: [], run: null,
};

export const turnReport = {
  accepted: true, reason: '', platform_from_sensor: calibration.platform_from_sensor, shift_mm: 18.42, tilt_deg: 2.013,
  sigma_mm: 0.031, sigma_deg: 0.012, before_mm: 6.84, after_mm: 0.52, stops: [], findings: [],
};
