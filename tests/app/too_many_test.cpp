// Requests that wait for one another leave threads of the server free: further ones are refused.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/app_fixture.hpp"
#include "app/response_header.hpp"
#include "file_descriptor.hpp"
#include "http/api.hpp"

namespace octurn {
namespace {

class TooManyTest : public AppTest {
 protected:
  /// Adds a finished scan whose model has no file. @return its path
  std::string add_scan() {
    Job job = store_.create({});
    job.state = JobState::finished;
    job.snapshots_done = 1;
    job.model = Model{};
    store_.save(job);
    put(store_.folder(job.id) / "scan.json", "{}");
    return "/api/v1/scans/" + job.id;
  }

  Response get(const std::string& path) {
    Response response =
        api_.answer({.method = "GET", .path = path, .headers = {{"Host", "127.0.0.1"}}});
    if (response.status == 503) {
      const std::string* const body = std::get_if<std::string>(&response.body);
      EXPECT_TRUE(body != nullptr && body->find("too-many") != std::string::npos);
      EXPECT_EQ(header(response, "Retry-After"), "2");
      ++refused_;
    }
    return response;
  }

  /// Waits until that many requests were refused, at most for `patience`. @return how many were
  int wait_for_refusals(int count) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (refused_ < count && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return refused_;
  }

  Api api_{make_app()};
  std::atomic<int> refused_ = 0;
};

TEST_F(TooManyTest, ArchivesArePackedForTwoAtOnce) {
  const std::string scan = add_scan();
  std::atomic<bool> is_over = false;
  std::vector<std::jthread> clients;
  for (int i = 0; i < 4; ++i) {
    clients.emplace_back([&] {
      while (!is_over) {
        const int status = get(scan + "/scan.zip").status;
        EXPECT_TRUE(status == 200 || status == 503) << status;
      }
    });
  }
  EXPECT_GT(wait_for_refusals(1), 0);
  EXPECT_EQ(get("/api/v1/status").status, 200);
  is_over = true;
}

TEST_F(TooManyTest, FilesOfModelsAreMadeForSixAtOnce) {
  const std::string scan = add_scan();
  const std::filesystem::path model = store_.model_file(store_.newest_id());
  ASSERT_EQ(::mkfifo(model.c_str(), S_IRUSR | S_IWUSR), 0);  // without a writer, readers wait
  std::vector<std::jthread> clients;
  for (const char* const file :
       {"coarse.stl", "thumbnail.png", "Scan.ply", "Scan.glb", "Scan.3mf"}) {
    for (int i = 0; i < 2; ++i) {
      clients.emplace_back([this, path = scan + "/" + file] { get(path); });
    }
  }
  EXPECT_EQ(wait_for_refusals(4), 4);
  EXPECT_EQ(get("/api/v1/status").status, 200);
  const FileDescriptor writer(::open(model.c_str(), O_RDWR | O_CLOEXEC));
  clients.clear();
}

TEST_F(TooManyTest, AFileOfAScanThatIsDeletedMeanwhileIsNotFound) {
  const std::string scan = add_scan();
  const std::string first = store_.newest_id();
  add_scan();
  const std::string last = store_.newest_id();
  put(store_.model_file(last), "a model");
  const std::filesystem::path model = store_.model_file(first);
  ASSERT_EQ(::mkfifo(model.c_str(), S_IRUSR | S_IWUSR), 0);
  // An archive of models is packed in the order of the scans.
  for (const auto& [path, deleted] :
       {std::pair(std::string("/api/v1/scans.zip"), last), std::pair(scan + "/Scan.ply", first)}) {
    int status = 0;
    std::jthread client([&, asked = path] { status = get(asked).status; });
    {
      const FileDescriptor writer(::open(model.c_str(), O_WRONLY | O_CLOEXEC));  // awaits a reader
      store_.discard(deleted);
    }
    client.join();
    EXPECT_EQ(status, 404) << path;
  }
}

TEST_F(TooManyTest, AFileThatWasMadeIsSentToAll) {
  const std::string scan = add_scan();
  const std::filesystem::path model = store_.model_file(store_.newest_id());
  put(model, stl_text(std::vector{Facet{.corners = {{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}}}}}));
  EXPECT_EQ(get(scan + "/Scan.ply").status, 200);
  std::vector<std::jthread> clients;
  for (int i = 0; i < 20; ++i) {
    clients.emplace_back([&] { EXPECT_EQ(get(scan + "/Scan.ply").status, 200); });
  }
  clients.clear();
  EXPECT_EQ(refused_, 0);
}

}  // namespace
}  // namespace octurn
