// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/server.hpp>

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <list>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "monitor/laboratory.hpp"
#include "monitor/web_socket.hpp"
#include "support/files.hpp"
#include "support/ring_maps.hpp"

namespace rths::monitor {
namespace {

using test::http_get;
using test::Laboratory;
using test::settings_for;
using test::unique_ring;
using test::WebSocket;

bool becomes(const std::function<bool()>& is_so, double seconds = 20) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!is_so() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  return is_so();
}

/// Header of a binary frame, as the page reads it.
struct Header {
  std::uint32_t kind, epoch;
  double from;
  std::uint32_t width, intervals, words, id;
};

// The next frame of a kind.
std::optional<std::pair<Header, std::string>> next_frame(WebSocket& page, std::uint32_t kind) {
  for (int i = 0; i < 500; ++i) {
    const auto frame = page.receive();
    if (!frame) return std::nullopt;
    Header header{};
    if (!frame->is_binary || frame->bytes.size() < sizeof header) continue;
    std::memcpy(&header, frame->bytes.data(), sizeof header);
    if (header.kind == kind) return std::pair{header, frame->bytes.substr(sizeof header)};
  }
  return std::nullopt;
}

TEST(Server, ServesThePageToThisHost) {
  const PageServer server{settings_for(unique_ring("page"))};

  const std::string page = http_get(server.port(), "/");

  EXPECT_TRUE(page.starts_with("HTTP/1.1 200")) << page.substr(0, 200);
  EXPECT_NE(page.find("<title>rths view</title>"), std::string::npos);
}

TEST(Server, RefusesRequestsOfOtherSites) {
  const PageServer server{settings_for(unique_ring("sites"))};
  const std::string port = std::to_string(server.port());

  for (const std::string headers :
       {"Origin: http://evil.example\r\n", "Sec-Fetch-Site: cross-site\r\n", "Origin: null\r\n",
        "Host: evil.example\r\n", "Host: evil.example:80\r\nOrigin: http://evil.example:80\r\n"}) {
    EXPECT_NE(WebSocket(server.port(), "/ws", headers).answer().find("403"), std::string::npos)
        << headers;
    EXPECT_TRUE(http_get(server.port(), "/runs.json", headers).starts_with("HTTP/1.1 403"))
        << headers;
  }
  EXPECT_TRUE(
      WebSocket(server.port(), "/ws", "Origin: http://127.0.0.1:" + port + "\r\n").is_open());
}

TEST(Server, WantsATokenFromOtherHosts) {
  auto settings = settings_for(unique_ring("token"));
  settings.listen = "127.0.0.1";
  EXPECT_THROW(PageServer{settings}, Error);
  settings.token = "secret";
  const PageServer server{settings};

  EXPECT_TRUE(http_get(server.port(), "/").starts_with("HTTP/1.1 403"));
  EXPECT_TRUE(http_get(server.port(), "/?token=secreT").starts_with("HTTP/1.1 403"));
  const std::string page = http_get(server.port(), "/?token=secret");
  EXPECT_TRUE(page.starts_with("HTTP/1.1 200"));
  EXPECT_NE(page.find("Set-Cookie: rths_token=secret"), std::string::npos);
  EXPECT_FALSE(WebSocket(server.port()).is_open());
  EXPECT_TRUE(WebSocket(server.port(), "/ws?token=secret").is_open());
  EXPECT_TRUE(WebSocket(server.port(), "/ws", "Cookie: rths_token=secret\r\n").is_open());
}

TEST(Server, SendsWatchedWordsAsExtents) {
  const Laboratory laboratory{unique_ring("extents")};
  const PageServer server{settings_for(unique_ring("extents"))};
  WebSocket page{server.port()};
  ASSERT_NE(page.receive_text("\"kind\":\"map\""), "");

  page.send(R"({"watch": [0, 99999], "width_bits": 4, "from": 0, "id": 7})");

  double expected_from = 0;
  for (int i = 0; i < 5; ++i) {
    const auto frame = next_frame(page, 1);
    ASSERT_TRUE(frame);
    const auto& [header, body] = *frame;
    EXPECT_EQ(header.id, 7U);
    EXPECT_EQ(header.width, 16U);
    EXPECT_EQ(header.words, 1U);
    EXPECT_TRUE(i == 0 || header.from == expected_from) << header.from;
    expected_from = header.from + 16.0 * header.intervals;
    ASSERT_EQ(body.size(), 4 + 8 * std::size_t{header.intervals});
  }
}

TEST(Server, SendsAnIntervalOfThePast) {
  const Laboratory laboratory{unique_ring("past")};
  const PageServer server{settings_for(unique_ring("past"))};
  WebSocket page{server.port()};
  ASSERT_NE(page.receive_text("\"kind\":\"map\""), "");
  ASSERT_TRUE(becomes([&] { return laboratory.steps() > 2000; }));

  page.send(R"({"range": [0], "width_bits": 0, "from": 1000, "intervals": 200, "id": 8})");

  const auto frame = next_frame(page, 2);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->first.from, 1000);
  EXPECT_EQ(frame->first.intervals, 200U);
}

