// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "opensees_rows.hpp"

namespace rths::sim::test {
namespace {

using nlohmann::json;

// A lead-rubber bearing near that of the paper: 1,010 kN, 4.2 MN/m after yield.
constexpr double kStrength = 1.01e6;      // [N]
constexpr double kAlpha = 0.0118;         // stiffness after yield over that before [-]
constexpr double kShearModulus = 0.93e6;  // [Pa]
constexpr double kBulkModulus = 2e9;      // [Pa]
constexpr double kLeadDiameter = 0.35;    // [m]
constexpr double kDiameter = 1.2;         // [m]
constexpr double kShim = 0.003;           // [m]
constexpr double kLayer = 0.01;           // [m]
constexpr int kLayers = 23;
constexpr double kAxialLoad = 9.7e6;  // [N]

// What closes a friction or Bouc-Wen bearing in the directions that are not looked at: stiff
// under compression and without strength in tension, and something for rotations.
const json kMaterials =
    json::array({json::array({"ENT", 1, 1e10}), json::array({"Elastic", 2, 1e6})});
constexpr double kStiffVertical = 1e10;  // [N/m]

void append(json& to, const json& more) {
  for (const auto& word : more) to.push_back(word);
}

// Local x is the global z, local y the global x.
const json kUpright = json::array({0, 0, 1, 1, 0, 0});

double post_yield_stiffness() {
  const double area =
      std::numbers::pi / 4 * (kDiameter * kDiameter - kLeadDiameter * kLeadDiameter);
  return kShearModulus * area / (kLayer * kLayers);
}

double yield_displacement() { return kStrength / ((1 / kAlpha - 1) * post_yield_stiffness()); }

OpenseesRow bouc_wen_element() {
  const double stiffness = post_yield_stiffness() / kAlpha;
  OpenseesRow row;
  row.name = "elastomericBearingBoucWen";
  row.bearing.element = {row.name, stiffness, kStrength, kAlpha, 0.0, 1.0, 2.0, 0.5, 0.5};
  append(row.bearing.element, {"-P", 1, "-T", 2, "-My", 2, "-Mz", 2, "-orient"});
  append(row.bearing.element, kUpright);
  row.bearing.materials = kMaterials;
  row.bearing.axial_load = kAxialLoad;
  row.bearing.vertical_stiffness = kStiffVertical;
  row.bearing.terms = {{"bouc_wen",
                        "",
                        {{"characteristic_strength", kStrength},
                         {"post_yield_stiffness", post_yield_stiffness()},
                         {"yield_displacement", yield_displacement()},
                         {"beta", 0.5},
                         {"eta", 2}}}};
  return row;
}

}  // namespace

std::vector<OpenseesRow> elastomeric_rows() { return {bouc_wen_element()}; }

}  // namespace rths::sim::test
