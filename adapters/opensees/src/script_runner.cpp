// SPDX-License-Identifier: Apache-2.0
#include "script_runner.hpp"

#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths::adapters {
namespace {

constexpr const char* kLauncher = "mpiexec.mpich";

// Arguments: number of ranks, floors as [[node, dof, dof], …], descriptor of their pipe, script and
// its own. A rank runs it in a child, so that its death is named. Launcher and ranks are in
// sessions of their own: each ends with its parent.
constexpr const char* kRunner = R"(
import ctypes, gc, io, json, os, runpy, signal, struct, sys, traceback

count, floors, pipe, script = int(sys.argv[1]), json.loads(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
sys.argv[:] = sys.argv[4:]
sys.path.insert(0, os.path.dirname(script))
rank = int(os.environ.get("PMI_RANK", 0)) if count > 1 else 0


def flush_files():
    for file in gc.get_objects():
        if isinstance(file, io.TextIOWrapper) and not file.closed and file.writable():
            file.flush()


def leave(text, code=1):
    flush_files()
    line = f"\nrank {rank}{text}\n" if count > 1 else text.lstrip(": ") + "\n"
    os.write(2, line.encode())  # at once: ranks share the file
    os._exit(code)


def name_process(state):
    """For the node, which names a rank that hangs."""
    if count > 1:
        ctypes.CDLL(None).prctl(15, f"rank {rank} {state}".encode())  # PR_SET_NAME


def end_with(parent):
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)


def watch(child, ended):
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


class Floors:
    """Sends the accelerations of floors after each step, by way of rank 0: before its next trial."""

    def __init__(self, ops):
        self.ops, self.shaken, self.nodes = ops, 0, None

    def own(self):
        """For each floor: whether its node is here, and its accelerations."""
        if self.nodes is None:
            self.nodes = set(self.ops.getNodeTags())
        values = []
        for node, *dofs in floors:
            here = self.nodes and node in self.nodes
            motion = self.ops.nodeAccel(node) if here else []
            if here and max(dofs) > len(motion):
                leave(f": node {node} has {len(motion)} degrees of freedom, but a floor names {max(dofs)}")
            values.append([float(bool(here)), *(motion[dof - 1] if here and dof else 0.0 for dof in dofs)])
        return values

    def send(self):
        found = self.own()
        if rank > 0:
            self.ops.send("-pid", 0, *(x for floor in found for x in floor))
            return
        for other in range(1, count):
            theirs = self.ops.recv("-pid", other)
            found = [mine if mine[0] else theirs[3 * i:3 * i + 3] for i, mine in enumerate(found)]
        for (node, *_), (is_here, *_) in zip(floors, found):
            if not is_here:
                leave(f": there is no node {node}, which a floor names")
        values = [x for floor in found for x in floor[1:]]
        try:
            os.write(pipe, struct.pack(f"{2 + len(values)}d", self.ops.getTime(), self.shaken, *values))
        except BlockingIOError:
            pass  # nobody reads between the end of the test and that of the script


def hook(ops):
    analyze, element, pattern = ops.analyze, ops.element, ops.pattern
    waiting = [check_masses] if count > 1 else []
    feed = Floors(ops)

    def checked_analyze(*arguments):
        while waiting:
            name_process("steps")
            waiting.pop()(ops)
        steps, rest = arguments[0], arguments[1:]
        if not floors or len(rest) > 1:  # an analysis that chooses its steps is one
            return analyze(*arguments)
        status = 0
        for _ in range(steps):
            status = analyze(1, *rest)
            feed.send()
            if status != 0:
                break
        return status

    def checked_element(kind, *arguments):
        if kind.lower() == "genericclient":
            leave(": an element genericClient, expected on rank 0 alone: if ops.getPID() == 0")
        return element(kind, *arguments)

    def noted_pattern(kind, tag, *arguments):
        if kind == "UniformExcitation":  # along arguments[0]: motion is relative to the ground
            feed.shaken |= 1 << int(arguments[0])
        return pattern(kind, tag, *arguments)

    ops.analyze, ops.pattern = checked_analyze, noted_pattern
    if rank > 0:
        ops.element = checked_element


def run():
    import openseespy.opensees as ops
    if ops.getNP() != count:
        leave(f": getNP() is {ops.getNP()}, expected {count}: openseespy contains MPICH, whose ranks only mpiexec.mpich brings "
              "together; those of Open MPI remain alone")
    hook(ops)
    try:
        runpy.run_path(script, run_name="__main__")
    finally:
        flush_files()  # before OpenSees ends the process


def run_as_rank():
    ended, end = os.pipe()
    parent = os.getpid()
    end_with(os.getppid())
    child = os.fork()
    if child > 0:
        os.close(end)
        watch(child, ended)
    end_with(parent)
    name_process("starts")
    try:
        run()
    except SystemExit as error:
        if isinstance(error.code, str):
            leave(f": {error.code}")
        if error.code:
            leave(f" ended with {error.code}", error.code)
    except BaseException as error:
        traceback.print_exc()
        leave(f": {type(error).__name__}: {error}")
    os.write(end, b"1")


run() if count == 1 else run_as_rank()
)";

std::string listed(const std::vector<OpenSeesFloor>& floors) {
  std::vector<std::string> lists;
  for (const auto& floor : floors)
    lists.push_back(fmt::format("[{}, {}, {}]", floor.node, floor.dofs[0], floor.dofs[1]));
  return fmt::format("[{}]", fmt::join(lists, ", "));
}

}  // namespace

void require_rank_launcher(int processes) {
  if (!found_in_path(kLauncher))
    throw Error{fmt::format(
        "there is no program '{}' for processes = {}, expected that of the Debian package mpich",
        kLauncher, processes)};
}

void run_inside(const OpenSeesScript& script, int floor_pipe, ProgramStart& start) {
  if (script.processes == 1 && script.floors.empty()) return;
  const auto count = std::to_string(script.processes);
  start.command.insert(start.command.begin() + 1,
                       {"-c", kRunner, count, listed(script.floors), std::to_string(floor_pipe)});
  start.kept_open = floor_pipe;
  if (script.processes == 1) return;
  require_rank_launcher(script.processes);
  start.command.insert(start.command.begin(), {kLauncher, "-n", count});
  start.telling = "rank ";  // a launcher adds lines of its own
  // The ranks are processes of this host, whose messages need not leave it.
  start.environment.insert(start.environment.end(),
                           {{"HYDRA_LAUNCHER", "fork"}, {"HYDRA_IFACE", "lo"}});
}

}  // namespace rths::adapters
