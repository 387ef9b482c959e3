// SPDX-License-Identifier: Apache-2.0
#include "socket_keeper.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr std::size_t kMost = 256;      // sockets
constexpr int kDay = 24 * 3600 * 1000;  // [ms]
constexpr int kLooks = 50;              // a millisecond each
constexpr char kKeep = 'k', kRelease = 'r';

/// What goes over the control socket: a letter, and with `kKeep` a descriptor.
struct Note {
  char letter = 0;
  iovec content{&letter, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> ancillary{};
  msghdr header{};
  Note() {
    header.msg_iov = &content;
    header.msg_iovlen = 1;
    header.msg_control = ancillary.data();
    header.msg_controllen = ancillary.size();
  }
  Note(const Note&) = delete;
  Note& operator=(const Note&) = delete;
};

// Everything below `work` runs between fork and the end: system calls only.
struct Kept {
  std::array<pollfd, kMost + 1> news;  ///< the first is the control socket
  std::size_t count = 1;
  bool is_orphan = false;
};

void hear(Kept& kept) noexcept {
  Note note;
  const ssize_t got = recvmsg(kept.news[0].fd, &note.header, MSG_CMSG_CLOEXEC);
  if (got < 0 && errno == EINTR) return;
  if (got > 0 && note.letter == kRelease) _exit(0);
  if (got <= 0) {
    kept.is_orphan = true;
    kept.news[0].fd = -1;
    return;
  }
  const cmsghdr* const attached = CMSG_FIRSTHDR(&note.header);
  if (attached == nullptr || kept.count > kMost) return;
  int socket = -1;
  std::memcpy(&socket, CMSG_DATA(attached), sizeof socket);
  kept.news[kept.count++] = {socket, POLLRDHUP, 0};
}

void forget_closed(Kept& kept) noexcept {
  for (std::size_t i = 1; i < kept.count;) {
    if (kept.news[i].revents == 0) {
      ++i;
      continue;
    }
    close(kept.news[i].fd);
    kept.news[i] = kept.news[--kept.count];
  }
}

[[noreturn]] void work(int control) noexcept {
  prctl(PR_SET_NAME, "rths-keeper");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  setsid();  // a terminal's interrupt is not for us
  // Neither the run's files nor its pipes: who waits for their end would wait for ours.
  if (control != STDIN_FILENO) dup2(control, STDIN_FILENO);
  close_range(STDIN_FILENO + 1, ~0U, 0);
  static Kept kept;
  kept.news[0] = {STDIN_FILENO, POLLIN, 0};
  while (!kept.is_orphan || kept.count > 1) {
    if (poll(kept.news.data(), kept.count, kDay) == 0 && kept.is_orphan) break;
    forget_closed(kept);
    if (kept.news[0].revents != 0) hear(kept);
  }
  _exit(0);
}

}  // namespace

SocketKeeper::SocketKeeper() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error{fmt::format("no keeper of sockets: {}", std::strerror(errno))};
  pid_ = fork();
  if (pid_ == 0) work(ends[1]);
  close(ends[1]);
  control_ = ends[0];
  if (pid_ > 0) return;
  close(control_);
  throw Error{fmt::format("no keeper of sockets: {}", std::strerror(errno))};
}

SocketKeeper::~SocketKeeper() {
  close(control_);
  // Without anybody to keep a socket for, it ends now.
  wait_a_little();
}

void SocketKeeper::wait_a_little() {
  for (int look = 0; look < kLooks && pid_ > 0; ++look) {
    if (waitpid(pid_, nullptr, WNOHANG) != 0) pid_ = -1;
    if (pid_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
}

void SocketKeeper::keep(int socket) const {
  Note note;
  note.letter = kKeep;
  cmsghdr* const attached = CMSG_FIRSTHDR(&note.header);
  attached->cmsg_level = SOL_SOCKET;
  attached->cmsg_type = SCM_RIGHTS;
  attached->cmsg_len = CMSG_LEN(sizeof socket);
  std::memcpy(CMSG_DATA(attached), &socket, sizeof socket);
  static_cast<void>(sendmsg(control_, &note.header, MSG_NOSIGNAL));
}

void SocketKeeper::release() {
  static_cast<void>(send(control_, &kRelease, 1, MSG_NOSIGNAL));
  wait_a_little();
}

}  // namespace rths::adapters
