// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/gtest.hpp>

namespace {

class SmallLaboratory : public rths::testkit::LaboratoryTest {
 protected:
  rths::testkit::Laboratory& start() {
    auto& lab = laboratory("laboratory.ringmap.toml");
    for (const char* node : {"machine", "controller"})
      lab.start({node, {LABORATORY, "{node}", "{ring}"}, true});  // true: linked
    solver = lab.join("solver");                                  // the test plays the solver
    return lab;
  }
  std::unique_ptr<rths::testkit::SignalNode> solver;
};

TEST_F(SmallLaboratory, LimitsTheReference) {
  start();

  solver->write("solver.target", 0.3);

  expect_within(5, "controller.reference", 0.2);
  expect_within(5, "machine.force", {2e5, 10});
  never(0.05, "machine.force", rths::testkit::above(2.1e5));
}

TEST_F(SmallLaboratory, MovesAgainAfterLostMessages) {
  auto& lab = start();

  lab.drop("controller");
  solver->write("solver.target", 0.1);
  never(0.1, "machine.force", rths::testkit::above(1));
  lab.restore("controller");
  solver->write("solver.target", 0.1);

  expect_within(5, "machine.force", {1e5, 10});
}

TEST_F(SmallLaboratory, EndsWithItsSolver) {
  auto& lab = laboratory("laboratory.ringmap.toml");
  for (const char* node : {"machine", "controller", "solver"})
    lab.start({node, {LABORATORY, "{node}", "{ring}"}});

  lab.expect_end(10, "solver");
}

}  // namespace
