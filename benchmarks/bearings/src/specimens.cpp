// SPDX-License-Identifier: Apache-2.0
#include "specimens.hpp"

namespace rths::bench {
namespace {

constexpr double kAxialLoad = 9.7e6;  // [N]

// Lead-rubber, with the five effects of the element.
constexpr const char* kLeadRubber = R"({
  "element": ["LeadRubberX", 1.01e6, 0.0118, 0.796e6, 2e9, 0.3586, 1.35, 0.005, 0.01, 25,
              0, 0, 1, 1, 0, 0, 10, 0.5, 1, 0.5, 0, 0, 0, 11200, 130, 50, 1.41e-5, 1, 1, 1, 1, 1]
})";
constexpr const char* kEradiquake = R"({
  "friction_models": [["VelDependent", 1, 0.0563, 0.1125, 50]],
  "materials": [["ENT", 1, 1e10], ["Elastic", 2, 1e6], ["Elastic", 3, 1.2e7]],
  "element": ["RJWatsonEqsBearing", 1, 1e9, "-P", 1, "-Vy", 3, "-Vz", 3, "-T", 2, "-My", 2,
              "-Mz", 2, "-orient", 0, 0, 1, 1, 0, 0, "-iter", 50, 1e-3]
})";
// Does not converge with friction that depends on velocity.
constexpr const char* kTriplePendulum = R"({
  "friction_models": [["Coulomb", 1, 0.03], ["Coulomb", 2, 0.07], ["Coulomb", 3, 0.0936]],
  "materials": [["ENT", 1, 1e10], ["Elastic", 2, 1e6]],
  "element": ["TripleFrictionPendulum", 1, 2, 3, 1, 2, 2, 2, 0.45, 3.6259, 3.6259, 0.05, 0.36, 0.36, 9.7e6,
              0.001, 1e8, 1e3, 1e-5]
})";

}  // namespace

std::vector<Specimen> all_specimens() {
  return {
      {"lprb",
       "lead-rubber bearing, all effects on",
       {0.4, kAxialLoad, 5e9},
       true,
       1000,
       kLeadRubber},
      {"eqsb", "flat slider with springs", {0.3, kAxialLoad, 1e10}, false, 0, kEradiquake},
      {"tpfb", "triple friction pendulum", {0.8, kAxialLoad, 1e10}, false, 2000, kTriplePendulum}};
}

}  // namespace rths::bench
