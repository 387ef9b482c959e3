// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/server.hpp>

#include <arpa/inet.h>
#include <civetweb.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <rths/broker/assign.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/web/page.hpp>

#include "runs.hpp"
#include "viewer.hpp"

namespace rths::monitor {

namespace web {
using namespace rths::web;
extern const std::string_view kViewHtml, kViewCss, kLiveJs, kViewJs, kTestJs, kSignalsJs, kRingJs,
    kRunsJs;
}  // namespace web

namespace {

namespace fs = std::filesystem;

constexpr const char* kLoopback = "127.0.0.1";
constexpr const char* kWriteTimeoutMs = "2000";     // then a page that does not read is dropped
constexpr const char* kSilenceTimeoutMs = "90000";  // a hidden page sends one each minute
constexpr const char* kCookie = "rths_token=";

enum Http { kOk = 200, kForbidden = 403, kNotFound = 404, kMethodNotAllowed = 405 };

std::string header_of(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value == nullptr ? "" : value;
}

// Takes the same time for each wrong token of the right length.
bool is_same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i] ^ b[i]));
  return difference == 0;
}

std::string query_of(const mg_connection* connection, const char* name) {
  const char* query = mg_get_request_info(connection)->query_string;
  if (query == nullptr) return "";
  std::string value(std::char_traits<char>::length(query) + 1, '\0');
  const int length =
      mg_get_var(query, std::char_traits<char>::length(query), name, value.data(), value.size());
  value.resize(length < 0 ? 0 : static_cast<std::size_t>(length));
  return value;
}

std::string page() {
  return web::assemble({web::kViewHtml,
                        {web::kPageCss, web::kViewCss},
                        {web::kThemeJs, web::kPlotsJs, web::kFiguresJs, web::kQuantitiesJs,
                         web::kChartsJs, web::kSaveJs, web::kLiveJs, web::kTestJs, web::kSignalsJs,
                         web::kRingJs, web::kRunsJs, web::kViewJs}},
                       "{}");
}

int answer(mg_connection* connection, int status, const std::string& type,
           const std::string& content, const std::string& headers = "") {
  mg_printf(connection,
            "HTTP/1.1 %d %s\r\nContent-Type: %s; charset=utf-8\r\nContent-Length: %zu\r\n"
            "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
            "X-Frame-Options: SAMEORIGIN\r\nReferrer-Policy: no-referrer\r\n"
            "%sConnection: close\r\n\r\n",
            status, status == kOk ? "OK" : "Refused", type.c_str(), content.size(),
            headers.c_str());
  mg_write(connection, content.data(), content.size());
  return status;
}

int refuse(mg_connection* connection, int status, const std::string& reason) {
  return answer(connection, status, "text/plain", reason + "\n");
}

}  // namespace

struct PageServer::State {
  explicit State(ServerSettings given)
      : settings{std::move(given)},
        html{page()},
        ring{settings.ring, settings.roles_of, settings.limits, settings.history_bytes} {}

  ServerSettings settings;
  std::string html;
  ShownRing ring;
  std::mutex mutex;  ///< of the viewers and of the trouble
  /// Reading a recording forks, which another thread within HDF5 would not survive.
  mutable std::mutex comparing;
  std::map<const mg_connection*, std::unique_ptr<Viewer>> viewers;
  std::atomic<int> connected{0};
  std::atomic<bool> starts{true};
  std::string trouble;  ///< the server's last message while it starts
  std::uint16_t port = 0;
  mg_context* context = nullptr;

  [[nodiscard]] bool is_public() const { return !settings.listen.empty(); }
  /// Why a request is refused; empty: it is not.
  [[nodiscard]] std::string refusal(const mg_connection* connection, bool is_page) const;
  [[nodiscard]] bool has_token(const mg_connection* connection) const;
  [[nodiscard]] std::string change(const std::string& assignment, const std::string& token) const;
  void start();
  int serve(mg_connection* connection);
  int serve_run(mg_connection* connection, const std::string& relative);
  int compare(mg_connection* connection) const;

  static State& of(void* self) { return *static_cast<State*>(self); }
  static int connect(const mg_connection* connection, void* self);
  static void ready(mg_connection* connection, void* self);
  static int receive(mg_connection* connection, int bits, char* bytes, std::size_t size,
                     void* self);
  static void close(const mg_connection* connection, void* self);
  static int log(const mg_connection* connection, const char* message);
};

bool PageServer::State::has_token(const mg_connection* connection) const {
  if (settings.token.empty()) return false;
  if (is_same(query_of(connection, "token"), settings.token)) return true;
  const std::string cookies = header_of(connection, "Cookie");
  const auto at = cookies.find(kCookie);
  if (at == std::string::npos) return false;
  const auto begin = at + std::string_view{kCookie}.size();
  return is_same(cookies.substr(begin, cookies.find(';', begin) - begin), settings.token);
}

