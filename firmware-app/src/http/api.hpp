#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/appliance.hpp"
#include "doctor/doctor.hpp"
#include "http/message.hpp"
#include "http/page.hpp"
#include "scan/scanner.hpp"

namespace octurn {

/// Answers requests: the page, `/Scan.stl` and what is under `/api/v1`, as web/API.md has it. Any
/// thread may call it.
class Api {
 public:
  /// @param patient    this scanner, with the configuration in force
  /// @param appliance  that it is; null: none
  Api(Scanner& scanner, const ScanStore& store, const Page& page, Patient patient,
      Appliance* appliance = nullptr);

  /// Throws nothing of its own: what goes wrong becomes a problem, as application/problem+json.
  Response answer(const Request& request);

 private:
  struct Route;
  static const std::vector<Route>& routes();

  Response dispatch(const Request& request);

  Response status(const Request& request, std::string_view id);
  Response settings(const Request& request, std::string_view id);
  Response doctor(const Request& request, std::string_view id);
  Response diagnostics(const Request& request, std::string_view id);
  Response preview(const Request& request, std::string_view id);
  Response newest_model(const Request& request, std::string_view id);
  Response list(const Request& request, std::string_view id);
  Response start(const Request& request, std::string_view id);
  Response scan(const Request& request, std::string_view id);
  Response rename(const Request& request, std::string_view id);
  Response remove(const Request& request, std::string_view id);
  Response cancel(const Request& request, std::string_view id);
  Response resume(const Request& request, std::string_view id);
  Response model(const Request& request, std::string_view id);
  Response made_model(const Request& request, const Job& job);
  Response surface_so_far(const Request& request, std::string_view id);
  Response update(const Request& request, std::string_view id);
  Response take_update(const Request& request, std::string_view id);
  Response wifi(const Request& request, std::string_view id);
  Response join_wifi(const Request& request, std::string_view id);

  /// A scan as web/API.md has it.
  nlohmann::json described(const Job& job) const;

  /// The scan of that id as it is now. @throws Error "no-such-scan"
  Job find(std::string_view id) const;

  /// All scans as they are now, the newest first.
  std::vector<Job> scans_now() const;

  /// @throws Error "not-an-appliance"
  Appliance& appliance() const;

  /// @throws Error "busy"  if this machine may start again at any moment
  void expect_no_update() const;

  Scanner& scanner_;
  const ScanStore& store_;
  const Page& page_;
  Patient patient_;
  Appliance* appliance_;
};

}  // namespace octurn
