// SPDX-License-Identifier: Apache-2.0
#include "warm_python.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/file.hpp>
#include <rths/core/interrupted.hpp>

namespace rths::foreign {
namespace {

constexpr double kLoading = 30;  // for the imports, then cold runs take over [s]
constexpr double kAnswering = 10;

// Reads requests from standard input, forks a run for each, and tells its process and its end. In
// the fork, it becomes the requested script.
constexpr const char* kServe = R"(
import ast, ctypes, gc, importlib, os, resource, runpy, select, signal, sys

def load_imports(script):
    beside = {name.split(".")[0] for name in os.listdir(os.path.dirname(script))}
    with open(script, "rb") as file:
        statements = ast.parse(file.read()).body
    for statement in statements:
        names = []
        if isinstance(statement, ast.Import):
            names = [alias.name for alias in statement.names]
        elif isinstance(statement, ast.ImportFrom) and statement.level == 0:
            names = [statement.module]
        for name in names:
            if name.split(".")[0] not in beside:
                importlib.import_module(name)

def read(count):
    data = b""
    while len(data) < count:
        part = os.read(0, count - len(data))
        if not part:
            os._exit(0)
        data += part
    return data

def request():
    return [os.fsdecode(field) for field in read(int(read(8))).split(b"\0")]

def prepare(limit, messages, folder, *arguments):
    os.setpgid(0, 0)
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)
    os.chdir(folder)
    written = os.open(messages, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    nothing = os.open("/dev/null", os.O_RDONLY)
    for source, target in ((nothing, 0), (written, 1), (written, 2)):
        os.dup2(source, target)
    os.close(answers)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit), int(limit)))
    return list(arguments)

def serve():
    while True:
        asked = request()
        run = os.fork()
        if run == 0:
            return prepare(*asked)
        try:
            os.setpgid(run, run)
        except OSError:
            pass
        os.write(answers, b"%d\n" % run)
        watch, look = os.pidfd_open(run), select.poll()
        look.register(watch, select.POLLIN)
        look.register(0, select.POLLHUP)
        if any(source == 0 for source, _ in look.poll()):
            os.killpg(run, signal.SIGKILL)
            os._exit(0)
        os.close(watch)
        os.write(answers, b"ended\n")
        read(1)
        os.write(answers, b"%d\n" % os.waitpid(run, 0)[1])

answers = os.dup(1)
os.dup2(2, 1)
try:
    load_imports(sys.argv[1])
except Exception:
    pass  # the script itself says what is wrong
gc.freeze()
os.write(answers, b"ready\n")
sys.argv[:] = serve()
if sys.argv[0] == "-c":
    text = sys.argv.pop(1)
    sys.path[0] = ""
    exec(compile(text, "<string>", "exec"), {"__name__": "__main__"})
else:
    sys.path[0] = os.path.dirname(os.path.abspath(sys.argv[0]))
    runpy.run_path(sys.argv[0], run_name="__main__")
)";

template <class Number>
std::optional<Number> number_in(const std::string& line) {
  Number number{};
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc{} || end != line.data() + line.size()) return std::nullopt;
  return number;
}

}  // namespace

class WarmPython::Interpreter {
 public:
  Interpreter(const std::string& python, const std::string& script) {
    const std::array<const char*, 5> arguments{python.c_str(), "-c", kServe, script.c_str(),
                                               nullptr};
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return;
    socket_ = ends[0];
    pid_ = fork();
    if (pid_ == 0) become(const_cast<char* const*>(arguments.data()), ends[1]);
    close(ends[1]);
    is_sound_ = pid_ > 0 && next_line(kLoading) == "ready";
  }
  // A run that has not ended is ended, too: the interpreter loses its requests.
  ~Interpreter() {
    if (run_ > 0) kill(-run_, SIGKILL);
    if (socket_ >= 0) close(socket_);
    if (pid_ <= 0) return;
    if (!is_sound_) kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  [[nodiscard]] bool is_sound() const { return is_sound_; }

  /// @returns none if the interpreter is lost
  [[nodiscard]] std::optional<ChildEnding> run(const std::vector<std::string>& arguments,
                                               const std::filesystem::path& folder,
                                               double deadline) {
    is_sound_ = false;  // until it waits for the next request
    std::string request =
        fmt::format("{}", kMostTextBytes) + '\0' + kMessages + '\0' + folder.string();
    for (const auto& argument : arguments) request += '\0' + argument;
    if (!write_all(fmt::format("{:08}", request.size()) + request)) return std::nullopt;
    const auto run = number_in<pid_t>(next_line(kAnswering));
    if (!run || *run <= 0) return std::nullopt;
    run_ = *run;
    const bool is_late = next_line(deadline) != "ended";
    kill(-run_, SIGKILL);  // it is reaped only afterwards, so the number is still its own
    if (is_late && next_line(kAnswering) != "ended") return std::nullopt;
    run_ = 0;
    if (!write_all("r")) return std::nullopt;
    const auto status = number_in<int>(next_line(kAnswering));
    if (!status) return std::nullopt;
    is_sound_ = true;
    return ending_of(*status, is_late ? std::optional{deadline} : std::nullopt, folder);
  }

 private:
  // Between fork and exec: only calls that a signal handler may make.
  [[noreturn]] static void become(char* const* arguments, int socket) {
    setpgid(0, 0);
    for (const int number : kEndingSignals) std::signal(number, SIG_DFL);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(socket, STDIN_FILENO);
    dup2(socket, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execv(arguments[0], arguments);
    _exit(1);
  }

  [[nodiscard]] bool write_all(const std::string& text) const {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count = send(socket_, text.data() + done, text.size() - done, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }

  // The next line of an answer; empty if there is none within some seconds.
  [[nodiscard]] std::string next_line(double seconds) {
    const WallClock clock;
    const TimePoint begin = clock.now();
    std::size_t end = 0;
    while ((end = unread_.find('\n')) == std::string::npos) {
      const double left = seconds - to_seconds(clock.now() - begin);
      if (left <= 0) return "";
      pollfd watched{socket_, POLLIN, 0};
      const int wait = std::clamp(static_cast<int>(1000 * left), 1, kLookMilliseconds);
      const int ready = poll(&watched, 1, wait);
      stop_if_interrupted();
      if (ready <= 0) continue;
      std::array<char, 256> part;
      const ssize_t count = read(socket_, part.data(), part.size());
      if (count <= 0) return "";
      unread_.append(part.data(), static_cast<std::size_t>(count));
    }
    std::string line = unread_.substr(0, end);
    unread_.erase(0, end + 1);
    return line;
  }

  int socket_ = -1;
  pid_t pid_ = 0, run_ = 0;
  bool is_sound_ = false;
  std::string unread_;
};

WarmPython::WarmPython(std::string python, std::string script)
    : python_{std::move(python)}, script_{std::move(script)} {}
WarmPython::~WarmPython() = default;

std::optional<ChildEnding> WarmPython::run(const std::vector<std::string>& arguments,
                                           const std::filesystem::path& folder, double deadline) {
  std::unique_ptr<Interpreter> one;
  {
    const std::lock_guard lock{mutex_};
    if (!idle_.empty()) {
      one = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!one) one = std::make_unique<Interpreter>(python_, script_);
  if (!one->is_sound()) return std::nullopt;
  auto ending = one->run(arguments, folder, deadline);
  const std::lock_guard lock{mutex_};
  if (one->is_sound()) idle_.push_back(std::move(one));
  return ending;
}

}  // namespace rths::foreign
