// SPDX-License-Identifier: Apache-2.0
#include "probe.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <set>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths::recording {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

// Processor time of the child. The clock allows more: on a loaded host it gets a part of a
// processor.
constexpr std::uint64_t kShortest = 10;          // [s]
constexpr std::uint64_t kSlowest = 10'000'000;   // [B/s]
constexpr std::uint64_t kClockPerProcessor = 6;  // [-]
constexpr std::uint64_t kLeastMemory = std::uint64_t{4} << 30U;
constexpr std::uint64_t kMemoryPerByte = 16;  // of a file, which may be compressed

bool is_child = false;

void check_readable(const std::filesystem::path& file) {
  check_is_file(file);
  if (access(file.c_str(), R_OK) != 0)
    throw Error{fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno))};
}

// Sanitizers reserve more memory than any limit. Libraries define __has_feature for g++, as 0.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSanitized = true;
#elif defined(__has_feature)
constexpr bool kIsSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool kIsSanitized = false;
#endif

std::uint64_t most_seconds(std::uint64_t file_bytes) { return kShortest + file_bytes / kSlowest; }

void limit_resources(std::uint64_t file_bytes) {
  if (!kIsSanitized) {
    const std::uint64_t most = kLeastMemory + kMemoryPerByte * file_bytes;
    const rlimit limit{most, most};
    setrlimit(RLIMIT_AS, &limit);
  }
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const rlimit time{most_seconds(file_bytes), most_seconds(file_bytes)};
  setrlimit(RLIMIT_CPU, &time);
}

// Answers of the child; the message follows an error.
constexpr char kFalse = '0';
constexpr char kTrue = '1';
constexpr char kError = 'e';

// Nothing else of the parent runs in the child.
[[noreturn]] void answer(int to, const std::function<bool()>& act) {
  std::string text;
  try {
    text = std::string(1, act() ? kTrue : kFalse);
  } catch (const Error& error) {
    text = std::string(1, kError) + error.what();
  } catch (const std::exception&) {
    _exit(1);  // of the library, or of the memory
  }
  _exit(write(to, text.data(), text.size()) < 0 ? 1 : 0);
}

// What a child answered.
struct Reply {
  std::string text;  // empty: it crashed, or was too late
  bool is_too_late = false;
};

// Reads until the end, which is also the end of the child.
Reply await(int from, seconds longest) {
  std::string text;
  std::array<char, 512> chunk{};
  for (const auto deadline = steady_clock::now() + longest;;) {
    const auto left =
        std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now()).count();
    pollfd descriptor{from, POLLIN, 0};
    if (left <= 0 || poll(&descriptor, 1, static_cast<int>(left)) <= 0) return {"", true};
    const ssize_t count = read(from, chunk.data(), chunk.size());
    if (count <= 0) return {text, false};
    text.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

// A reader that uses up its processor time is ended by the system before the clock runs out: one
// that is late was not run.
[[noreturn]] void fail_without(const Reply& reply, const std::filesystem::path& file,
                               seconds longest) {
  if (reply.is_too_late)
    throw Error{fmt::format("{}: was not read within {} s: this host was too busy to read it",
                            file.string(), longest.count())};
  throw Error{file.string() + ": is damaged: reading it crashed, or took too much time or memory"};
}

}  // namespace

bool in_child(const std::filesystem::path& file, const std::function<bool()>& act) {
  check_readable(file);
  const std::uint64_t bytes = std::filesystem::file_size(file);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error{file.string() + ": no pipe to read it"};
  const pid_t child = fork();
  if (child == 0) {
    is_child = true;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    limit_resources(bytes);
    // A child that sleeps uses no processor time.
    alarm(static_cast<unsigned>(kClockPerProcessor * most_seconds(bytes)));
    const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    close(ends[0]);
    answer(ends[1], act);
  }
  close(ends[1]);
  const seconds longest{kClockPerProcessor * most_seconds(bytes)};
  const Reply reply = child < 0 ? Reply{} : await(ends[0], longest);
  close(ends[0]);
  if (child > 0) kill(child, SIGKILL);
  if (child > 0) waitpid(child, nullptr, 0);
  if (reply.text.empty()) fail_without(reply, file, longest);
  if (reply.text[0] == kError) throw Error{reply.text.substr(1)};
  return reply.text[0] == kTrue;
}

void probe(const std::filesystem::path& file, const std::function<void()>& read) {
  check_readable(file);
  struct stat now {};
  if (is_child || stat(file.c_str(), &now) != 0) return;
  static std::set<std::array<std::int64_t, 5>> probed;
  const std::array<std::int64_t, 5> version{static_cast<std::int64_t>(now.st_dev),
                                            static_cast<std::int64_t>(now.st_ino), now.st_size,
                                            now.st_mtim.tv_sec, now.st_mtim.tv_nsec};
  if (!probed.insert(version).second) return;
  try {
    static_cast<void>(in_child(file, [&] {
      read();
      return true;
    }));
  } catch (const Error&) {
    probed.erase(version);
    throw;
  }
}

}  // namespace rths::recording
