// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rths::test {

/// Answer of a server to a request: "HTTP/1.1 200 OK…", with headers and content.
/// @param headers  a line each, with its end
[[nodiscard]] std::string http_get(std::uint16_t port, const std::string& path,
                                   const std::string& headers = "");

/// A page without a browser.
class WebSocket {
 public:
  struct Frame {
    bool is_binary = false;
    std::string bytes;
  };
  /// @param headers  besides those of the protocol
  explicit WebSocket(std::uint16_t port, const std::string& path = "/ws",
                     const std::string& headers = "");
  ~WebSocket();
  WebSocket(WebSocket&& other) noexcept;
  WebSocket& operator=(WebSocket&&) = delete;

  /// First line of the server's answer.
  [[nodiscard]] const std::string& answer() const { return answer_; }
  [[nodiscard]] bool is_open() const { return answer_.find("101") != std::string::npos; }
  void send(const std::string& text) const;
  /// The next frame; empty if there is none within the time, or the server has closed.
  [[nodiscard]] std::optional<Frame> receive(double seconds = 5);
  /// The next text that contains a word.
  [[nodiscard]] std::string receive_text(const std::string& word, double seconds = 5);
  /// True once the server has closed.
  [[nodiscard]] bool is_closed() const { return is_closed_; }

 private:
  bool read_more(double seconds);
  int socket_ = -1;
  bool is_closed_ = false;
  std::string answer_, pending_;
};

}  // namespace rths::test