TEST(Server, ChangesAParameterWithTheTokenOnly) {
  const Laboratory laboratory{unique_ring("control")};
  auto settings = settings_for(unique_ring("control"));
  settings.controls = true;
  settings.token = "secret";
  const PageServer server{settings};
  WebSocket page{server.port()};
  ASSERT_NE(page.receive_text("\"kind\":\"map\""), "");
  const auto answer_to = [&](const std::string& message) {
    page.send(message);
    return page.receive_text("\"kind\":\"set\"");
  };

  EXPECT_NE(answer_to(R"({"set": "tune.srmd.gain=2", "id": 1})").find("the token is wrong"),
            std::string::npos);
  EXPECT_NE(answer_to(R"({"set": "tune.srmd.gain=2", "token": "no", "id": 2})").find("wrong"),
            std::string::npos);
  const std::string beyond =
      answer_to(R"({"set": "tune.srmd.gain=3", "token": "secret", "id": 3})");
  EXPECT_NE(beyond.find("expected 0.5 to 2"), std::string::npos) << beyond;
  const std::string other =
      answer_to(R"({"set": "monitor.xpc.host.step=3", "token": "secret", "id": 4})");
  EXPECT_NE(other.find("no parameter"), std::string::npos) << other;
  const std::string done = answer_to(R"({"set": "tune.srmd.gain=2", "token": "secret", "id": 5})");
  EXPECT_NE(done.find("\"error\":\"\""), std::string::npos) << done;
  EXPECT_NE(page.receive_text("tune.srmd.gain: 1 to 2"), "");
}

TEST(Server, ChangesNothingUnlessItIsAskedTo) {
  const Laboratory laboratory{unique_ring("readonly")};
  auto settings = settings_for(unique_ring("readonly"));
  settings.token = "secret";
  const PageServer server{settings};
  WebSocket page{server.port()};

  page.send(R"({"set": "tune.srmd.gain=2", "token": "secret", "id": 1})");

  EXPECT_NE(page.receive_text("\"kind\":\"set\"").find("--control"), std::string::npos);
}

TEST(Server, GoesOnWithARingThatReplacesAnother) {
  std::optional<Laboratory> laboratory{std::in_place, unique_ring("again")};
  const PageServer server{settings_for(unique_ring("again"))};
  WebSocket page{server.port()};
  ASSERT_NE(page.receive_text("\"epoch\":1,\"ring\""), "");

  laboratory.reset();
  ASSERT_NE(page.receive_text("the ring has ended"), "");
  laboratory.emplace(unique_ring("again"), 5);  // with another map

  const std::string map = page.receive_text("\"epoch\":2,\"ring\"");
  EXPECT_NE(map.find("extra.4"), std::string::npos) << map.substr(0, 200);
  EXPECT_NE(page.receive_text("\"live\":true"), "");
}

