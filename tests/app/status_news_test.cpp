#include <gtest/gtest.h>

#include <algorithm>

#include "app/app_fixture.hpp"
#include "http/handlers/events.hpp"
#include "http/scan_view.hpp"

namespace octurn {
namespace {

class StatusNewsTest : public AppTest {
 protected:
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
};

TEST_F(StatusNewsTest, MakesNoStatusWhileNothingChanges) {
  const App app = make_app();
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

TEST_F(StatusNewsTest, TellsWebhooksOfAScanWhoseEndAFullDiskKeepsFromBeingSaved) {
  const App app = make_app();
  ScanNews news;
  Job job = store_.create({});
  EXPECT_TRUE(news.next(app).empty());
  job.state = JobState::interrupted;
  job.failure = Failure{.code = ErrorCode::interrupted};  // the program has ended, and told nobody
  store_.save(job);
  EXPECT_TRUE(news.next(app).empty());
  job.state = JobState::running;
  store_.save(job);
  EXPECT_EQ(news.next(app).size(), 1U);
  job.state = JobState::interrupted;
  job.failure = Failure{.code = ErrorCode::disk_full};
  store_.save(job);
  const std::vector<WebhookEvent> events = news.next(app);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events.front().name, "scan-paused");
  EXPECT_NE(events.front().body.find("disk-full"), std::string::npos) << events.front().body;
}

}  // namespace
}  // namespace octurn