// A page of another site may send requests to this host, and a name of its own may resolve to
// loopback. A browser states both.
std::string PageServer::State::refusal(const mg_connection* connection, bool is_page) const {
  const std::string host = header_of(connection, "Host");
  const std::string origin = header_of(connection, "Origin");
  if (!is_public()) {
    bool is_own = false;
    for (const char* name : {"127.0.0.1", "localhost", "[::1]"})
      is_own = is_own || host == name || host.starts_with(std::string{name} + ":");
    if (!is_own)
      return fmt::format("the request is for host '{}', expected 127.0.0.1 or localhost", host);
  }
  if (!origin.empty() && origin != "http://" + host)
    return fmt::format("the request comes from '{}', expected this page", origin);
  if (!is_page && header_of(connection, "Sec-Fetch-Site") == "cross-site")
    return "the request comes from another site, expected this page";
  if (is_public() && !has_token(connection))
    return "the token is missing or wrong; open the address that rths view prints";
  return "";
}

std::string PageServer::State::change(const std::string& assignment,
                                      const std::string& token) const {
  if (!settings.controls) return "this page only shows; start rths view with --control";
  if (settings.token.empty() || !is_same(token, settings.token)) return "the token is wrong";
  try {
    auto attached = broker::Ring::attach(ring.name());
    const auto name = assignment.substr(0, assignment.find('='));
    const auto found = attached.map().find_signal(name);
    if (!found || attached.map().entry(*found).partition->node != "operator")
      return fmt::format("'{}' is no parameter of the ring", name);
    broker::assign(attached, {assignment});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

int PageServer::State::serve_run(mg_connection* connection, const std::string& relative) {
  const auto file = below(settings.runs, relative);
  std::error_code error;
  if (!file || !fs::is_regular_file(*file, error))
    return refuse(connection, kNotFound, "there is no file " + relative);
  mg_send_mime_file2(connection, file->c_str(), nullptr,
                     "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n");
  return kOk;
}

int PageServer::State::compare(mg_connection* connection) const {
  const auto a = below(settings.runs, query_of(connection, "a"));
  const auto b = below(settings.runs, query_of(connection, "b"));
  if (!a || !b || !settings.compare)
    return refuse(connection, kNotFound, "there are no such two runs");
  const std::unique_lock lock{comparing, std::try_to_lock};
  if (!lock)
    return answer(connection, kOk, "text/plain", "another comparison is made; repeat this one\n");
  try {
    return answer(connection, kOk, "text/plain", settings.compare(*a, *b));
  } catch (const std::exception& error) {
    return answer(connection, kOk, "text/plain", fmt::format("{}\n", error.what()));
  }
}

int PageServer::State::serve(mg_connection* connection) {
  const mg_request_info& request = *mg_get_request_info(connection);
  const std::string path = request.local_uri == nullptr ? "" : request.local_uri;
  if (std::string_view{request.request_method} != "GET")
    return refuse(connection, kMethodNotAllowed, "expected GET");
  if (const auto reason = refusal(connection, path == "/"); !reason.empty())
    return refuse(connection, kForbidden, reason);
  constexpr std::string_view kRun = "/run/";
  if (path == "/") {
    const bool keeps = is_public();  // so that links to reports need no token
    return answer(connection, kOk, "text/html", html,
                  keeps ? fmt::format("Set-Cookie: {}{}; HttpOnly; SameSite=Strict; Path=/\r\n",
                                      kCookie, settings.token)
                        : "");
  }
  if (path == "/runs.json")
    return answer(connection, kOk, "application/json",
                  settings.runs.empty() ? "[]" : runs_in(settings.runs));
  if (path == "/compare") return compare(connection);
  if (path.starts_with(kRun) && !settings.runs.empty())
    return serve_run(connection, path.substr(kRun.size()));
  return refuse(connection, kNotFound, "there is no page " + path);
}

int PageServer::State::connect(const mg_connection* connection, void* self) {
  State& state = of(self);
  std::string reason = state.refusal(connection, false);
  constexpr std::size_t kKeyLength = 24;  // civetweb drops longer ones without a word
  if (reason.empty() && header_of(connection, "Sec-WebSocket-Key").size() != kKeyLength)
    reason = fmt::format("Sec-WebSocket-Key has another length than {}", kKeyLength);
  if (reason.empty() && state.connected.fetch_add(1) >= kMostViewers) {
    state.connected.fetch_sub(1);
    reason = fmt::format("{} pages are connected already", kMostViewers);
  }
  if (reason.empty()) return 0;
  refuse(const_cast<mg_connection*>(connection), kForbidden, reason);
  return 1;
}

void PageServer::State::ready(mg_connection* connection, void* self) {
  State& state = of(self);
  auto viewer = std::make_unique<Viewer>(
      state.ring,
      [connection](const std::string& bytes, bool is_binary) {
        const int code = is_binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT;
        return mg_websocket_write(connection, code, bytes.data(), bytes.size()) > 0;
      },
      [&state](const std::string& assignment, const std::string& token) {
        return state.change(assignment, token);
      });
  const std::scoped_lock lock{state.mutex};
  state.viewers[connection] = std::move(viewer);
}

// @returns 0 to close the connection
int PageServer::State::receive(mg_connection* connection, int bits, char* bytes, std::size_t size,
                               void* self) {
  constexpr int kIsLast = 0x80, kCode = 0xF;
  constexpr std::size_t kMostBytes = 1 << 16;
  if ((bits & kCode) == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) return 0;
  if ((bits & kCode) != MG_WEBSOCKET_OPCODE_TEXT) return 1;
  if ((bits & kIsLast) == 0 || size > kMostBytes) return 0;
  State& state = of(self);
  Viewer* viewer = nullptr;
  {
    const std::scoped_lock lock{state.mutex};
    const auto found = state.viewers.find(connection);
    if (found != state.viewers.end()) viewer = found->second.get();
  }
  // Only this thread of the connection removes its viewer.
  return viewer != nullptr && viewer->is_reading() && viewer->receive({bytes, size}) ? 1 : 0;
}

void PageServer::State::close(const mg_connection* connection, void* self) {
  State& state = of(self);
  std::unique_ptr<Viewer> gone;
  {
    const std::scoped_lock lock{state.mutex};
    const auto found = state.viewers.find(connection);
    if (found == state.viewers.end()) return;
    gone = std::move(found->second);
    state.viewers.erase(found);
  }
  gone.reset();
  state.connected.fetch_sub(1);
}

int PageServer::State::log(const mg_connection* connection, const char* message) {
  const mg_context* context = mg_get_context(connection);
  if (context == nullptr) return 1;
  State& state = of(mg_get_user_data(context));
  const std::scoped_lock lock{state.mutex};
  if (state.starts.load()) state.trouble = message;
  return 1;
}

void PageServer::State::start() {
  const std::string port_text =
      fmt::format("{}:{}", is_public() ? settings.listen : std::string{kLoopback}, settings.port);
  const std::string threads = std::to_string(kMostViewers + 8);
  const char* options[] = {"listening_ports",
                           port_text.c_str(),
                           "num_threads",
                           threads.c_str(),
                           "request_timeout_ms",
                           kWriteTimeoutMs,
                           "websocket_timeout_ms",
                           kSilenceTimeoutMs,
                           "tcp_nodelay",
                           "1",
                           nullptr};
  mg_init_library(MG_FEATURES_WEBSOCKET);
  mg_callbacks callbacks{};
  callbacks.log_message = log;
  context = mg_start(&callbacks, this, static_cast<const char**>(options));
  mg_server_port found{};
  if (context == nullptr || mg_get_server_ports(context, 1, &found) < 1)
    throw Error{fmt::format("{} cannot be used for the page{}{}; choose another --port", port_text,
                            trouble.empty() ? "" : ": ", trouble)};
  starts.store(false);
  port = static_cast<std::uint16_t>(found.port);
  mg_set_websocket_handler(context, "/ws", connect, ready, receive, close, this);
  mg_set_request_handler(
      context, "/",
      [](mg_connection* connection, void* self) { return of(self).serve(connection); }, this);
}

PageServer::PageServer(ServerSettings settings) {
  if (!settings.listen.empty() && settings.token.empty())
    throw Error{"other hosts may view the page with a token only; state --token"};
  // The token is a part of addresses and of a cookie.
  const auto is_plain = [](char c) { return is_letter_or_digit(c) || c == '-' || c == '_'; };
  if (!std::all_of(settings.token.begin(), settings.token.end(), is_plain))
    throw Error{"the token has other characters, expected letters, digits, '-' and '_'"};
  in_addr address{};
  if (!settings.listen.empty() && inet_pton(AF_INET, settings.listen.c_str(), &address) != 1)
    throw Error{fmt::format("found '{}' to listen on, expected an IPv4 address of this host",
                            settings.listen)};
  state_ = std::make_unique<State>(std::move(settings));
  state_->start();
}

// The server's first thread looks at the stop flag when it wakes: a connection wakes it.
PageServer::~PageServer() {
  if (state_->context == nullptr) return;
  std::thread stop{[this] { mg_stop(state_->context); }};
  std::this_thread::sleep_for(std::chrono::milliseconds{20});
  char ignored[256];
  if (mg_connection* self = mg_connect_client(kLoopback, state_->port, 0, ignored, sizeof ignored))
    mg_close_connection(self);
  stop.join();
  mg_exit_library();
}

std::uint16_t PageServer::port() const { return state_->port; }

int PageServer::viewers() const { return state_->connected.load(); }

std::string PageServer::url() const {
  const auto& settings = state_->settings;
  const std::string host = settings.listen.empty() || settings.listen == "0.0.0.0"
                               ? std::string{kLoopback}
                               : settings.listen;
  const bool shows = !settings.token.empty() && (settings.controls || state_->is_public());
  return fmt::format("http://{}:{}/{}{}", host, state_->port, shows ? "?token=" : "",
                     shows ? settings.token : "");
}

}  // namespace rths::monitor
