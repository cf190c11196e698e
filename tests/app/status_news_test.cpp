#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "app/scanner_fixture.hpp"
#include "http/handlers/events.hpp"
#include "octurn/file.hpp"
#include "outgoing/address_book.hpp"
#include "outgoing/printer_uploads.hpp"

namespace octurn {
namespace {

/// The daemon's state with a simulated rig.
class StatusNewsTest : public ScannerTest {
 protected:
  StatusNewsTest() { write_file(folder_.path() / "index.html", "<!doctype html>"); }

  /// Calls `news` until it returns some.
  static std::vector<News> wait_for_news(StatusNews& news) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    std::vector<News> told = news();
    while (told.empty() && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      told = news();
    }
    return told;
  }

  static std::string data_of(const std::vector<News>& news, std::string_view kind) {
    const auto found = std::ranges::find(news, kind, &News::kind);
    return found == news.end() ? "" : found->data;
  }

  Scanner scanner_{rig(), {}, store_};
  ConfigStore settings_{ConfigLayers{.file = {.data = folder_.path()}}};
  TurntableRunner turntable_{scanner_, store_};
  AccessKeys keys_{folder_.path() / "keys.json"};
  AddressBook addresses_{folder_.path() / "addresses.json"};
  PrinterUploads uploads_;
  std::atomic<std::uint64_t> free_ = 5;
  MachineWatch machine_{{.free_bytes = [this] { return free_.load(); },
                         .warnings = [] { return std::vector<Finding>{}; }},
                        {.disk = std::chrono::milliseconds(1)}};
};

TEST_F(StatusNewsTest, MakesNoStatusWhileNothingChanges) {
  const Page page(folder_.path());
  const App app{.scanner = scanner_,
                .store = store_,
                .page = page,
                .settings = settings_,
                .turntable = turntable_,
                .keys = keys_,
                .machine = machine_,
                .addresses = addresses_,
                .uploads = uploads_,
                .rig = rig()};
  wait_until(scanner_, [](const Status& status) {  // until the worker's status is final
    return is_ready(status) && status.turntable.state == DeviceStatus::State::ready;
  });
  StatusNews news(app);
  EXPECT_EQ(news().size(), 4U);
  EXPECT_TRUE(news().empty());

  free_ = 3;
  EXPECT_NE(data_of(wait_for_news(news), "status").find("\"disk_free_bytes\":3,"),
            std::string::npos);
  EXPECT_TRUE(news().empty());

  const Job job = scan(scanner_, few_snapshots());
  EXPECT_EQ(job.state, JobState::finished);
  EXPECT_NE(data_of(wait_for_news(news), "status").find("\"newest\":\"" + job.id + "\""),
            std::string::npos);
  EXPECT_TRUE(news().empty());
}

}  // namespace
}  // namespace octurn
