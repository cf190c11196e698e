#include "http/routes.hpp"

#include <array>

#include "http/handlers/appliance.hpp"
#include "http/handlers/archives.hpp"
#include "http/handlers/bin.hpp"
#include "http/handlers/builds.hpp"
#include "http/handlers/calibration.hpp"
#include "http/handlers/events.hpp"
#include "http/handlers/formats.hpp"
#include "http/handlers/keys.hpp"
#include "http/handlers/machine.hpp"
#include "http/handlers/models.hpp"
#include "http/handlers/outgoing.hpp"
#include "http/handlers/poses.hpp"
#include "http/handlers/scans.hpp"
#include "http/handlers/settings.hpp"
#include "http/handlers/system.hpp"
#include "http/handlers/turntable.hpp"

namespace octurn {

std::span<const Route> scan_routes() {
  static const std::array all{
      Route{"GET", "/api/v1/scans", list_scans},
      Route{"POST", "/api/v1/scans", start_scan, WaitsFor::start},
      Route{"POST", "/api/v1/scans/estimate", send_estimate},
      Route{"GET", "/api/v1/scans/{id}", send_scan},
      Route{"PATCH", "/api/v1/scans/{id}", label_scan},
      Route{"DELETE", "/api/v1/scans/{id}", remove_scan},
      Route{"POST", "/api/v1/scans/{id}/cancel", cancel_scan},
      Route{"POST", "/api/v1/scans/{id}/end", cancel_scan},
      Route{"POST", "/api/v1/scans/{id}/pause", pause_scan},
      Route{"POST", "/api/v1/scans/{id}/restore", restore_scan},
      Route{"POST", "/api/v1/scans/{id}/resume", resume_scan, WaitsFor::start},
      Route{"GET", "/api/v1/scans/{id}/Scan.stl", send_model},
      Route{"POST", import_path, import_scan},
      Route{"GET", "/api/v1/scans/{id}/scan.zip", send_archive},
      Route{"GET", "/api/v1/scans/{id}/Scan.{format}", send_mesh},
      Route{"GET", "/api/v1/scans/{id}/coarse.stl", send_coarse_model},
      Route{"GET", "/api/v1/scans/{id}/thumbnail.png", send_thumbnail},
      Route{"GET", "/api/v1/scans/{id}/preview.stl", send_preview},
      Route{"GET", "/api/v1/scans/{id}/builds", list_builds},
      Route{"POST", "/api/v1/scans/{id}/builds", start_build},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}", send_build},
      Route{"DELETE", "/api/v1/scans/{id}/builds/{number}", remove_build},
      Route{"POST", "/api/v1/scans/{id}/builds/{number}/cancel", cancel_build},
      Route{"POST", "/api/v1/scans/{id}/builds/{number}/choose", choose_build},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}/Scan.stl", send_build_model},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}/Scan.{format}", send_build_mesh},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}/coarse.stl", send_coarse_build},
      Route{"GET", "/api/v1/scans/{id}/send", send_upload},
      Route{"POST", "/api/v1/scans/{id}/send", send_to_printer},
      Route{"DELETE", "/api/v1/scans/{id}/send", cancel_upload},
      Route{"GET", "/api/v1/scans/{id}/poses", list_poses},
      Route{"POST", "/api/v1/scans/{id}/poses", start_pose, WaitsFor::start},
      Route{"POST", "/api/v1/scans/{id}/poses/{number}", choose_pose},
      Route{"DELETE", "/api/v1/scans/{id}/poses/{number}", remove_pose},
      Route{"GET", "/api/v1/scans/{id}/poses/{number}/points", send_pose_points},
  };
  return all;
}

std::span<const Route> other_routes() {
  static const std::array all{
      Route{"GET", "/Scan.stl", send_newest_model},
      Route{"GET", "/api/v1/openapi.json", send_description},
      Route{"GET", "/api/v1/status", send_status},
      Route{"GET", "/api/v1/events", send_events},
      Route{"GET", "/api/v1/settings", send_settings},
      Route{"PATCH", "/api/v1/settings", change_settings},
      Route{"GET", "/api/v1/settings/backup", send_backup},
      Route{"POST", "/api/v1/settings/backup", restore_backup},
      Route{"PUT", "/api/v1/settings/password", set_page_password},
      Route{"GET", "/api/v1/keys", list_keys},
      Route{"POST", "/api/v1/keys", make_key},
      Route{"DELETE", "/api/v1/keys/{id}", revoke_key},
      Route{"GET", "/api/v1/webhooks", list_webhooks},
      Route{"POST", "/api/v1/webhooks", add_webhook},
      Route{"DELETE", "/api/v1/webhooks/{id}", remove_webhook},
      Route{"POST", "/api/v1/webhooks/{id}/test", test_webhook},
      Route{"GET", "/api/v1/printers", list_printers},
      Route{"POST", "/api/v1/printers", add_printer},
      Route{"DELETE", "/api/v1/printers/{id}", remove_printer},
      Route{"GET", "/api/v1/calibration", send_calibration},
      Route{"PATCH", "/api/v1/calibration", change_calibration},
      Route{"POST", "/api/v1/calibration", start_calibration, WaitsFor::start},
      Route{"GET", "/api/v1/calibration/sensor-map", send_sensor_map},
      Route{"POST", "/api/v1/calibration/cancel", cancel_calibration},
      Route{"POST", "/api/v1/calibration/solve", solve_lens},
      Route{"GET", "/api/v1/calibration/board.pdf", send_board},
      Route{"POST", "/api/v1/calibration/undo", undo_calibration},
      Route{"GET", "/api/v1/preview/points", send_points, WaitsFor::look},
      Route{"GET", "/api/v1/turntable", send_turntable},
      Route{"POST", "/api/v1/turntable", move_turntable},
      Route{"GET", "/api/v1/doctor", send_findings, WaitsFor::look},
      Route{"GET", "/api/v1/diagnostics.zip", send_diagnostics, WaitsFor::look},
      Route{"GET", "/api/v1/preview/depth.png", send_depth_picture, WaitsFor::look},
      Route{"GET", "/api/v1/bin", send_bin},
      Route{"DELETE", "/api/v1/bin", empty_bin},
      Route{"GET", update_path, send_update_state},
      Route{"PUT", update_path, take_update},
      Route{"GET", "/api/v1/machine", send_machine},
      Route{"PATCH", "/api/v1/machine", change_machine},
      Route{"PUT", "/api/v1/machine/clock", set_clock},
      Route{"POST", "/api/v1/machine/restart", restart_machine},
      Route{"POST", "/api/v1/machine/shutdown", shut_machine_down},
      Route{"GET", "/api/v1/messages", send_messages},
      Route{"GET", "/api/v1/wifi", send_wifi_state},
      Route{"PUT", "/api/v1/wifi", join_wifi},
  };
  return all;
}

}  // namespace octurn