TEST(Server, WaitsForItsRing) {
  const PageServer server{settings_for(unique_ring("later"))};
  WebSocket page{server.port()};
  EXPECT_NE(page.receive_text("there is no ring 'test_later"), "");

  const Laboratory laboratory{unique_ring("later")};

  EXPECT_NE(page.receive_text("\"kind\":\"map\""), "");
}

TEST(Server, HasFiftyViewersAndRefusesOneMore) {
  const Laboratory laboratory{unique_ring("fifty"), 10};
  const PageServer server{settings_for(unique_ring("fifty"))};
  std::list<WebSocket> pages;
  for (int i = 0; i < PageServer::kMostViewers; ++i) {
    pages.emplace_back(server.port());
    ASSERT_TRUE(pages.back().is_open()) << i;
    pages.back().send(R"({"watch": [0, 1, 2], "width_bits": 4, "from": 0, "id": 1})");
  }

  EXPECT_FALSE(WebSocket(server.port()).is_open());
  for (auto& page : pages) EXPECT_TRUE(next_frame(page, 1));

  pages.clear();
  EXPECT_TRUE(becomes([&] { return server.viewers() == 0; }));
  EXPECT_TRUE(WebSocket(server.port()).is_open());
}

TEST(Server, DropsAViewerThatStopsReading) {
  const Laboratory laboratory{unique_ring("stopped"), 200};
  const PageServer server{settings_for(unique_ring("stopped"))};
  WebSocket stopped{server.port()}, reading{server.port()};
  ASSERT_NE(stopped.receive_text("\"kind\":\"map\""), "");
  std::string words = "0";
  for (int i = 1; i < 200; ++i) words += "," + std::to_string(i);
  const std::string all = "[" + words + "], \"width_bits\": 0, \"from\": 0, \"id\": 1}";

  ASSERT_TRUE(becomes([&] { return laboratory.steps() > 2000; }));
  reading.send("{\"watch\": [0], \"width_bits\": 4, \"from\": 0, \"id\": 1}");
  stopped.send("{\"watch\": " + all);

  EXPECT_TRUE(becomes(
      [&] {
        EXPECT_TRUE(next_frame(reading, 1));
        stopped.send(R"({"alive": 1})");  // as a page whose scripts run but whose network is stuck
        return server.viewers() == 1;
      },
      40));
  EXPECT_TRUE(next_frame(reading, 1));
}

TEST(Server, ListsRunsAndServesTheirFilesOnly) {
  const test::TemporaryFolder folder;
  for (const char* run : {"good", "half", "broken"})
    std::filesystem::create_directories(folder.path() / "out" / run);
  folder.write("out/good/run.h5", "");
  folder.write("out/good/report.html", "a report");
  folder.write("out/good/report.json",
               R"({"name": "demo", "conclusive": true, "axes": {"long": {"nrms_percent": 0.25}}})");
  folder.write("out/half/run.h5", "");
  folder.write("out/broken/run.h5", "");
  folder.write("out/broken/report.json", "{");
  folder.write("secret.txt", "a secret");
  auto settings = settings_for(unique_ring("runs"));
  settings.runs = folder.path() / "out";
  const PageServer server{settings};

  const std::string runs = http_get(server.port(), "/runs.json");

  EXPECT_NE(runs.find(R"("report":"report.html","name":"demo","conclusive":true)"),
            std::string::npos)
      << runs;
  EXPECT_NE(runs.find("no report"), std::string::npos) << runs;
  EXPECT_NE(runs.find("cannot be read"), std::string::npos) << runs;
  EXPECT_NE(http_get(server.port(), "/run/good/report.html").find("a report"), std::string::npos);
  for (const char* path : {"/run/../secret.txt", "/run/%2e%2e/secret.txt", "/run//../secret.txt",
                           "/run/good/../../secret.txt", "/run/none"})
    EXPECT_EQ(http_get(server.port(), path).find("a secret"), std::string::npos) << path;
}

