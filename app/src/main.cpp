// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <CLI/CLI.hpp>
#include <rths/launch/run.hpp>
#include <rths/report/report.hpp>
#include <rths/core/error.hpp>
int main(int argc, char** argv) {
  CLI::App app{"rths"};
  std::string file, clock = "wall", out = "out", node, ring="r", rec;
  std::vector<std::string> sets;
  auto* run = app.add_subcommand("run");
  run->add_option("file", file)->required();
  run->add_option("--clock", clock);
  run->add_option("--out", out);
  run->add_option("--set", sets);
  auto* n = app.add_subcommand("node");
  n->add_option("file", file)->required();
  n->add_option("--node", node);
  n->add_option("--ring", ring);
  n->add_option("--recording", rec);
  n->add_option("--set", sets);
  CLI11_PARSE(app, argc, argv);
  rths::launch::Overrides ov;
  for (auto& s : sets) ov.emplace_back(s.substr(0, s.find('=')), s.substr(s.find('=') + 1));
  try {
    auto e = rths::launch::load_experiment(file, ov);
    if (*n) return rths::launch::run_node(e, node, ring, rec, "0");
    rths::launch::RunOptions o;
    o.clock = clock == "wall" ? rths::launch::ClockKind::Wall : rths::launch::ClockKind::Virtual;
    o.recording = out + "/run.h5";
    o.ring = ring;
    o.overrides = ov;
    auto r = rths::launch::run(e, o);
    printf("%d %s %.2f s\n", r.completed, r.trouble.c_str(), r.wall_time);
    rths::launch::run_uncompensated(e, out + "/run.h5", out + "/uncompensated.h5", "0"); rths::launch::run_numerical(e, out + "/numerical.h5");
    printf("%s", rths::report::make_report(out).summary.c_str());
    return r.completed ? 0 : 2;
  } catch (const rths::Error& x) {
    fprintf(stderr, "rths: %s\n", x.what());
    return 2;
  }
}
