// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::app {

struct CommandLine;

// Each adds the command of its name, a file of its own or of its group.
void add_run(CommandLine& line);
void add_node(CommandLine& line);
void add_check(CommandLine& line);
void add_export(CommandLine& line);
void add_report(CommandLine& line);
void add_diagnose(CommandLine& line);
void add_loop(CommandLine& line);
void add_terms(CommandLine& line);
void add_map(CommandLine& line);
void add_new(CommandLine& line);
void add_replay(CommandLine& line);
void add_test(CommandLine& line);
void add_dump(CommandLine& line);
void add_who(CommandLine& line);
void add_watch(CommandLine& line);
void add_send(CommandLine& line);
void add_bridge(CommandLine& line);
void add_ring(CommandLine& line);
void add_fault(CommandLine& line);
void add_stop(CommandLine& line);
void add_doctor(CommandLine& line);
void add_clean(CommandLine& line);
void add_bench(CommandLine& line);
void add_delay(CommandLine& line);
void add_identify(CommandLine& line);
void add_calibrate(CommandLine& line);
void add_pretest(CommandLine& line);

/// Becomes rths-bench, the program of the benchmarks beside this one, if the words are `bench …` or
/// complete such words. @throws Error if it is not there
void become_bench(const std::vector<std::string>& words);

}  // namespace rths::app
