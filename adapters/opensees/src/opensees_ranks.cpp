// SPDX-License-Identifier: Apache-2.0
#include "opensees_ranks.hpp"

#include <string>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths::adapters {
namespace {

constexpr const char* kLauncher = "mpiexec.mpich";

// Runs a script as one rank, in a child, so that the death of the rank is named. Launcher and ranks
// are in sessions of their own: each ends with its parent.
constexpr const char* kRank = R"(
import ctypes, gc, io, os, runpy, signal, sys, traceback

count, script = int(sys.argv[1]), sys.argv[2]
sys.argv[:] = sys.argv[2:]
sys.path.insert(0, os.path.dirname(script))
rank = int(os.environ.get("PMI_RANK", 0))


def flush_files():
    for file in gc.get_objects():
        if isinstance(file, io.TextIOWrapper) and not file.closed and file.writable():
            file.flush()


def leave(text, code=1):
    flush_files()
    print(f"rank {rank}{text}", file=sys.stderr, flush=True)
    os._exit(code)


def end_with(parent):
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)


def watch(child):
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code < 0:
        leave(f" was killed by signal {-code}", 128 - code)
    if code == 0 and not os.read(ended, 1):
        leave(" left its script before the end")
    os._exit(code)


def masses(ops):
    found = {tag: max(ops.nodeMass(tag)) for tag in ops.getNodeTags()}
    return {tag: mass for tag, mass in found.items() if mass != 0}


def check_masses(ops):
    if rank > 0:
        pairs = [float(x) for pair in masses(ops).items() for x in pair]
        ops.send("-pid", 0, float(len(pairs)), *pairs)
        return
    on_ranks = {tag: [(0, mass)] for tag, mass in masses(ops).items()}
    for other in range(1, count):
        _, *pairs = ops.recv("-pid", other)
        for tag, mass in zip(pairs[::2], pairs[1::2]):
            on_ranks.setdefault(int(tag), []).append((other, mass))
    total = sum(mass for found in on_ranks.values() for _, mass in found)
    distinct = sum(max(mass for _, mass in found) for found in on_ranks.values())
    for tag, found in on_ranks.items():
        if len(found) > 1:
            leave(f": the nodes of all ranks have a mass of {total:g}, expected {distinct:g}, that of distinct nodes: node {tag}, for "
                  f"one, has a mass on the ranks {', '.join(str(other) for other, _ in found)}; state it on one")


def hook(ops):
    analyze, element = ops.analyze, ops.element
    waiting = [check_masses]

    def checked_analyze(*arguments):
        while waiting:
            waiting.pop()(ops)
        return analyze(*arguments)

    def checked_element(kind, *arguments):
        if kind.lower() == "genericclient":
            leave(": an element genericClient, expected on rank 0 alone: if ops.getPID() == 0")
        return element(kind, *arguments)

    ops.analyze = checked_analyze
    if rank > 0:
        ops.element = checked_element


ended, end = os.pipe()
parent = os.getpid()
end_with(os.getppid())
child = os.fork()
if child > 0:
    os.close(end)
    watch(child)
end_with(parent)
try:
    import openseespy.opensees as ops
    if ops.getNP() != count:
        leave(f": getNP() is {ops.getNP()}, expected {count}: openseespy contains MPICH, whose ranks only mpiexec.mpich brings "
              "together; those of Open MPI remain alone")
    hook(ops)
    runpy.run_path(script, run_name="__main__")
except SystemExit as error:
    if isinstance(error.code, str):
        leave(f": {error.code}")
    if error.code:
        leave(f" ended with {error.code}", error.code)
except BaseException as error:
    traceback.print_exc()
    leave(f": {type(error).__name__}: {error}")
flush_files()  # before OpenSees ends the process
os.write(end, b"1")
)";

}  // namespace

void require_rank_launcher(int processes) {
  if (!found_in_path(kLauncher))
    throw Error{fmt::format(
        "there is no program '{}' for processes = {}, expected that of the Debian package mpich",
        kLauncher, processes)};
}

void start_on_ranks(int processes, ProgramStart& start) {
  require_rank_launcher(processes);
  const auto count = std::to_string(processes);
  start.command.insert(start.command.begin() + 1, {"-c", kRank, count});
  start.command.insert(start.command.begin(), {kLauncher, "-n", count});
  // The ranks are processes of this host, whose messages need not leave it.
  start.environment.insert(start.environment.end(),
                           {{"HYDRA_LAUNCHER", "fork"}, {"HYDRA_IFACE", "lo"}});
}

}  // namespace rths::adapters
