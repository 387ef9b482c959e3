// SPDX-License-Identifier: Apache-2.0
//
// Parent and child share a page of turns, texts and arrays. Each waits for its turn in a futex.
#include <rths/plugin/child_adapter.hpp>

#include <fcntl.h>
#include <linux/futex.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::plugin {
namespace {

using adapters::Direction;
using adapters::Port;
using adapters::StepData;

constexpr std::size_t kTextBytes = 1 << 20;  // of all ports, one line each
constexpr std::size_t kMostValues = 20'000;
constexpr Duration kLook = std::chrono::milliseconds{50};  // at the life of the other
constexpr double kAnswerMargin = 0.1;  // for the answer of an adapter that ends its step itself [s]
constexpr int kSpins = 2000;           // before a sleep

enum class ChildCommand : std::uint32_t { Make, Activate, Step, Deactivate };
enum Turn : std::uint32_t { kParent, kChild };

/// The memory of both processes.
struct ChildMemory {
  std::atomic<std::uint32_t> turn{kChild};  ///< the child begins with Make
  ChildCommand command = ChildCommand::Make;
  Status status = Status::Ok;
  double time = 0, age = 0;
  bool stopping = false;
  std::array<char, kTextBytes> text{};  ///< a message, or the ports after Make; empty: no Error
  bool failed = false;                  ///< `text` is an Error
  std::size_t inputs = 0, outputs = 0;
  std::array<double, kMostValues> values{};  ///< inputs, then outputs
};

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value,
           const timespec* timeout) {
  return syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), operation, value, timeout,
                 nullptr, 0);
}

void give_turn(ChildMemory& shared, Turn turn) {
  shared.turn.store(turn, std::memory_order_release);
  futex(shared.turn, FUTEX_WAKE, 1, nullptr);
}

// Waits for a turn, at most for one look.
bool has_turn(ChildMemory& shared, Turn turn) {
  for (int i = 0; i < kSpins; ++i)
    if (shared.turn.load(std::memory_order_acquire) == turn) return true;
  const timespec look{0, static_cast<long>(kLook.count())};
  futex(shared.turn, FUTEX_WAIT, turn == kParent ? kChild : kParent, &look);
  return shared.turn.load(std::memory_order_acquire) == turn;
}

void set_text(ChildMemory& shared, const std::string& text) {
  const auto size = std::min(text.size(), shared.text.size() - 1);
  std::memcpy(shared.text.data(), text.data(), size);
  shared.text[size] = '\0';
}

std::string text_of(const std::vector<Port>& ports) {
  std::string text;
  for (const auto& port : ports)
    text += fmt::format("{}\t{}\t{}\t{}\t{:d}\t{:d}\t{}\t{}\n", port.name,
                        static_cast<int>(port.direction), port.unit, port.initial, port.event,
                        port.range.has_value(), port.range ? port.range->first : 0,
                        port.range ? port.range->second : 0);
  return text;
}

std::vector<Port> ports_of(const std::string& text) {
  std::vector<Port> ports;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields{line};
    std::array<std::string, 8> field;
    for (auto& word : field) std::getline(fields, word, '\t');
    Port port{field[0], static_cast<Direction>(std::atoi(field[1].c_str())), field[2],
              number_of(field[3]).value_or(0), field[4] == "1"};
    if (field[5] == "1")
      port.range = {number_of(field[6]).value_or(0), number_of(field[7]).value_or(0)};
    ports.push_back(std::move(port));
  }
  return ports;
}

/// The child: answers until the parent is gone.
class Server {
 public:
  Server(ChildMemory& shared, const std::function<std::unique_ptr<adapters::Adapter>()>& make)
      : shared_{shared}, make_{make} {}

  [[noreturn]] void run(pid_t parent) {
    for (;;) {
      while (!has_turn(shared_, kChild))
        if (getppid() != parent) _exit(0);
      answer();
      give_turn(shared_, kParent);
    }
  }

 private:
  void answer() {
    if (shared_.command == ChildCommand::Step) return step();
    shared_.failed = false;
    try {
      if (shared_.command == ChildCommand::Make) make();
      if (shared_.command == ChildCommand::Activate) adapter_->activate();
      if (shared_.command == ChildCommand::Deactivate) adapter_->deactivate();
    } catch (const Error& error) {
      shared_.failed = true;
      set_text(shared_, error.what());
    }
  }
  void make() {
    adapter_ = make_();
    const auto ports = adapter_->ports();
    const std::string text = text_of(ports);
    if (text.size() >= kTextBytes || ports.size() > kMostValues)
      throw Error{fmt::format("{} signals, expected at most {}", ports.size(), kMostValues)};
    shared_.inputs =
        static_cast<std::size_t>(std::count_if(ports.begin(), ports.end(), adapters::is_read));
    shared_.outputs = ports.size() - shared_.inputs;
    set_text(shared_, text);
  }
  void step() noexcept {
    StepData step;
    step.time = shared_.time;
    step.age = shared_.age;
    step.stopping = shared_.stopping;
    step.inputs = {shared_.values.data(), shared_.inputs};
    step.outputs = {shared_.values.data() + shared_.inputs, shared_.outputs};
    shared_.status = adapter_->step(step);
    if (shared_.status == Status::Fault) set_text(shared_, step.message);
  }

  ChildMemory& shared_;
  const std::function<std::unique_ptr<adapters::Adapter>()>& make_;
  std::unique_ptr<adapters::Adapter> adapter_;
};

