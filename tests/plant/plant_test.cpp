// SPDX-License-Identifier: Apache-2.0
//
// The large plant: mesh, modes, gravity, and the reduced plant against the full one.
#include <chrono>
#include <cstdio>

#include <gtest/gtest.h>

#include "plant/drive.hpp"

namespace rths::plant {
namespace {

using test::difference;
using test::drive;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TEST(Explore, All) {
  for (long dofs : {5676L}) {
    double t = now();
    const AntMesh mesh = mesh_of(ant_with(dofs));
    const Structure plant = assemble(mesh);
    check(plant);
    std::printf("dofs %ld mesh %.2f s\n", static_cast<long>(plant.dofs()), now() - t);
    const auto bearings = BearingSet::all_of(test::lead_rubber(), plant.bearings.size());
    t = now();
    const Basis basis = make_basis(plant, bearings, {});
    std::printf(
        "basis %ld (%ld static) %.2f s; f %.4f %.4f %.4f ... %.2f; weights %.3g %.3g sum err "
        "%.2g\n",
        long(basis.coordinates()), long(basis.static_vectors()), now() - t, basis.frequencies[0],
        basis.frequencies[1], basis.frequencies[2], basis.frequencies[basis.frequencies.size() - 1],
        basis.weights.minCoeff(), basis.weights.maxCoeff(),
        basis.weights.sum() / (480e6 * 9.80665) - 1);
    for (double dt : {0.01, 0.001}) {
      PlantSettings settings;
      settings.time_step = dt;
      const auto motion = test::petrolia();
      const auto reduced = make_reduced(basis, bearings, motion, plant.floors, settings);
      t = now();
      const auto r = drive(*reduced, test::lead_rubber(), dt, 10);
      std::printf("reduced dt %g: %.3f ms a step; peak %.4f m\n", dt, 1e3 * (now() - t) * dt / 10,
                  r.tested.cwiseAbs().maxCoeff());
      if (dofs > 20000) continue;
      const auto full = make_full(plant, bearings, motion, settings);
      t = now();
      const auto f = drive(*full, test::lead_rubber(), dt, 10);
      std::printf("full: %.3f ms a step, tested %.5f %%, spectra %.4f %%\n",
                  1e3 * (now() - t) * dt / 10, difference(r.tested, f.tested),
                  test::spectral_difference(r, f));
    }
  }
}

}  // namespace
}  // namespace rths::plant
