// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/live_view.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "support/small_run.h"
#include "viewer/unpack_array.h"

namespace pliant {
namespace {

using nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

constexpr double kLiveQuantized_mm = 0.01;  // 16 bits over the extent of the points

class LiveViewTest : public testing::Test {
 protected:
  void SetUp() override {
    auto live = LiveView::Start({"run", true}, {.port = 0});
    ASSERT_TRUE(live.ok()) << live.status().message();
    live_ = *std::move(live);
    url_ = live_->Url();
    live_->OnCamera(TestCamera());
    live_->OnStart(kRunFrames);
  }
  ordered_json Data(int epoch, int from) const {
    const auto answer = httplib::Client(url_.substr(0, url_.size() - 1))
                            .Get("/data?epoch=" + std::to_string(epoch) + "&from=" + std::to_string(from));
    return answer && answer->status == 200 ? ordered_json::parse(answer->body) : ordered_json();
  }

  std::unique_ptr<LiveView> live_;
  std::string url_;
};

TEST_F(LiveViewTest, GivesThePageAndWhatIsNew) {
  const auto page = httplib::Client(url_.substr(0, url_.size() - 1)).Get("/");
  ASSERT_TRUE(page);
  EXPECT_THAT(page->body, HasSubstr("\"live\":true"));
  live_->OnFrame(Report(0));
  live_->OnFrame(Report(1));
  const ordered_json first = Data(0, 0);
  EXPECT_EQ(first["from"], 0);
  EXPECT_EQ(first["running"], true);
  EXPECT_EQ(first["frames_in_sequence"], kRunFrames);
  EXPECT_THAT(first["data"]["runs"][0]["frames"]["frame"], ElementsAre(10, 12));
  EXPECT_EQ(first["data"]["camera"]["width"], 640);
  EXPECT_EQ(first["data"]["unit"], "mm");
  EXPECT_EQ(first["data"]["runs"][0]["unit"], "mm");
  live_->OnFrame(Report(2));
  const ordered_json then = Data(0, 2);
  EXPECT_EQ(then["from"], 2);
  EXPECT_THAT(then["data"]["runs"][0]["frames"]["frame"], ElementsAre(14));
  EXPECT_THAT(then["data"]["runs"][0]["points"]["id"]["rows"], kRunPoints);
  EXPECT_THAT(Data(0, 3)["data"]["runs"][0]["frames"]["frame"], SizeIs(0));
  EXPECT_EQ(Data(0, 99)["from"], 0);  // of another run
}

TEST_F(LiveViewTest, ARunThatIsKeptIsServedAfterItsEnd) {
  live_->OnImage(10, cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)));
  live_->OnFrame(Report(0));
  EXPECT_EQ(Data(0, 0)["kept"], false);
  while (Data(0, 0)["image_frames"].empty()) std::this_thread::yield();  // it is encoded on a thread of its own
  live_->KeepRun();
  const ordered_json data = Data(0, 0);
  EXPECT_EQ(data["running"], false);
  EXPECT_EQ(data["kept"], true);
  EXPECT_THAT(data["data"]["runs"][0]["frames"]["frame"], ElementsAre(10));
  const auto image = httplib::Client(url_.substr(0, url_.size() - 1)).Get("/image/10.jpg");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->status, 200);
  const auto begin = std::chrono::steady_clock::now();
  live_.reset();  // nobody is waited for: the program has been asked to end
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

TEST_F(LiveViewTest, ARefinedPointIsNewAgain) {
  live_->OnFrame(Report(0));
  FrameReport report = Report(1);
  report.observations.clear();
  report.refined_points = {{PointId{3}, {1, 2, 3}}};
  live_->OnFrame(report);
  const ordered_json points = Data(0, 1)["data"]["runs"][0]["points"];
  EXPECT_THAT(Unpack(points["id"]), ElementsAre(3));
  EXPECT_THAT(Unpack(points["rest"]), ElementsAre(1, 2, 3));
}

TEST_F(LiveViewTest, AMergeMakesWhatWasGivenVoid) {
  live_->OnFrame(Report(0));
  FrameReport other = ReportOfSecondSubmap(0);
  const Sim3 into_from_submap = {2, Eigen::Quaterniond::Identity(), {1, 0, 0}};
  other.merge = SubmapMerge{1, 0, into_from_submap};
  live_->OnFrame(other);
  const ordered_json all = Data(0, 1);
  EXPECT_EQ(all["epoch"], 1);
  EXPECT_EQ(all["from"], 0);
  const ordered_json& run = all["data"]["runs"][0];
  EXPECT_THAT(run["frames"]["submap"], ElementsAre(0, 0));
  const std::vector<double> rest = Unpack(run["points"]["rest"]);
  const Eigen::Vector3d moved = into_from_submap * Undeformed(0);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(rest[static_cast<std::size_t>(3 * kRunPoints + i)], moved[i], kLiveQuantized_mm);
}

TEST_F(LiveViewTest, SaysWhatItWaitsFor) {
  FrameReport held;
  held.state = TrackingState::kInitializing;
  live_->OnImage(0, cv::Mat::zeros(480, 640, CV_8UC1));
  live_->OnHeld(held);
  const ordered_json data = Data(0, 0);
  EXPECT_EQ(data["state"], "initializing");
  EXPECT_EQ(data["read"], 1);
}