// Files and sockets of the parent stay its own; standard error is shared. Signals of a terminal are
// for the parent, which brings the test to rest.
void leave_parent() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGTTOU})
    std::signal(signal, SIG_IGN);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, 0);
}

class ChildAdapter final : public adapters::Adapter {
 public:
  ChildAdapter(const std::function<std::unique_ptr<adapters::Adapter>()>& make,
               const ChildSettings& settings)
      : settings_{settings} {
    void* memory = mmap(nullptr, sizeof(ChildMemory), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw Error{settings_.title + ": no memory for its process"};
    shared_ = std::construct_at(static_cast<ChildMemory*>(memory));
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ == 0) {
      leave_parent();
      Server{*shared_, make}.run(parent);
    }
    if (pid_ < 0) throw Error{fmt::format("{}: no process: {}", settings_.title, strerror(errno))};
    try {
      demand(ChildCommand::Make, "create");
    } catch (const Error&) {
      end();
      throw;
    }
    ports_ = ports_of(text());
    if (ports_.size() > kMostValues) ports_.resize(kMostValues);
    inputs_ =
        static_cast<std::size_t>(std::count_if(ports_.begin(), ports_.end(), adapters::is_read));
  }

  ~ChildAdapter() override { end(); }
  ChildAdapter(const ChildAdapter&) = delete;
  ChildAdapter& operator=(const ChildAdapter&) = delete;

  [[nodiscard]] std::vector<Port> ports() const override { return ports_; }

  void activate() override {
    demand(ChildCommand::Activate, "activate");
    if (settings_.priority == 0) return;
    const sched_param parameters{settings_.priority};
    sched_setscheduler(pid_, SCHED_FIFO, &parameters);  // without the privilege it runs as it is
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    step.message = message_.data();
    if (is_over_) return Status::Fault;
    shared_->command = ChildCommand::Step;
    shared_->time = step.time;
    shared_->age = step.age;
    shared_->stopping = step.stopping;
    std::copy(step.inputs.begin(), step.inputs.end(), shared_->values.begin());
    double* outputs = shared_->values.data() + inputs_;
    std::copy(step.outputs.begin(), step.outputs.end(), outputs);
    give_turn(*shared_, kChild);
    if (!answers(settings_.step_deadline + kAnswerMargin)) {
      note_end("its step", settings_.step_deadline);
      return Status::Fault;
    }
    std::copy_n(outputs, step.outputs.size(), step.outputs.begin());
    const Status status = std::min(shared_->status, Status::Fault);
    if (status == Status::Fault)
      std::memcpy(message_.data(), shared_->text.data(), message_.size() - 1);
    return status;
  }

  void deactivate() override {
    if (!is_over_) demand(ChildCommand::Deactivate, "deactivate");
  }

 private:
  // Waits for the child's answer. On failure it is dead.
  [[nodiscard]] bool answers(double deadline) noexcept {
    const WallClock clock;
    const TimePoint latest = clock.now() + from_seconds(deadline);
    while (!has_turn(*shared_, kParent)) {
      if (int ending = 0; waitpid(pid_, &ending, WNOHANG) == pid_) {
        ending_ = ending;
        is_over_ = true;
        return false;
      }
      if (clock.now() < latest) continue;
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
      is_over_ = true;
      return false;
    }
    return true;
  }

  // Of the child, whose plugin may have written over its end.
  [[nodiscard]] std::string text() const {
    return {shared_->text.data(), strnlen(shared_->text.data(), shared_->text.size())};
  }

  // @throws Error of the adapter, or if it does not answer
  void demand(ChildCommand command, const char* name) {
    if (is_over_) throw Error{message_.data()};
    if (command != ChildCommand::Make) {
      shared_->command = command;
      give_turn(*shared_, kChild);
    }
    if (!answers(settings_.setup_deadline)) {
      note_end(name, settings_.setup_deadline);
      throw Error{message_.data()};
    }
    if (shared_->failed) throw Error{text()};
  }

  void end() noexcept {
    if (!is_over_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    munmap(shared_, sizeof(ChildMemory));
  }

  void note_end(const char* call, double deadline) noexcept {
    const std::size_t room = message_.size() - 1;
    char* end = nullptr;
    if (!ending_)
      end = fmt::format_to_n(message_.data(), room, "{}: {} did not return within {:g} s",
                             settings_.title, call, deadline)
                .out;
    else if (WIFSIGNALED(*ending_))
      end = fmt::format_to_n(message_.data(), room, "{}: {} ended its process: {}", settings_.title,
                             call, strsignal(WTERMSIG(*ending_)))
                .out;
    else
      end = fmt::format_to_n(message_.data(), room, "{}: {} ended its process with exit code {}",
                             settings_.title, call, WEXITSTATUS(*ending_))
                .out;
    *end = '\0';
  }

  ChildSettings settings_;
  ChildMemory* shared_;
  pid_t pid_ = -1;
  std::optional<int> ending_;  ///< as waitpid returns it; none: it did not answer
  bool is_over_ = false;
  std::array<char, 400> message_{};
  std::vector<Port> ports_;
  std::size_t inputs_ = 0;  ///< in `values`, before the outputs
};

}  // namespace

std::unique_ptr<adapters::Adapter> make_child(
    const std::function<std::unique_ptr<adapters::Adapter>()>& make,
    const ChildSettings& settings) {
  return std::make_unique<ChildAdapter>(make, settings);
}

}  // namespace rths::plugin
