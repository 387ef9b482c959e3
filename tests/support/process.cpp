// SPDX-License-Identifier: Apache-2.0
#include "process.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "files.hpp"
#include "host_time.hpp"

namespace rths::test {
namespace {

using std::chrono::steady_clock;

// Appends the available output; closes the descriptor at the end of the stream.
void drain(int& descriptor, std::string& into) {
  std::array<char, 4096> chunk{};
  while (descriptor >= 0) {
    const ssize_t count = read(descriptor, chunk.data(), chunk.size());
    if (count > 0) {
      into.append(chunk.data(), static_cast<std::size_t>(count));
    } else {
      if (count == 0) {
        close(descriptor);
        descriptor = -1;
      }
      return;
    }
  }
}

// A file of a process in /proc; empty if the process ends meanwhile.
std::string process_file(int pid, const char* name) {
  try {
    return content_of("/proc/" + std::to_string(pid) + "/" + name);
  } catch (const std::ios_base::failure&) {
    return "";
  }
}

}  // namespace

Running::Running(const std::vector<std::string>& command) {
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) std::abort();
  std::vector<char*> argv;
  std::vector<std::string> words = command;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
  fcntl(out_, F_SETFL, O_NONBLOCK);
  fcntl(err_, F_SETFL, O_NONBLOCK);
}

Running::~Running() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (out_ >= 0) close(out_);
  if (err_ >= 0) close(err_);
}

void Running::read_available() {
  drain(out_, finished_.out);
  drain(err_, finished_.err);
}

Finished Running::wait(double deadline_s) {
  const auto begun = steady_clock::now();
  const double granted = host_time();
  int status = 0;
  while (waitpid(pid_, &status, WNOHANG) == 0) {
    if (host_time() - granted > deadline_s) kill(pid_, SIGKILL);
    std::array<pollfd, 2> streams{{{out_, POLLIN, 0}, {err_, POLLIN, 0}}};
    poll(streams.data(), streams.size(), 10);
    read_available();
  }
  pid_ = -1;
  read_available();
  finished_.seconds = std::chrono::duration<double>(steady_clock::now() - begun).count();
  finished_.host_seconds = host_time() - granted;
  finished_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  finished_.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return finished_;
}

std::string rths_command() { return (build_tree() / "bin" / "rths").string(); }

std::uint16_t free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  const bool is_bound = bind(probe, reinterpret_cast<const sockaddr*>(&own), size) == 0 &&
                        getsockname(probe, reinterpret_cast<sockaddr*>(&own), &size) == 0;
  close(probe);
  if (!is_bound) throw std::runtime_error{"no free port"};
  return ntohs(own.sin_port);
}

Finished run_rths(const std::vector<std::string>& arguments, double deadline_s) {
  std::vector<std::string> command{rths_command()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return Running{command}.wait(RTHS_SLOWNESS * deadline_s);
}

bool is_running(int pid) {
  const std::string stat = process_file(pid, "stat");
  return !stat.empty() && stat[stat.rfind(')') + 2] != 'Z';
}

double processor_time_of(int pid) {
  const std::string stat = process_file(pid, "stat");
  if (stat.empty()) return 0;
  std::istringstream words{stat.substr(stat.rfind(')') + 2)};
  std::string word;
  double ticks = 0;
  for (int field = 3; words >> word; ++field)
    if (field == 14 || field == 15) ticks += std::stod(word);  // user, system: proc(5)
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::vector<int> children_of(int pid) {
  std::ifstream file{"/proc/" + std::to_string(pid) + "/task/" + std::to_string(pid) + "/children"};
  return {std::istream_iterator<int>{file}, {}};
}

std::vector<int> programs_of(int pid) {
  const auto program_of = [](int process) {
    std::error_code error;
    return std::filesystem::read_symlink("/proc/" + std::to_string(process) + "/exe", error);
  };
  auto children = children_of(pid);
  std::erase_if(children, [&](int child) { return program_of(child) == program_of(pid); });
  return children;
}

std::string command_line_of(int pid) {
  std::string words = process_file(pid, "cmdline");
  for (char& c : words)
    if (c == '\0') c = ' ';
  return words;
}

}  // namespace rths::test