TEST_F(LiveViewTest, GivesTheImagesThatItLists) {
  httplib::Client client(url_.substr(0, url_.size() - 1));
  EXPECT_EQ(client.Get("/image/4.jpg")->status, 404);
  live_->OnImage(3, cv::Mat::zeros(480, 640, CV_8UC1));
  for (int tries = 0; tries < 200 && client.Get("/image/3.jpg")->status != 200; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto image = client.Get("/image/3.jpg");
  EXPECT_EQ(image->status, 200);
  EXPECT_EQ(image->get_header_value("Content-Type"), "image/jpeg");
  EXPECT_EQ(client.Get("/image/2.jpg")->status, 404);
  EXPECT_THAT(Data(0, 0)["image_frames"], ElementsAre(3));
  EXPECT_EQ(Data(0, 0)["image_scale"], 0.75);
}

TEST_F(LiveViewTest, AnswersThisMachineAlone) {
  httplib::Client client(url_.substr(0, url_.size() - 1));
  EXPECT_EQ(client.Get("/", {{"Host", "elsewhere.example:80"}})->status, 403);
  EXPECT_EQ(client.Get("/", {{"Host", "localhost:80"}})->status, 200);
  EXPECT_THAT(url_, testing::StartsWith("http://127.0.0.1:"));
}

TEST_F(LiveViewTest, GivesNothingToThoseWhoSendBodiesOrWantRanges) {
  httplib::Client client(url_.substr(0, url_.size() - 1));
  const auto posted = client.Post("/data", std::string(1 << 24, 'x'), "text/plain");
  EXPECT_TRUE(!posted || posted->status == 405);  // or the connection is closed while the body is sent
  std::string ranges = "bytes=0-";
  for (int k = 0; k < 1000; ++k) ranges += ",0-";
  const auto answer = client.Get("/", {{"Range", ranges}});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 416);
  EXPECT_EQ(answer->body, "");
}

TEST_F(LiveViewTest, GivesPagesUncompressed) {
  httplib::Client client(url_.substr(0, url_.size() - 1));
  client.set_decompress(false);
  const auto page = client.Get("/", {{"Accept-Encoding", "br, gzip, deflate"}});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->get_header_value("Content-Encoding"), "");
  EXPECT_THAT(page->body, HasSubstr("</html>"));
}

TEST_F(LiveViewTest, APortThatIsTakenBecomesAnother) {
  const int taken = std::stoi(url_.substr(url_.rfind(':') + 1));
  const auto other = LiveView::Start({"other"}, {.port = taken});
  ASSERT_TRUE(other.ok()) << other.status().message();
  EXPECT_NE((*other)->Url(), url_);
}

TEST_F(LiveViewTest, WithoutABrowserItEndsAtOnce) {
  const auto begin = std::chrono::steady_clock::now();
  live_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

TEST_F(LiveViewTest, AnIdleConnectionDoesNotKeepItFromEnding) {
  httplib::Client client(url_.substr(0, url_.size() - 1));
  client.set_keep_alive(true);
  EXPECT_EQ(client.Get("/")->status, 200);
  const auto begin = std::chrono::steady_clock::now();
  live_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

// A client that sends the beginning of a request, and then a byte now and then.
class SlowClient {
 public:
  explicit SlowClient(const std::string& url) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    sender_ = std::thread([this] {
      const std::string begin = "GET / HTTP/1.1\r\nHost: localhost\r\nX: ";
      send(socket_, begin.data(), begin.size(), MSG_NOSIGNAL);
      while (!ends_ && send(socket_, "x", 1, MSG_NOSIGNAL) == 1)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    });
  }
  ~SlowClient() {
    ends_ = true;
    sender_.join();
    close(socket_);
  }
  SlowClient(const SlowClient&) = delete;
  SlowClient& operator=(const SlowClient&) = delete;

 private:
  int socket_;
  std::atomic<bool> ends_ = false;
  std::thread sender_;
};

TEST_F(LiveViewTest, SlowClientsDoNotKeepItFromEnding) {
  std::vector<std::unique_ptr<SlowClient>> clients;  // more than are answered at a time, and as many as are let in
  for (int k = 0; k < 12; ++k) clients.push_back(std::make_unique<SlowClient>(url_.substr(0, url_.size() - 1)));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto begin = std::chrono::steady_clock::now();
  live_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

TEST_F(LiveViewTest, WhoLooksLearnsOfTheEnd) {
  EXPECT_EQ(Data(0, 0)["running"], true);
  bool told = false;
  std::thread browser([&] {
    for (int tries = 0; tries < 100 && !told; ++tries) {
      const ordered_json data = Data(0, 0);
      told = !data.is_null() && data["running"] == false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  live_.reset();
  browser.join();
  EXPECT_TRUE(told);
}

TEST_F(LiveViewTest, WhoWaitsIsToldTheEndAtOnce) {
  std::thread browser([&] {
    const auto begin = std::chrono::steady_clock::now();
    const auto answer = httplib::Client(url_.substr(0, url_.size() - 1)).Get("/data?epoch=0&from=0&wait_ms=4000");
    ASSERT_TRUE(answer);
    EXPECT_EQ(ordered_json::parse(answer->body)["running"], false);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  live_.reset();
  browser.join();
}

}  // namespace
}  // namespace pliant
