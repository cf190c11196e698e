#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "http/connections.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

const ConnectionTable::Time start = ConnectionTable::Time{} + 1000s;
constexpr ConnectionLimits limits{.max_connections = 4,
                                  .patience = std::chrono::duration<double>(10),
                                  .min_upload_rate = 1000,
                                  .min_answer_rate = 100};

AcceptedSocket socket_from(const std::string& address, int number) {
  return {.descriptor = number,
          .inode = static_cast<ino_t>(100 + number),
          .address = address,
          .port = 5000 + number};
}

/// A table with one connection, whose request head is already read.
struct OneClient {
  ConnectionTable table{limits};
  ConnectionTable::Key key = 0;

  explicit OneClient(Wait wait) {
    table.refresh(std::vector{socket_from("10.0.0.1", 1)}, start);
    key = table.claim("10.0.0.1", 5001, start).value_or(0);
    table.set_wait(key, wait, start);
  }
};

TEST(ConnectionTable, EndsAHeadThatDoesNotComeInTime) {
  ConnectionTable table(limits);
  table.refresh(std::vector{socket_from("10.0.0.1", 1)}, start);
  EXPECT_TRUE(table.cut_all_due(start + 9900ms).empty());
  const auto endings = table.cut_all_due(start + 10100ms);
  ASSERT_EQ(endings.size(), 1U);
  EXPECT_EQ(endings[0].socket.inode, 101U);
  EXPECT_TRUE(table.cut_all_due(start + 30s).empty());  // a connection is cut only once
}

TEST(ConnectionTable, CountsOnlyTheTimeThatTheServerWaits) {
  OneClient client(Wait::server);
  EXPECT_TRUE(client.table.cut_all_due(start + 1h).empty());
  client.table.set_wait(client.key, Wait::reader, start + 1h);
  EXPECT_TRUE(client.table.cut_all_due(start + 1h + 9s).empty());
  EXPECT_EQ(client.table.cut_all_due(start + 1h + 11s).size(), 1U);
}

TEST(ConnectionTable, LetsAReaderTakeAsLongAsItKeepsUpWithTheLeastRate) {
  OneClient client(Wait::reader);
  for (int second = 1; second <= 1000; ++second) {
    const auto now = start + std::chrono::seconds(second);
    client.table.add_bytes(client.key, 101, now);
    ASSERT_TRUE(client.table.cut_all_due(now).empty()) << second;
  }
}

TEST(ConnectionTable, EndsAReaderThatFallsBehindWhateverItTookBefore) {
  OneClient client(Wait::reader);
  client.table.add_bytes(client.key, 1'000'000, start);  // went into the kernel's buffers
  int second = 1;
  for (; client.table.cut_all_due(start + std::chrono::seconds(second)).empty(); ++second) {
    ASSERT_LT(second, 100);
    client.table.add_bytes(client.key, 50, start + std::chrono::seconds(second));
  }
  EXPECT_NEAR(second, 20, 2);  // at half the rate, each second adds half a second of debt
}

TEST(ConnectionTable, HasNoBytesPayForABodyThatIsSmall) {
  OneClient client(Wait::body);
  client.table.add_bytes(client.key, 1'000'000, start + 5s);
  const auto endings = client.table.cut_all_due(start + 11s);
  ASSERT_EQ(endings.size(), 1U);
  EXPECT_EQ(endings[0].cut, Cut::reading);  // only reading ends, so that a response can be sent
  EXPECT_TRUE(client.table.is_cut(client.key));
  EXPECT_TRUE(client.table.cut_all_due(start + 19s).empty());
  const auto after_all = client.table.cut_all_due(start + 21s);
  ASSERT_EQ(after_all.size(), 1U);
  EXPECT_NE(after_all[0].cut, Cut::reading);
}

TEST(ConnectionTable, KeepsAnUploadsDebtWhileTheServerStoresWhatCame) {
  OneClient client(Wait::upload);
  auto now = start;
  bool cut = false;
  for (int i = 0; i < 30 && !cut; ++i) {  // half the rate, between two seconds of writing
    now += 1s;
    client.table.add_bytes(client.key, 500, now);
    client.table.set_wait(client.key, Wait::server, now);
    now += 2s;
    client.table.set_wait(client.key, Wait::upload, now);
    cut = !client.table.cut_all_due(now).empty();
  }
  EXPECT_TRUE(cut);
}

