// SPDX-License-Identifier: Apache-2.0
#include "monitor/web_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace rths::test {
namespace {

using std::chrono::steady_clock;

int connected_to(std::uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  static_cast<void>(
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address));
  return descriptor;
}

void write_all(int descriptor, const std::string& bytes) {
  static_cast<void>(!::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

std::string head(std::uint16_t port, const std::string& path, const std::string& headers) {
  const std::string host = headers.find("Host:") == std::string::npos
                               ? "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"
                               : "";
  return "GET " + path + " HTTP/1.1\r\n" + host + headers + "\r\n";
}

}  // namespace

std::string http_get(std::uint16_t port, const std::string& path, const std::string& headers) {
  const int descriptor = connected_to(port);
  write_all(descriptor, head(port, path, headers));
  std::string answer;
  char part[4096];
  for (ssize_t count = 0; (count = recv(descriptor, part, sizeof part, 0)) > 0;)
    answer.append(part, static_cast<std::size_t>(count));
  close(descriptor);
  return answer;
}

WebSocket::WebSocket(std::uint16_t port, const std::string& path, const std::string& headers)
    : socket_{connected_to(port)} {
  write_all(socket_, head(port, path,
                          "Connection: Upgrade\r\nUpgrade: websocket\r\n"
                          "Sec-WebSocket-Version: 13\r\n"
                          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                              headers));
  while (pending_.find("\r\n\r\n") == std::string::npos && read_more(5)) {
  }
  answer_ = pending_.substr(0, pending_.find("\r\n"));
  const auto end = pending_.find("\r\n\r\n");
  pending_.erase(0, end == std::string::npos ? pending_.size() : end + 4);
}

WebSocket::WebSocket(WebSocket&& other) noexcept
    : socket_{std::exchange(other.socket_, -1)},
      is_closed_{other.is_closed_},
      answer_{std::move(other.answer_)},
      pending_{std::move(other.pending_)} {}

WebSocket::~WebSocket() {
  if (socket_ >= 0) close(socket_);
}

bool WebSocket::read_more(double seconds) {
  pollfd ready{socket_, POLLIN, 0};
  if (is_closed_ || poll(&ready, 1, static_cast<int>(seconds * 1000)) <= 0) return false;
  char part[65536];
  const ssize_t count = recv(socket_, part, sizeof part, 0);
  is_closed_ = count <= 0;
  if (count > 0) pending_.append(part, static_cast<std::size_t>(count));
  return count > 0;
}

// Masked by zeros, as a client has to mask its frames by something.
void WebSocket::send(const std::string& text) const {
  std::string frame{'\x81'};
  constexpr std::size_t kShort = 126;
  if (text.size() < kShort) {
    frame += static_cast<char>(0x80U | text.size());
  } else {
    frame += static_cast<char>(0x80U | kShort);
    frame += static_cast<char>(text.size() >> 8U);
    frame += static_cast<char>(text.size() & 0xFFU);
  }
  frame += std::string(4, '\0') + text;
  write_all(socket_, frame);
}

std::optional<WebSocket::Frame> WebSocket::receive(double seconds) {
  const auto until = steady_clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(pending_[i]); };
    if (pending_.size() >= 2) {
      std::size_t length = byte(1) & 0x7FU, begin = 2;
      const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
      if (pending_.size() >= begin + more) {
        if (more > 0) length = 0;
        for (std::size_t i = 0; i < more; ++i) length = length << 8U | byte(begin + i);
        begin += more;
        if (pending_.size() >= begin + length) {
          const unsigned code = byte(0) & 0xFU;
          Frame frame{code == 2, pending_.substr(begin, length)};
          pending_.erase(0, begin + length);
          if (code == 1 || code == 2) return frame;
          if (code == 8) is_closed_ = true;
          continue;
        }
      }
    }
    const double left = std::chrono::duration<double>(until - steady_clock::now()).count();
    if (!read_more(std::max(0.0, left))) return std::nullopt;
  }
}

std::string WebSocket::receive_text(const std::string& word, double seconds) {
  const auto until = steady_clock::now() + std::chrono::duration<double>(seconds);
  while (steady_clock::now() < until) {
    const auto frame = receive(std::chrono::duration<double>(until - steady_clock::now()).count());
    if (!frame) return "";
    if (!frame->is_binary && frame->bytes.find(word) != std::string::npos) return frame->bytes;
  }
  return "";
}

}  // namespace rths::test
