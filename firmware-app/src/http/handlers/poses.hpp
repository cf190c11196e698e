#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

/// `GET /api/v1/scans/{id}/poses`
Response list_poses(App& app, std::string_view id);

/// `POST /api/v1/scans/{id}/poses`
Response start_pose(App& app, const Request& request, std::string_view id);

/// `POST /api/v1/scans/{id}/poses/{number}`
Response choose_pose(App& app, const Request& request, std::string_view id,
                     std::string_view number);

/// `GET /api/v1/scans/{id}/poses/{number}/points`
Response send_pose_points(App& app, const Request& request, std::string_view id,
                          std::string_view number);

/// `DELETE /api/v1/scans/{id}/poses/{number}`
Response remove_pose(App& app, std::string_view id, std::string_view number);

}  // namespace octurn