TEST(ConnectionTable, CutsThoseThatKeepItWaitingForLongestWhenThereAreTooMany) {
  ConnectionTable table(limits);
  std::vector<AcceptedSocket> open;
  for (int i = 1; i <= 6; ++i) {
    open.push_back(socket_from("10.0.0." + std::to_string(i), i));
    table.refresh(open, start + i * 1s);
  }
  const auto endings = table.cut_all_due(start + 7s);
  ASSERT_EQ(endings.size(), 2U);
  EXPECT_EQ(endings[0].socket.inode, 101U);
  EXPECT_EQ(endings[1].socket.inode, 102U);
}

TEST(ConnectionTable, CutsThoseOfTheAddressThatHoldsTheMostWhenAllAreNew) {
  ConnectionTable table(limits);
  std::vector<AcceptedSocket> open{socket_from("10.0.0.7", 1)};
  table.refresh(open, start);
  for (int i = 2; i <= 6; ++i) {
    open.push_back(socket_from("10.0.0.8", i));
  }
  table.refresh(open, start + 1ms);
  const auto endings = table.cut_all_due(start + 200ms);
  ASSERT_EQ(endings.size(), 2U);
  EXPECT_TRUE(std::ranges::none_of(
      endings, [](const auto& ending) { return ending.socket.address == "10.0.0.7"; }));
}

TEST(ConnectionTable, NeverCutsWhatWaitsForTheServerToMakeRoom) {
  ConnectionTable table(limits);
  std::vector<AcceptedSocket> open;
  for (int i = 1; i <= 6; ++i) {
    open.push_back(socket_from("10.0.0.1", i));
  }
  table.refresh(open, start);
  for (int i = 1; i <= 6; ++i) {
    ASSERT_TRUE(table.claim("10.0.0.1", 5000 + i, start));
  }
  EXPECT_TRUE(table.cut_all_due(start + 1s).empty());
}

TEST(ConnectionTable, TakesAHeadThatNoThreadHasReadForOneInTheQueue) {
  ConnectionTable table(limits);
  std::vector<AcceptedSocket> open{socket_from("10.0.0.1", 1)};
  open[0].has_unread = true;
  for (int i = 2; i <= 6; ++i) {
    open.push_back(socket_from("10.0.0." + std::to_string(i), i));
  }
  table.refresh(open, start);
  const auto is_first = [](const auto& ending) { return ending.socket.inode == 101; };
  const auto endings = table.cut_all_due(start + 200ms);
  EXPECT_EQ(endings.size(), 2U);
  EXPECT_TRUE(std::ranges::none_of(endings, is_first));

  open[0].has_unread = false;  // a thread reads it
  open.push_back(socket_from("10.0.0.7", 7));
  open.push_back(socket_from("10.0.0.8", 8));
  table.refresh(open, start + 1s);
  EXPECT_TRUE(std::ranges::none_of(table.cut_all_due(start + 1005ms), is_first));
}

/// A table with two connections too many, all opened at `start`, each from its own address.
ConnectionTable table_of_six() {
  ConnectionTable table(limits);
  std::vector<AcceptedSocket> open;
  for (int i = 1; i <= 6; ++i) {
    open.push_back(socket_from("10.0.0." + std::to_string(i), i));
  }
  table.refresh(open, start);
  return table;
}

TEST(ConnectionTable, GivesABusyMachineLongerToReadAHead) {
  ConnectionTable table = table_of_six();
  table.note_lateness(30ms);
  EXPECT_TRUE(table.cut_all_due(start + 200ms).empty());
  table.note_lateness(-1ms);  // woke up early
  EXPECT_TRUE(table.cut_all_due(start + 300ms).empty());
  EXPECT_EQ(table.cut_all_due(start + 400ms).size(), 2U);
}

TEST(ConnectionTable, CutsAfterASecondHoweverBusyTheMachineIs) {
  ConnectionTable table = table_of_six();
  table.note_lateness(1h);
  EXPECT_EQ(table.cut_all_due(start + 1100ms).size(), 2U);
}

TEST(ConnectionTable, ForgetsWhatIsClosedAndKnowsASocketByItsInode) {
  OneClient client(Wait::body);
  AcceptedSocket next = socket_from("10.0.0.2", 1);  // the same descriptor
  next.inode = 999;
  client.table.refresh(std::vector{next}, start + 9s);
  EXPECT_TRUE(client.table.cut_all_due(start + 11s).empty());
  EXPECT_FALSE(client.table.is_cut(client.key));
  client.table.refresh({}, start + 12s);
  EXPECT_TRUE(client.table.is_empty());
}

}  // namespace
}  // namespace octurn