// Reading a recording forks, which a second reader would not survive.
TEST(Server, ComparesOnePairAtATime) {
  const test::TemporaryFolder runs;
  std::filesystem::create_directories(runs.path() / "a");
  auto settings = settings_for(unique_ring("one_pair"));
  settings.runs = runs.path();
  std::atomic<bool> has_begun{false}, ends{false};
  settings.compare = [&](const auto&, const auto&) -> std::string {
    has_begun.store(true);
    EXPECT_TRUE(becomes([&] { return ends.load(); }));
    return "compared";
  };
  const PageServer server{settings};
  std::string first;
  std::thread other{[&] { first = http_get(server.port(), "/compare?a=a&b=a"); }};
  ASSERT_TRUE(becomes([&] { return has_begun.load(); }));

  EXPECT_NE(http_get(server.port(), "/compare?a=a&b=a").find("another comparison"),
            std::string::npos);

  ends.store(true);
  other.join();
  EXPECT_NE(first.find("compared"), std::string::npos);
}

TEST(Server, RefusesAnAddressOrATokenThatIsNone) {
  const auto error = [](const std::string& listen, const std::string& token) {
    auto settings = settings_for("none");
    settings.listen = listen;
    settings.token = token;
    return test::error_of([&] { PageServer{settings}; });
  };

  EXPECT_EQ(error("127.0.0.1:9,0.0.0.0", "secret"),
            "found '127.0.0.1:9,0.0.0.0' to listen on, expected an IPv4 address of this host");
  EXPECT_EQ(error("", "a b;c"),
            "the token has other characters, expected letters, digits, '-' and '_'");
}

TEST(Server, DoesNotWaitForARingWhoseNameIsImpossible) {
  const auto error = [](const std::string& ring) {
    return test::error_of([&] { PageServer{settings_for(ring)}; });
  };

  EXPECT_EQ(error("a/b"),
            "no ring can have the name 'a/b', expected at most 250 bytes without '/'");
  EXPECT_NE(error(std::string(251, 'a')), "");
  EXPECT_EQ(error(std::string(250, 'a')), "");
}

TEST(Server, ComparesTwoRuns) {
  const test::TemporaryFolder folder;
  for (const char* run : {"a", "b"}) std::filesystem::create_directory(folder.path() / run);
  folder.write("a/run.h5", "");
  folder.write("b/run.h5", "");
  auto settings = settings_for(unique_ring("compare"));
  settings.runs = folder.path();
  settings.compare = [](const auto& a, const auto& b) -> std::string {
    if (a == b) throw Error{"the same run"};
    return a.filename().string() + " and " + b.filename().string();
  };
  const PageServer server{settings};

  EXPECT_NE(http_get(server.port(), "/compare?a=a&b=b").find("a and b"), std::string::npos);
  EXPECT_NE(http_get(server.port(), "/compare?a=a&b=a").find("the same run"), std::string::npos);
  EXPECT_TRUE(http_get(server.port(), "/compare?a=a&b=..%2F..").starts_with("HTTP/1.1 404"));
}

TEST(Server, RefusesMessagesThatAreNone) {
  const PageServer server{settings_for(unique_ring("messages"))};
  for (const char* message : {"no JSON", "[]", "{}", R"({"watch": "all"})"}) {
    WebSocket page{server.port()};
    page.send(message);
    EXPECT_TRUE(becomes(
        [&] {
          static_cast<void>(page.receive(0.05));
          return page.is_closed();
        },
        5))
        << message;
  }
}

TEST(Server, StatesAPortThatIsTaken) {
  const PageServer first{settings_for(unique_ring("taken"))};
  auto settings = settings_for(unique_ring("taken"));
  settings.port = first.port();
  try {
    const PageServer second{settings};
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string{error.what()}.find("choose another --port"), std::string::npos);
  }
}

}  // namespace
}  // namespace rths::monitor
